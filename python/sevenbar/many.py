"""Many linkages at once, and what the core runs on."""

from __future__ import annotations

from sevenbar import _core


def simd_level() -> str:
    """The vector unit that the core uses on this machine: results agree bit by bit within one level."""
    return _core.simd_level()
