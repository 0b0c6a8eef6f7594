"""The linkages of a sweep: the values of their dimensions, by the linkage's index alone."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats, whole_number
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError, check_word, shown
from sevenbar.kinematics.loop.single import check_single
from sevenbar.kinematics.numbers.dimensions import check_apart
from sevenbar.sweep.axes import Given, SweepAxis, axis_of
from sevenbar.sweep.sampling import MOST_SOBOL, random_points, sobol_points

#: How linkages are chosen.
METHODS = ("grid", "random", "sobol")

#: Most linkages: their indices are exact in every number that is formed from them.
MOST_LINKAGES = 10**15

#: Most axes: Sobol sequences have directions for as many.
MOST_AXES = 1000

#: The greatest seed: it fits into every file.
MOST_SEED = 2**63 - 1


@dataclass(frozen=True)
class Space:
    """The axes, how linkages are chosen among their values, how many, and the seed of what is random."""

    axes: tuple[SweepAxis, ...]
    method: str
    count: int
    seed: int | None

    @staticmethod
    def of(
        draft: Draft,
        axes: Mapping[str, Given],
        method: str | None = None,
        count: int | None = None,
        seed: int | None = None,
    ) -> Space:
        """The space that a caller requests: axes by the names of dimensions.

        Without a `method` it is a grid, or where an axis is a span Sobol points, `count` of them. Raises
        `RequestError` for all that does not fit.

            >>> import sevenbar as sb
            >>> from sevenbar.sweep.axes import grid
            >>> draft = Draft.of_linkage(sb.load("rssr"))
            >>> space = Space.of(draft, {"L1": grid(200, "30 cm", 3), "L3": [500, 600]})
            >>> space.count, space.values(2, 5).tolist()
            (6, [[250.0, 250.0, 300.0], [500.0, 600.0, 500.0]])
        """
        if not axes:
            raise RequestError("over: no dimension is given; give one or more, as in L1=200:300:51")
        if len(axes) > MOST_AXES:
            raise RequestError(f"over: {len(axes)} dimensions are too many; give at most {MOST_AXES}")
        check_single(draft.linkage)
        result = tuple(axis_of(draft.dimension(name), given) for name, given in axes.items())
        check_apart("over", [axis.dimension for axis in result])
        names = [axis.name for axis in result]
        for name in names:
            if names.count(name) > 1:
                raise RequestError(f"over: dimension {shown(name)} is given twice; leave one out")
        spans = [axis for axis in result if axis.count is None]
        if method is None:
            method = "sobol" if spans else "grid"
        check_word("method", method, METHODS, "a way to choose linkages")
        if method == "grid":
            return _grid(result, spans, count, seed)
        number = whole_number("seed", 0 if seed is None else seed, 0, MOST_SEED, "a seed")
        if count is None:
            raise RequestError(f"count: missing; a {method} sample needs one, as in 1000")
        most = MOST_SOBOL if method == "sobol" else MOST_LINKAGES
        hint = ", or the method random" if method == "sobol" else ""
        return Space(result, method, whole_number("count", count, 1, most, "a count", hint), number)

    def values(self, first: int, stop: int) -> Floats:
        """The values (axes, n) of linkages `first` to `stop`, each in its dimension's unit of the file."""
        if self.method == "grid":
            index = np.arange(first, stop, dtype=np.int64)
            places = []
            for axis in reversed(self.axes):  # the last one runs fastest
                index, place = np.divmod(index, axis.count or 1)
                places.append(place)
            return np.stack([axis.at(at) for axis, at in zip(self.axes, reversed(places), strict=True)])
        seed, axes = self.seed or 0, len(self.axes)
        if self.method == "random":
            points = random_points(seed, axes, first, stop)
        else:
            points = sobol_points(seed, axes, first, stop)
        return np.stack([axis.within(share) for axis, share in zip(self.axes, points, strict=True)])


def _grid(axes: tuple[SweepAxis, ...], spans: list[SweepAxis], count: int | None, seed: int | None) -> Space:
    counts = [axis.count or 1 for axis in axes]
    total = math.prod(counts)
    product = " x ".join(map(str, counts)) + (f" = {total}" if len(counts) > 1 else "")
    if spans:
        raise RequestError(
            f"{spans[0].name}: {spans[0].low:g} to {spans[0].high:g} is a span, which a grid does not walk; "
            "give LOW:HIGH:COUNT, or the method random or sobol"
        )
    if count is not None and count != total:
        raise RequestError(
            f"count: {shown(count)}, where the grid has {product}; "
            f"leave it out, or give a method random or sobol"
        )
    if seed is not None:
        raise RequestError(f"seed: {shown(seed)} is given, and a grid draws nothing; leave it out")
    if total > MOST_LINKAGES:
        raise RequestError(f"over: {product} linkages are too many; give at most {MOST_LINKAGES:.0e}")
    return Space(axes, "grid", total, None)
