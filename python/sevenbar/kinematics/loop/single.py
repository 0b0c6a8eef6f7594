"""What is of single loops: a net of several is refused with what it does answer."""

from __future__ import annotations

from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.loop.geometry import Loop


def check_single(linkage: Loop) -> None:
    """Raises `NotCoveredError` for a net of several loops."""
    if linkage.net is not None:
        raise NotCoveredError(
            "net: this linkage has several loops; its freedoms, modes and motion with rates, points and "
            "links are found; forces, stops, sweeps of dimensions, bodies, engines and design "
            "are of single loops"
        )
