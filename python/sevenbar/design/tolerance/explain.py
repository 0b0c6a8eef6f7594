"""Which errors of the lengths would cause the differences between measured and computed extremes.

With e the differences of the extremes (those of the paper's Table 1), measured less computed, J their exact
derivatives by the lengths, and W dividing each quantity by its measured range:

- a dimension alone: the change that brings |W (e - J delta)| down most, and what is left of it;
- all together: the changes with the least |delta| that do so by the r strongest directions of W J;
- equal tolerances: the half width t on every dimension at which the worst case sum |J| t, or the statistical
  sum sqrt(sum (J t)^2), first is as large as each of the differences.

The first two are solved on the exact extremes, by steps of the fixed J.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.tolerance.sensitivities import Sensitivities, sensitivities
from sevenbar.design.tolerance.tolerances import CLASSES, in_class
from sevenbar.dimensions import Dimension
from sevenbar.errors import RequestError, SevenbarError
from sevenbar.linkage import Linkage
from sevenbar.measuring.extremes import ExtremesComparison, compare_extremes
from sevenbar.measuring.measured import Ends, MeasuredExtremes

#: Steps of the fixed J on the exact extremes, and the step [parts of the size] that ends them.
MOST_STEPS, SETTLED = 40, 1e-9

#: Singular value in parts of the greatest that is rounding: the size of the linkage changes no angle.
NOTHING = 1e-9


@dataclass(frozen=True)
class Difference:
    """One of the extremes: computed, measured, and tolerances that would make up the difference.

    `worst` and `statistical` are the equal half widths [length] whose worst case, or statistical sum, is the
    difference; `parts` the worst-case half width in parts of each dimension. `classes` is what the worst case
    of each class of ISO 2768 comes to, in parts of the difference.
    """

    name: str
    unit: str
    computed: float
    measured: float
    worst: float
    statistical: float
    parts: float
    classes: dict[str, float]

    @property
    def error(self) -> float:
        """Measured less computed."""
        return self.measured - self.computed


@dataclass(frozen=True)
class Change:
    """Changes of dimensions by name that explain the differences as far as `misfit`, and the class they need.

    `iso` is the finest class of ISO 2768 that allows each of them, of those that it has tolerances for;
    `None` where none does.
    """

    changes: dict[str, float]
    misfit: float
    iso: str | None
    #: The change of a dimension alone that makes up the greatest difference, in per cent, by itself; linear.
    needed: float = math.nan


@dataclass(frozen=True, eq=False)
class Explanation:
    """What would cause the differences between measured and computed extremes.

    `comparison` tells the differences; `misfit` is their root mean square in parts of the measured ranges,
    that of the changes likewise. `alone` has one dimension each, `together` one more direction each.
    """

    found: Sensitivities
    comparison: ExtremesComparison
    dimensions: tuple[Dimension, ...]
    without_class: tuple[str, ...]
    misfit: float
    differences: tuple[Difference, ...]
    #: The place of the greatest difference in per cent.
    most: int
    alone: tuple[Change, ...]
    together: tuple[Change, ...]


def explain(
    linkage: Linkage, measured: MeasuredExtremes, ends: Ends, *, speed: float | str | None = None
) -> Explanation:
    """Which tolerances of the lengths would cause the differences of measured from computed extremes.

    Raises `RequestError` where the linkage has no lengths that could change alone, and as `compare_extremes`.
    """
    before = compare_extremes(linkage, measured, ends, speed=speed)
    found = sensitivities(
        linkage, circuit=before.circuit, input=ends.input, output=ends.output, speed=before.speed
    )
    places = [k for k, d in enumerate(found.dimensions) if d.kind == "length" and d.name not in found.opening]
    if not places:
        raise RequestError("explain: no length of this linkage could change alone; its loop would open")
    search = _Search(linkage, measured, ends, before, found, places)
    unit = linkage.length_unit
    kept = tuple(found.dimensions[k] for k in places)
    classes = {
        letter: np.array([in_class(dimension, letter, unit) or 0.0 for dimension in kept])
        for letter in CLASSES
    }
    sizes = np.array([abs(dimension.value) for dimension in kept])
    differences = []
    for (name, _, computed, value), row in zip(search.extremes, search.slopes, strict=True):
        error = abs(value - computed)
        differences.append(
            Difference(
                name=name.replace("_", " "),
                unit=ends.unit(name.partition("_")[0]),
                computed=computed,
                measured=value,
                worst=_parts(error, np.abs(row).sum()),
                statistical=_parts(error, math.sqrt(float(row @ row))),
                parts=_parts(error, np.abs(row) @ sizes),
                classes={
                    letter: _parts(float(np.abs(row) @ widths), error) for letter, widths in classes.items()
                },
            )
        )
    most = max(
        range(len(differences)), key=lambda j: abs(_parts(differences[j].error, abs(differences[j].computed)))
    )
    alone = [
        replace(search.best([k]), needed=differences[most].error / float(search.slopes[most, k]))
        for k in range(len(places))
    ]
    together = [search.best(range(len(places)), rank) for rank in range(1, search.rank + 1)]
    without = tuple(d.name for d in kept if not any(in_class(d, letter, unit) for letter in CLASSES))
    return Explanation(
        found=found,
        comparison=before,
        dimensions=kept,
        without_class=without,
        misfit=search.misfit(np.zeros(len(places))),
        differences=tuple(differences),
        most=most,
        alone=tuple(sorted(alone, key=lambda change: change.misfit)),
        together=tuple(together),
    )


def _parts(one: float, other: float) -> float:
    """A quotient; infinite where there is nothing to divide by."""
    return float(one / other) if other > 0 else math.inf


class _Search:
    """The exact extremes as a function of changes of lengths, near their linear estimate."""

    def __init__(
        self,
        linkage: Linkage,
        measured: MeasuredExtremes,
        ends: Ends,
        before: ExtremesComparison,
        found: Sensitivities,
        places: list[int],
    ) -> None:
        self._measured, self._ends, self._before = measured, ends, before
        self._found, self._places, self._unit = found, places, linkage.length_unit
        self._size = found.loop.numbers.size
        self.extremes = [
            (f"{extent.quantity}_{end}", extent.measured[1] - extent.measured[0], c, m)
            for extent in before.table
            for end, c, m in zip(("lowest", "highest"), extent.computed, extent.measured, strict=True)
        ]
        self.slopes = np.array(
            [found.measure(name).slopes[places] * found.measure(name).scale for name, *_ in self.extremes]
        )
        self._weights = np.array([1 / (span or 1.0) for _, span, _, _ in self.extremes])
        self._weighted = self.slopes * self._weights[:, None]
        values = np.linalg.svd(self._weighted, compute_uv=False)
        #: How many directions of the lengths change the extremes at all.
        self.rank = int((values > NOTHING * values.max()).sum())

    def residual(self, change: Floats) -> Floats | None:
        """W (measured less computed) of the changed linkage; `None` where it has no such extremes."""
        changes = np.zeros(len(self._found.dimensions))
        changes[self._places] = change
        try:
            table = compare_extremes(
                self._found.changed(changes),
                self._measured,
                self._ends,
                speed=self._before.speed,
            ).table
        except SevenbarError:
            return None
        errors = [m - c for extent in table for c, m in zip(extent.computed, extent.measured, strict=True)]
        return np.asarray(np.array(errors) * self._weights)

    def misfit(self, change: Floats) -> float:
        """The root mean square of the residual; infinite without one."""
        residual = self.residual(change)
        return math.inf if residual is None else math.sqrt(float(np.mean(residual**2)))

    def best(self, columns: Sequence[int], rank: int | None = None) -> Change:
        """The changes of some dimensions, by the `rank` strongest directions, that leave the least misfit."""
        kept = list(columns)
        left, values, right = np.linalg.svd(self._weighted[:, kept], full_matrices=False)
        count = len(kept) if rank is None else rank
        back = (right[:count].T / values[:count]) @ left[:, :count].T
        change = np.zeros(len(self._places))
        best, least = change, math.inf
        for _ in range(MOST_STEPS):
            residual = self.residual(change)
            if residual is None:
                break
            misfit = math.sqrt(float(np.mean(residual**2)))
            if misfit < least:
                best, least = change, misfit
            step = back @ residual
            change = change.copy()
            change[kept] += step
            if np.abs(step).max() < SETTLED * self._size:
                break
        told = {self._found.dimensions[self._places[k]].name: float(best[k]) for k in kept}
        return Change(told, least, self._class(told))

    def _class(self, changes: dict[str, float]) -> str | None:
        """The finest class of ISO 2768 that allows these changes, as far as it has tolerances for them."""
        dimensions = {d.name: d for d in self._found.dimensions}
        for letter in CLASSES:
            widths = {name: in_class(dimensions[name], letter, self._unit) for name in changes}
            known = [abs(changes[name]) <= width for name, width in widths.items() if width is not None]
            if known and all(known):
                return letter
        return None
