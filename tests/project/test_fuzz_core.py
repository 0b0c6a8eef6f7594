"""Hostile arrays at the core's own door: an answer or a `CoreError`, never a panic.

Source: the binding's contract. A panic of Rust comes through as an exception that is no `Exception`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest

from sevenbar import _core

HOSTILE = (np.nan, np.inf, -np.inf, 0.0, 1e308, -1e308, 1e-320, 1e150, 1.0)


class Door:
    """Calls that count what they came to."""

    def __init__(self) -> None:
        self.came_to: Counter[str] = Counter()

    def __call__(self, name: str, call: Callable[[], object]) -> object:
        try:
            answer = call()
        except _core.CoreError as error:
            assert str(error), name
            answer, told = None, "refused"
        else:
            told = "answered"
        self.came_to[f"{name} {told}"] += 1
        return answer


def frame(rng: np.random.Generator, hostility: float) -> np.ndarray:
    """A rigid motion, or less and less of one."""
    matrix = np.eye(4)
    wild = rng.random() * hostility
    if wild < 0.3:
        matrix[:3, 3] = rng.normal(size=3)
    elif wild < 0.6:
        matrix[:3, 3] = rng.choice(HOSTILE, 3)
    elif wild < 0.8:
        matrix = rng.choice(HOSTILE, (4, 4))
    else:
        matrix[:3, :3] = 0.0
    return matrix


@pytest.mark.parametrize(
    "letters",
    [
        *("", "R", "RRRR", "RSSR", "SSS", "PPPPP", "RSRPR", "SRSRSRR", "XR"),
        "RRRRRRR",
    ],
)
def test_loops_of_hostile_frames_are_answered_or_refused(letters: str) -> None:
    rng, door = np.random.default_rng(len(letters)), Door()
    inner = max(len(letters) - 1, 0)
    for _ in range(6):
        hostility = rng.random() * 1.2
        advances, base, ground = np.zeros(len(letters)), frame(rng, hostility), frame(rng, hostility)
        links = np.array([frame(rng, hostility) for _ in range(inner)]).reshape(inner, 4, 4)
        arrays = advances, base, ground, links
        door(
            "batch",
            lambda a=arrays: _core.measure_loops(letters, *(x[None] for x in a), 0, 1, 12, np.ones(1), 1),
        )
        loop = door("loop", lambda a=arrays: _core.Loop(letters, *a))
        if not isinstance(loop, _core.Loop):
            continue
        law = rng.choice(HOSTILE, (5, 4))
        for column in (0, 1, 99):
            value = float(rng.choice([0.3, np.nan, 1e300]))
            door("modes", lambda c=column, o=loop, v=value: o.assembly_modes(c, v))
            door("mobility", lambda c=column, o=loop: o.mobility(c))
            door("motion", lambda c=column, o=loop, v=value: o.motion(c, 2, 12, v))
            door("law", lambda c=column, o=loop, w=law: o.motion(c, 2, 12, 1.0, w))
            door("pose", lambda c=column, o=loop: o.circuit_through(rng.choice(HOSTILE, 7), c, 2, 12, 1.0))
    assert door.came_to.total() >= 6


def test_rssrs_of_hostile_numbers_are_answered_or_refused() -> None:
    rng, door = np.random.default_rng(2), Door()
    good = [np.eye(4) for _ in range(5)]
    for k, at in enumerate([(0, 0, 7), (7, 0, 0), (2.5, 0, 0), (9, 0, 0), (5.5, 0, 0)]):
        good[k][:3, 3] = at
    for number in range(60):
        frames = good if number < 20 else [frame(rng, rng.random()) for _ in range(5)]
        rssr = door("rssr", lambda f=frames: _core.Rssr(f[0], f[1], np.array(f[2:])))
        if not isinstance(rssr, _core.Rssr):
            continue
        values, speed = rng.choice(HOSTILE, 50), float(rng.choice(HOSTILE))
        for side in ("crank", "rocker", "coupler"):
            door("modes", lambda s=side, o=rssr, v=speed: o.assembly_modes(v, s))
            door("motion", lambda s=side, o=rssr, v=speed: o.motion(s, 12, v))
            for order, rows in ((3, None), (8, None), (3, 50), (3, 5)):
                law = None if rows is None else (rng.choice(HOSTILE, rows),) * 3
                door(
                    "outputs",
                    lambda s=side, o=rssr, v=values, n=order, w=law: o.outputs(v, n, s, 1.0, w),
                )
        rates = rng.choice(HOSTILE, (5, 4))
        door("point", lambda o=rssr, r=rates: o.point(int(rng.integers(0, 9)), rng.choice(HOSTILE, 3), r, r))
    assert {"rssr answered", "rssr refused", "motion answered", "motion refused", "point refused"} <= set(
        door.came_to
    )


@pytest.mark.parametrize("side", ["crank", "rocker"])
def test_batches_of_hostile_dimensions_have_a_code_each(side: str) -> None:
    rng = np.random.default_rng(3)
    for _ in range(60):
        dimensions = rng.choice(HOSTILE, (6, 50))
        codes, limits = _core.classify_rssr(dimensions, side, 3)
        assert (codes <= 6).all()
        assert not np.isinf(limits).any()
        unusable = ~np.isfinite(dimensions).all(axis=0)
        assert (codes[unusable] == 6).all()
        assert (_core.measure_rssr(dimensions, side, np.ones(50), 3).codes == codes).all()
