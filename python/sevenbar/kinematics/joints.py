"""The kinds of joints, what each moves, and the names of its columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

Freedom = Literal["turn", "slide"]

#: What each freedom of a joint does, in the order of its columns.
FREEDOMS: dict[str, tuple[Freedom, ...]] = {
    "R": ("turn",),
    "P": ("slide",),
    "H": ("turn",),
    "C": ("turn", "slide"),
    "U": ("turn", "turn"),
    "S": ("turn", "turn", "turn"),
}
JOINT_KINDS = tuple(FREEDOMS)


def column_names(joint: str, freedoms: Sequence[Freedom]) -> tuple[str, ...]:
    """One name for each freedom of a joint: its own, numbered from 1 where it has more than one."""
    return (joint,) if len(freedoms) == 1 else tuple(f"{joint}.{k}" for k in range(1, len(freedoms) + 1))
