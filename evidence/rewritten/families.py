"""The linkages that are written in many ways: four-bars, slider-cranks, spatial, the gallery, a lattice."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np

import sevenbar as sb
from evidence.rewritten.drawing import Drawing, drawing, redrawn
from evidence.rewritten.spatial import SPATIAL
from sevenbar.arrays import Floats
from sevenbar.description.gallery import loops
from sevenbar.errors import DescriptionError

X, Z = np.eye(3)[[0, 2]]

#: Families by name; each makes its drawing.
Families = dict[str, Callable[[], Drawing]]

#: Crank, coupler, rocker and ground; angle of the crank [rad] where it is drawn.
FOUR_BARS = {
    "crank-rocker 40 100 80 90": ((40, 100, 80, 90), 0.7),
    "double-crank 90 80 100 40": ((90, 80, 100, 40), 1.1),
    "double-rocker 90 40 100 80": ((90, 40, 100, 80), 1.9),
    "triple rocker 3 3 3 2": ((3, 3, 3, 2), 1.3),
    "rocker-crank 80 100 40 90": ((80, 100, 40, 90), 1.2),
    "decimals 0.1 2.6 2.5 2.4": ((0.1, 2.6, 2.5, 2.4), 0.4),
    "decimals 0.3 0.7 0.6 0.9": ((0.3, 0.7, 0.6, 0.9), 0.5),
    "square": ((1, 1, 1, 1), 1.0),
    "parallelogram 1 2": ((1, 2, 1, 2), 0.8),
    "parallelogram 1.7 3.3": ((1.7, 3.3, 1.7, 3.3), 1.9),
    "kite 1 1 2 2": ((1, 1, 2, 2), 1.9),
    "kite 1.5 1.5 0.8 0.8": ((1.5, 1.5, 0.8, 0.8), 0.6),
    "change point 1.2 2.9 2.3 1.8": ((1.2, 2.9, 2.3, 1.8), 1.0),
    "nearly a kite, 1e-3": ((1, 1.001, 2, 2), 1.9),
    "nearly a kite, 2e-6": ((1, 1.000002, 2, 2), 1.9),
    "nearly a kite, 1e-9": ((1, 1.000000001, 2, 2), 1.9),
    "nearly a parallelogram, 1e-3": ((1, 2, 1.001, 2), 0.8),
    "nearly a parallelogram, 1e-8": ((1, 2, 1.00000001, 2), 0.8),
    "short crank 1e-3 1 1 1": ((1e-3, 1, 1, 1), 0.5),
}

#: Crank, rod, offset of the slide, angle of the crank [rad].
SLIDER_CRANKS = {
    "in line 1 3": (1, 3, 0, 0.6),
    "offset 1 3 0.5": (1, 3, 0.5, 0.9),
    "offset, change point 1 3 2": (1, 3, 2, 0.7),
    "long crank 3 1 0": (3, 1, 0, 0.2),
    "equal links 1 1 0": (1, 1, 0, 0.8),
    "decimals 0.1 0.35 0.05": (0.1, 0.35, 0.05, 0.3),
}

#: Arcs [deg] of crank, coupler, rocker, ground; angle of the crank [rad].
SPHERICAL = {
    "crank-rocker 30 80 60 70": ((30, 80, 60, 70), 0.8),
    "change point 30 80 60 50": ((30, 80, 60, 50), 1.7),
    "right angles 90 90 90 60": ((90, 90, 90, 60), 0.7),
    "parallelogram 40 70 40 70": ((40, 70, 40, 70), 0.9),
    "triple rocker 80 80 80 40": ((80, 80, 80, 40), 0.9),
    "Hooke 90 90 90 150": ((90, 90, 90, 150), 0.4),
}


def families() -> Families:
    """All that have a name."""
    found: Families = {}
    for name, (lengths, angle) in FOUR_BARS.items():
        found[f"planar R R R R, {name}"] = partial(_four_bar, lengths, angle, "RRRR")
    for kinds in ("RSRR", "RRSR", "RSSR", "RSCR", "RCSR", "RRUR"):
        for name in ("crank-rocker 40 100 80 90", "decimals 0.3 0.7 0.6 0.9", "kite 1 1 2 2"):
            lengths, angle = FOUR_BARS[name]
            found[f"planar {' '.join(kinds)}, {name}"] = partial(_four_bar, lengths, angle, kinds)
    found["planar R R R R, a step between planes"] = partial(
        _four_bar, (40, 100, 80, 90), 0.7, "RRRR", step=25.0
    )
    found["planar R S S R, a step between planes"] = partial(
        _four_bar, (40, 100, 80, 90), 0.7, "RSSR", step=25.0
    )
    for name, given in SLIDER_CRANKS.items():
        for kinds in ("RRRP", "RSRP", "RRSP", "RSSP"):
            if kinds == "RRRP" or name in ("in line 1 3", "offset 1 3 0.5"):
                found[f"slider-crank {' '.join(kinds)}, {name}"] = partial(_slider_crank, *given, kinds)
    for name, (arcs, angle) in SPHERICAL.items():
        found[f"spherical R R R R, {name}"] = partial(_spherical, arcs, angle)
        if name in ("crank-rocker 30 80 60 70", "right angles 90 90 90 60"):
            found[f"spherical R R R R in one point, {name}"] = partial(_spherical, arcs, angle, together=True)
    found |= SPATIAL
    for name in loops():
        if name not in LEFT_OUT and "U" not in sb.load(name).kind:
            for row in (0, 7):
                found[f"gallery {name}, row {row}"] = partial(_of_gallery, name, row)
    return found


#: Of the gallery: those with universal joints aside, whose two axes a pose does not show.
LEFT_OUT = ("five_bar",)


def _of_gallery(name: str, row: int) -> Drawing:
    return redrawn(sb.load(name), row)


def _four_bar(lengths: tuple[float, ...], angle: float, kinds: str, *, step: float = 0.0) -> Drawing:
    """A four-bar in the plane with other joints on it, which its axes at the ground hold there."""
    crank, coupler, rocker, ground = lengths
    a = crank * np.array([math.cos(angle), math.sin(angle), 0.0])
    apart = np.array([ground, 0.0, 0.0]) - a
    length = float(np.linalg.norm(apart))
    x = (length**2 + coupler**2 - rocker**2) / (2 * length)
    y = math.sqrt(max(coupler**2 - x**2, 0.0))
    way = apart / length
    b = a + x * way + y * np.array([-way[1], way[0], 0.0])
    places = [np.zeros(3), a, b + step * Z, np.array([ground, 0.0, 0.0]) + step * Z]
    joints = []
    for kind, at in zip(kinds, places, strict=True):
        # the second axis of a cross lies in the plane, so the loop stays in it
        axes = {"S": (), "U": (np.stack([Z, X]),)}.get(kind, (Z,))
        joints.append((kind, at, *axes))
    return drawing(f"planar {kinds}", *joints)


def _slider_crank(crank: float, rod: float, offset: float, angle: float, kinds: str) -> Drawing:
    a = crank * np.array([math.cos(angle), math.sin(angle), 0.0])
    pin = np.array([a[0] + math.sqrt(rod**2 - (offset - a[1]) ** 2), offset, 0.0])
    places, axes = [np.zeros(3), a, pin, pin], [Z, Z, Z, X]
    joints = [
        (kind, at, *(() if kind == "S" else (axis,)))
        for kind, at, axis in zip(kinds, places, axes, strict=True)
    ]
    return drawing(f"slider-crank {kinds}", *joints)


def _spherical(arcs: tuple[float, ...], angle: float, *, together: bool = False) -> Drawing:
    """A spherical four-bar about (0.1, 0.2, 0.3), drawn on its sphere or with all places in the centre."""
    crank, coupler, rocker, ground = map(math.radians, arcs)
    first, last = Z, np.array([math.sin(ground), 0.0, math.cos(ground)])
    second = np.array([math.sin(crank) * math.cos(angle), math.sin(crank) * math.sin(angle), math.cos(crank)])
    # third: cos of its angles to second and last
    c = float(second @ last)
    u = (math.cos(coupler) - c * math.cos(rocker)) / (1 - c * c)
    v = (math.cos(rocker) - c * math.cos(coupler)) / (1 - c * c)
    flat = u * second + v * last
    third = flat + math.sqrt(max(1 - float(flat @ flat), 0.0)) * np.cross(second, last) / math.sqrt(1 - c * c)
    centre = np.array([0.1, 0.2, 0.3])
    joints = [("R", centre if together else centre + axis, axis) for axis in (first, second, third, last)]
    return drawing("spherical R R R R", *joints)


#: Kinds of the joints on a lattice, by their weights; their freedoms make 7 or 8.
LATTICE_KINDS = {"R": (1, 6.0), "S": (3, 1.5), "C": (2, 1.0), "P": (1, 1.0)}

#: Loops of the lattice in a whole run.
LATTICE = 3000

#: Places and directions are whole numbers up to these.
REACH, STEEP = 2, 1


def lattice(index: int, seed: int) -> Drawing:
    """A random loop on a lattice, of seven freedoms and perhaps an idle one."""
    rng = np.random.default_rng([seed, index])
    while True:
        one = _drawn(index, rng)
        try:
            one.linkage()
        except DescriptionError:
            # two joints in one place, say: refused however it is written
            continue
        return one


def _drawn(index: int, rng: np.random.Generator) -> Drawing:
    letters, weights = list(LATTICE_KINDS), np.array([w for _, w in LATTICE_KINDS.values()])
    while True:
        kinds: list[str] = ["R"]
        freedoms = 1
        while freedoms < 6:
            kind = str(rng.choice(letters, p=weights / weights.sum()))
            kinds.append(kind)
            freedoms += LATTICE_KINDS[kind][0]
        kinds.append("R")
        freedoms += 1
        spins = sum(a == b == "S" for a, b in pairwise(kinds))
        if freedoms == 7 + spins and 3 <= len(kinds) <= 7:
            break
    joints: list[tuple[object, ...]] = []
    for kind in kinds:
        at = rng.integers(-REACH, REACH + 1, 3)
        axis = (_way(rng),) if kind != "S" else ()
        joints.append((kind, at, *axis))
    return drawing(f"lattice {index}", *joints)


def _way(rng: np.random.Generator) -> Floats:
    """An axis of the lattice, most often along one of its lines."""
    if rng.random() < 0.7:
        return np.eye(3)[rng.integers(3)]
    while True:
        way = rng.integers(-STEEP, STEEP + 1, 3)
        if way.any():
            return way.astype(float)
