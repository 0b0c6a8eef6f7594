"""Links that spin idly between two balls: their points have no place of their own."""

from __future__ import annotations

from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.circuits.motion import Solvable


def refuse_idle_link(linkage: Solvable, link: int, what: str) -> None:
    """Raises `NotCoveredError` for a link whose spin is not determined, so that neither is `what`.

    The coupler of an RSSR is not refused: its spin has a convention (docs/rssr.md).
    """
    if linkage.kind != "RSSR" and link in linkage.idle_links:
        raise NotCoveredError(
            f"point: the {linkage.idle[0]} is not determined, so neither is {what}; "
            "give a point of another link"
        )
