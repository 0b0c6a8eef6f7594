"""Instant centres of a planar loop: where two links have the same velocity.

By the theorem of Aronhold and Kennedy the three centres of any three links lie on a line.

Source: docs/theory_measures.md, (9) and (10); S. H. Aronhold (1872);
A. B. W. Kennedy, "The mechanics of machinery" (1886).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.text.printing import Printed


@dataclass(frozen=True, eq=False, repr=False)
class InstantCentre(Printed):
    """The instant centre of links `links` on n rows.

    `place` (n, 3) [length] in the report frame, `in_plane` (n, 2) in the plane of the loop. `status` (n,) is
    "ok", "translation" where it is infinitely far, in the direction square to `direction` (n, 3) along which
    the links slide on each other, "at-rest" where the links move as one, or that of the row.
    """

    links: tuple[int, int]
    place: Floats
    in_plane: Floats
    direction: Floats
    status: npt.NDArray[np.str_]


@dataclass(frozen=True, eq=False, repr=False)
class InstantCentres(Printed):
    """The instant centres of all pairs of links of a planar loop: `[1, 3]` is that of links 1 and 3."""

    centres: Mapping[tuple[int, int], InstantCentre]

    def __getitem__(self, links: tuple[int, int]) -> InstantCentre:
        first, second = sorted(links)
        if (first, second) not in self.centres:
            known = ", ".join(f"{a}-{b}" for a, b in self.centres)
            raise RequestError(f"links: {first} and {second} have no centre; give two of {known}")
        return self.centres[first, second]

    def __len__(self) -> int:
        return len(self.centres)

    def columns(self, length: str) -> dict[str, npt.NDArray[np.generic]]:
        """The centres column by column, in the plane: `P12_x_mm`, `P12_y_mm`, `P12_status`."""
        columns: dict[str, npt.NDArray[np.generic]] = {}
        for (a, b), centre in self.centres.items():
            name = f"P{a}{b}" if b < 10 else f"P{a}_{b}"
            for k, axis in enumerate("xy"):
                columns[f"{name}_{axis}_{length}"] = centre.in_plane[:, k]
            columns[f"{name}_status"] = centre.status
        return columns
