"""What an engine gives back: the bodies of a prototype as it moved them, in the report frame."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any

from sevenbar.arrays import Floats
from sevenbar.errors import MissingExtraError
from sevenbar.text.progress import Progress

#: A bar is moved at most so often.
TICKS = 200


@dataclass(frozen=True, eq=False)
class Record:
    """Bodies at n times: each array has their number as its second dimension.

    `time` (n,) [s] after the start; `frames` (n, bodies, 4, 4); `velocity` and `acceleration` (n, bodies, 3)
    of the frames' origins [length/s, length/s^2]; `spin` and `spin_rate` (n, bodies, 3) [rad/s, rad/s^2].
    `method` is how the engine moves them; `notes` tell in words what it was given that is not plain.
    """

    engine: str
    version: str
    time: Floats
    frames: Floats
    velocity: Floats
    acceleration: Floats
    spin: Floats
    spin_rate: Floats
    method: str
    notes: tuple[str, ...] = ()
    #: What the drive gives (n,) [N m, or N], and what each connection's constraints put on the body after it,
    #: (n, connections, 6) force [N] and moment [N m] about the place of the joint before it, in the report
    #: frame; where masses act and the engine knows it.
    drive: Floats | None = None
    reactions: Floats | None = None


def tell(progress: Progress | None, done: int, steps: int) -> None:
    """Tells how many steps an engine has made: now and then, and at the end."""
    if progress is not None and (done % max(1, steps // TICKS) == 0 or done == steps):
        progress(done, steps)


def imported(module: str) -> Any:
    """A module of an engine, or `MissingExtraError` naming the extra that brings it."""
    engine = module.partition(".")[0]
    advice = "install it with: pip install 'sevenbar[simulate]'"
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name != engine:
            raise MissingExtraError(f"simulate: {engine} lacks {error.name}; {advice}") from None
        raise MissingExtraError(f"simulate needs {engine}, which is not installed; {advice}") from None
    except ImportError as error:
        raise MissingExtraError(f"simulate: {engine} cannot be loaded: {error}; {advice}") from None
