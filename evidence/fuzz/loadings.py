"""Random masses, loads and springs on any linkage."""

from __future__ import annotations

import numpy as np

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.random_linkages import random_rotation
from sevenbar.forces.acting import Load, Spring, Three
from sevenbar.forces.bodies import Body
from sevenbar.forces.loading import Loading
from sevenbar.text.units import LENGTHS

GRAVITY = 9.80665


def random_inertia(rng: np.random.Generator, size: float) -> np.ndarray:
    """That of a box of one kilogram, its sides up to `size` [m], turned any way."""
    squares = rng.uniform(0.05, 1.0, 3) ** 2 * size**2 / 12
    turn = random_rotation(rng)
    tensor = turn @ np.diag(squares.sum() - squares) @ turn.T
    return np.asarray((tensor + tensor.T) / 2)


def random_loading(rng: np.random.Generator, linkage: sb.Linkage, *, losses: bool = True) -> Loading:
    """Gravity, one or two bodies on each link, two loads, a spring between two links and one in a joint.

    All are of a size that lets each be felt; without `losses` no damper and no load, so that energy is kept.
    """
    size = Loop.of(linkage).size
    metres = size * LENGTHS[linkage.length_unit]
    links = len(linkage.joints)

    def place(link: int) -> Three:
        """Within the size of a link's frame, as it is written."""
        frame = linkage.point_frames[link - 1]
        x, y, z = frame[:3, :3].T @ (size * rng.uniform(-1, 1, 3) - frame[:3, 3])
        return float(x), float(y), float(z)

    def three(scale: float) -> Three:
        x, y, z = scale * rng.normal(size=3)
        return float(x), float(y), float(z)

    bodies = {}
    for link in range(1, links):
        masses = rng.uniform(0.2, 2.0, int(rng.integers(1, 3)))
        bodies[link] = tuple(
            Body(float(mass), place(link), mass * random_inertia(rng, metres)) for mass in masses
        )
    one, other = (int(link) for link in 1 + rng.choice(links, 2, replace=False))
    columns = [name for joint in linkage.joints if joint.kind != "S" for name in joint.columns]
    column = str(rng.choice(columns))
    turns = linkage.column_kinds[linkage.columns.index(column)] == "turn"
    weight = GRAVITY
    damping = weight / size if losses else 0.0
    springs = (
        Spring(2 * weight / size, size, damping, (one, other), (place(one), place(other))),
        Spring(
            weight * (metres if turns else 1 / size),
            float(rng.uniform(-1, 1)),
            weight * (metres if turns else 1 / size) if losses else 0.0,
            joint=column,
        ),
    )
    first, second = (int(link) for link in rng.integers(1, links, 2))
    loads = (
        Load(first, three(weight), three(weight * metres), place(first)),
        Load(second, three(weight), three(weight * metres), place(second), axes="link"),
    )
    return Loading(three(weight), bodies, loads if losses else (), springs)
