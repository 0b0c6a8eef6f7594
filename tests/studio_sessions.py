"""Sessions of the studio for its tests: opened, told, and how far apart two poses are."""

from __future__ import annotations

from typing import Any

import numpy as np

import sevenbar as sb
from sevenbar.description.gallery import text
from sevenbar.studio.state.session import Session

DOUBLE_ROCKER = (
    "format = 1\n[drive]\nspeed = '2 rad/s'\n[rssr]\nM = 700\nN = 700\nL1 = 500\nL3 = 550\nD = 100\n"
)


def opened(name: str) -> Session:
    return Session(text(name), name)


def drawn(*joints: tuple[str, tuple[float, ...], tuple[float, ...] | None]) -> str:
    return "format = 1\n" + "".join(
        f"[[joint]]\nkind = '{kind}'\nat = {list(at)}\n" + (f"axis = {list(axis)}\n" if axis else "")
        for kind, at, axis in joints
    )


def state(session: Session) -> tuple[Any, ...]:
    """All that a tab shows, by identity where it has one."""
    return (
        id(session.draft), id(session.view), session.row, id(session.motion), session.problem,
        [id(d) for d in session.past], [id(d) for d in session.future],
    )  # fmt: skip


def kept(linkage: sb.Linkage) -> list[int]:
    return [linkage.columns.index(name) for name in linkage.drivable()]


def distance(motion: sb.Motion, q: np.ndarray, other: np.ndarray) -> float:
    linkage = motion.linkage
    columns = kept(linkage)
    step = (q - other)[columns]
    turns = np.array([linkage.turns(i) for i in columns])
    turned = np.remainder(step + np.pi, 2 * np.pi) - np.pi
    return float(np.linalg.norm(np.where(turns, turned, step / motion.circuits[0].size)))
