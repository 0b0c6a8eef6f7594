"""What is of single loops: a net of several is refused with what it does answer."""

from __future__ import annotations

from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.loop.geometry import Loop


def check_single(linkage: Loop) -> None:
    """Raises `NotCoveredError` for a net of several loops."""
    if linkage.net is not None:
        raise NotCoveredError(
            "net: its freedoms, redundant constraints, order of solving and the modes of dyads are found; "
            "motion and all that follows from it are of single loops"
        )
