"""Instant centres of a planar loop: where two links have the same velocity.

By the theorem of Aronhold and Kennedy the three centres of any three links lie on a line.

Source: docs/theory_measures.md, (9) and (10); S. H. Aronhold (1872);
A. B. W. Kennedy, "The mechanics of machinery" (1886).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, ReadOnly, Words
from sevenbar.errors import RequestError, check_kind, shown
from sevenbar.kinematics.loop.screw_axes import ScrewAxes
from sevenbar.text.printing import Printed


@dataclass(frozen=True, eq=False, repr=False)
class InstantCentre(ReadOnly, Printed):
    """The instant centre of links `links` on n rows.

    `place` (n, 3) [length] in the report frame, `in_plane` (n, 2) in the plane of the loop. `status` (n,) is
    "ok", "translation" where it is infinitely far, in the direction square to `direction` (n, 3) along which
    the links slide on each other, "at-rest" where the links move as one, or that of the row.
    """

    links: tuple[int, int]
    place: Floats
    in_plane: Floats
    direction: Floats
    status: Words


@dataclass(frozen=True, eq=False, repr=False)
class InstantCentres(Printed):
    """The instant centres of all pairs of links of a planar loop: `[1, 3]` is that of links 1 and 3."""

    centres: Mapping[tuple[int, int], InstantCentre]

    def __getitem__(self, links: tuple[int, int]) -> InstantCentre:
        known = ", ".join(f"{a}-{b}" for a, b in self.centres)
        try:
            first, second = sorted(links)
            result = self.centres.get((first, second))
        except (TypeError, ValueError):
            raise RequestError(f"links: {shown(links)} are no two links; give two of {known}") from None
        if result is None:
            raise RequestError(
                f"links: {shown(first)} and {shown(second)} have no centre; give two of {known}"
            )
        return result

    def __len__(self) -> int:
        return len(self.centres)

    def columns(self, length: str) -> dict[str, npt.NDArray[np.generic]]:
        """The centres column by column, in the plane: `P12_x_mm`, `P12_y_mm`, `P12_status`."""
        check_kind("length", length, str, "a unit of length; give a word, as in 'mm'")
        columns: dict[str, npt.NDArray[np.generic]] = {}
        for (a, b), centre in self.centres.items():
            name = f"P{a}{b}" if b < 10 else f"P{a}_{b}"
            for k, axis in enumerate("xy"):
                columns[f"{name}_{axis}_{length}"] = centre.in_plane[:, k]
            columns[f"{name}_status"] = centre.status
        return columns


def instant_centres(
    screw_axes: Callable[[int, int], ScrewAxes], count: int, in_plane: Callable[[Floats], Floats | None]
) -> InstantCentres:
    """The centres of all pairs of `count` links, from the screw axes of pairs.

    `in_plane` gives places (n, 3) in the plane of the loop (n, 2), `None` for a loop that is not planar: then
    `RequestError`.
    """
    if in_plane(np.zeros(3)) is None:
        raise RequestError("instant_centres: the loop is not planar; its links have screw_axes()")
    result = {}
    for links in combinations(range(1, count + 1), 2):
        axes = screw_axes(*links)
        place = in_plane(axes.point)
        assert place is not None
        slides = np.where((axes.status == "translation")[:, None], axes.direction, np.nan)
        result[links] = InstantCentre(links, axes.point, place, slides, axes.status)
    return InstantCentres(result)
