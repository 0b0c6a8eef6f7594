"""Design tasks made from linkages that are known: their own motion is wanted, of a start that is off."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import sevenbar as sb
from sevenbar.arrays import Floats, Integers
from sevenbar.description.draft import Draft
from sevenbar.design.task import DesignTask, FreeNumber, FunctionWant, PathWant, PoseWant
from sevenbar.errors import SevenbarError
from sevenbar.kinematics.circuits.circuit import Circuit

#: By how much a start is off, of each number.
SHARES = (0.05, 0.2)

#: Parts of its size within which a length may be, from the start; angles [deg], numbers of a direction.
LENGTHS, ANGLES, NUMBERS = 0.6, 60.0, 0.6

#: Inputs of a turn at which the known motion is taken.
ROWS = 48


@dataclass(frozen=True)
class Made:
    """A task whose known answer has the error 0."""

    name: str
    share: float
    task: DesignTask


def known(kind: str, random: np.random.Generator) -> Draft:
    """A linkage of a family with numbers at random around those of a usual one."""
    if kind == "RSSR":
        linkage = sb.rssr(
            M=random.uniform(400, 800),
            N=random.uniform(300, 800),
            L1=random.uniform(120, 260),
            L3=random.uniform(350, 650),
            D=random.uniform(-150, 150),
            L2=random.uniform(800, 1100),
        )
        return Draft.of_linkage(linkage).with_point("Q", 2, (300.0, 120.0, -80.0))
    names = {
        "planar 4R": "planar_4r",
        "spherical 4R": "spherical_4r",
        "slider-crank": "engine",
        "RSCR": "rscr",
        "RSUR": "rsur",
        "RSSP": "rssp",
        "7R": "seven_r",
    }
    draft = Draft.of_linkage(sb.load(names[kind])).holding()
    return off(draft, varied(draft, kind), 0.1, random)


def varied(draft: Draft, kind: str) -> list[str]:
    """The names of the numbers that may change alone without opening the loop."""
    names = [d.name for d in draft.dimensions if d.kind in ("length", "angle")]
    own = {
        "RSSR": ("M", "N", "L1", "L2", "L3", "D", "Q."),
        "planar 4R": ("length_", "Q."),
        "slider-crank": ("crank_pin.x", "crank_pin.y", "wrist_pin.x", "wrist_pin.y", "Q."),
        "spherical 4R": ("twist_", "Q."),
        "7R": ("length_", "Q."),
    }.get(kind)
    if own is None:
        # as drawn: places of joints, but the axes and what lies along them
        own = (*(f"{joint.name}." for joint in draft.linkage.joints[1:]), "Q.")
    return [name for name in names if name.startswith(own)]


def size_of(draft: Draft) -> float:
    """The longest dimension; 100 of a spherical linkage, which has none."""
    return max(abs(d.value) for d in draft.dimensions if d.kind == "length") or 100.0


def off(draft: Draft, names: list[str], share: float, random: np.random.Generator) -> Draft:
    """A draft whose numbers are off by up to a share of each, at random, and angles of it [rad]."""
    size = size_of(draft)
    values = {}
    for name in names:
        d = draft.dimension(name)
        angle = d.kind == "angle"
        step = np.degrees(share * 0.5) if angle else share * max(abs(d.value), 0.05 * size)
        values[name] = d.value + step * random.uniform(-1, 1)
    return draft.with_values(values)


def bounds(draft: Draft, names: list[str]) -> tuple[FreeNumber, ...]:
    """Bounds around a start."""
    size = size_of(draft)
    found = []
    for name in names:
        d = draft.dimension(name)
        reach = ANGLES if d.kind == "angle" else LENGTHS * size
        low = max(d.value - reach, 0.05 * d.value) if d.positive else d.value - reach
        found.append(FreeNumber(name, low, d.value + reach))
    return tuple(found)


def stretch(circuit: Circuit, count: int, random: np.random.Generator, most: float) -> Integers | None:
    """Rows (count,) of a circuit along one pass, over `most` of it at the most."""
    rows = np.flatnonzero((circuit.branch == circuit.branch[0]) & (circuit.status == "ok"))
    if len(rows) < 2 * count:
        return None
    width = int(random.uniform(0.6, 1.0) * most * len(rows))
    if width < count:
        return None
    begin = random.integers(0, len(rows) - width + 1)
    return np.asarray(rows[begin + np.unique(np.linspace(0, width - 1, count).astype(int))])


def turned(random: np.random.Generator) -> Floats:
    """A rotation (3, 3) at random."""
    q, _ = np.linalg.qr(random.standard_normal((3, 3)))
    return np.asarray(q * np.linalg.det(q))


#: What is varied of kinds of tasks: the linkage, how many points, how the linkage may stand, timing.
PATHS = (
    ("RSSR", 12, "fixed", True),
    ("RSSR", 10, "free", True),
    ("RSSR", 12, "fixed", False),
    ("planar 4R", 10, "fixed", True),
    ("planar 4R", 9, "free", False),
    ("slider-crank", 9, "fixed", True),
    ("spherical 4R", 8, "fixed", False),
    ("RSCR", 10, "fixed", True),
    ("RSUR", 12, "free", True),
    ("7R", 12, "fixed", False),
)
FUNCTIONS = (
    ("RSSR", 6),
    ("RSSR", 8),
    ("RSSR", 20),
    ("planar 4R", 5),
    ("planar 4R", 9),
    ("slider-crank", 6),
    ("spherical 4R", 5),
    ("RSCR", 8),
    ("RSUR", 8),
    ("RSSP", 7),
)
POSES = (
    ("RSSR", 3, "fixed", True),
    ("RSSR", 3, "free", True),
    ("planar 4R", 2, "fixed", True),
    ("planar 4R", 2, "fixed", False),
    ("slider-crank", 2, "fixed", False),
    ("spherical 4R", 2, "fixed", True),
    ("RSCR", 2, "fixed", True),
    ("RSUR", 2, "fixed", False),
    ("RSUR", 2, "free", True),
    ("7R", 3, "fixed", True),
)


def with_point(draft: Draft, kind: str) -> Draft:
    """The draft with a point Q, on the coupler, for a path."""
    if any(point.name == "Q" for point in draft.linkage.points):
        return draft
    size = size_of(draft)
    link = 3 if kind == "7R" else 2
    joints = draft.linkage.description.get("joint")
    place = np.array(joints[1]["at"], dtype=float) if joints else np.zeros(3)
    return draft.with_point("Q", link, tuple(place + size * np.array([0.2, 0.3, -0.15])))


def _made(kind: str, share: float, random: np.random.Generator, family: str, how: tuple) -> Made | None:
    draft = known(kind, random)
    if family == "path":
        draft = with_point(draft, kind)
    names = [n for n in varied(draft, kind) if family == "path" or not n.startswith("Q.")]
    motion = draft.linkage.motion(ROWS)
    if not motion.circuits:
        return None
    circuit = motion.circuits[int(random.integers(len(motion.circuits)))]
    count = how[1] if family != "poses" else 6
    rows = stretch(circuit, count, random, 0.9 if family == "path" else 0.5)
    if rows is None:
        return None
    start = off(draft, names, share, random)
    free = bounds(start, names)
    inputs = circuit.input[rows]
    title = f"{kind}, {family}"
    if family == "function":
        want = FunctionWant(inputs - inputs[0], circuit.output[rows] - circuit.output[rows][0], (None, None))
        return Made(f"{title} of {len(rows)} points", share, DesignTask(start, free, (want,)))
    placement, timed = how[2:]
    turn, shift = (turned(random), random.uniform(-100, 100, 3)) if placement == "free" else (np.eye(3), 0.0)
    title += (", placed freely" if placement == "free" else "") + (", timed" if timed else "")
    if family == "path":
        places = circuit.point("Q").position[rows] @ turn.T + shift
        want = PathWant("Q", places, False, inputs if timed else None)
        return Made(title, share, DesignTask(start, free, (want,), placement=placement))
    link = how[1]
    zero = circuit.point(link, (0.0, 0.0, 0.0)).position[rows]
    ends = [circuit.point(link, tuple(end)).position[rows] - zero for end in np.eye(3)]
    poses = np.broadcast_to(np.eye(4), (len(rows), 4, 4)).copy()
    poses[:, :3, :3] = turn @ np.stack(ends, axis=2)
    poses[:, :3, 3] = zero @ turn.T + shift
    arm = 0.3 * size_of(draft)
    want = PoseWant(link, poses, arm, inputs if timed else None)
    return Made(title, share, DesignTask(start, free, (want,), placement=placement))


def cusps(seed: int = 1) -> Iterator[Made]:
    """An RSUR's untimed path with a cusp between points, fixed and placed freely."""
    draft = Draft.of_linkage(sb.load("rsur")).with_point("Q", 2, (300.0, 120.0, 80.0))
    path = draft.linkage.motion(16).circuits[0].point("Q").position
    names = ["ball.x", "ball.z", "cross.y", "Q.x", "Q.y", "Q.z"]
    for share in SHARES:
        for placement in ("fixed", "free"):
            random = np.random.default_rng(seed)
            start = off(draft, names, share, random)
            places = path if placement == "fixed" else path @ turned(random).T + random.uniform(-100, 100, 3)
            task = DesignTask(start, bounds(start, names), (PathWant("Q", places),), placement=placement)
            yield Made(f"RSUR, path with a cusp, {placement}", share, task)


def tasks(family: str, seed: int = 0) -> Iterator[Made]:
    """The tasks of a family (path, function, poses, cusp): each kind from a start 5 % and 20 % off."""
    if family == "cusp":
        yield from cusps()
        return
    kinds = {"path": PATHS, "function": FUNCTIONS, "poses": POSES}[family]
    for number, how in enumerate(kinds):
        for place, share in enumerate(SHARES):
            random = np.random.default_rng([seed, number, place, len(family)])
            while True:
                try:
                    made = _made(how[0], share, random, family, how)
                except SevenbarError:
                    continue
                if made is not None:
                    yield made
                    break
