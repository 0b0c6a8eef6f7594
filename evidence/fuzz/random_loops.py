"""Random single loops with a pose that closes: Denavit-Hartenberg rows, and joints as drawn.

A loop with one pose needs no solver: seven axes anywhere in space are an assembled linkage. `general` reads
the rows off such axes; `rows` fixes the first links' lengths, twists and offsets as a special geometry wants
them and reads off the last two; the drawn families place joints as they like. Each case tells the input of
the pose that is known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import sevenbar as sb
from evidence.fuzz.random_linkages import random_rotation
from sevenbar.kinematics.loop.joints import KINDS


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of the Denavit-Hartenberg form and the joint values of one pose, both in loop order.

    Of a P joint `angle` is fixed and `offset` 0; of the others `offset` is fixed and `angle` 0.
    """

    kinds: str
    length: np.ndarray
    twist: np.ndarray
    offset: np.ndarray
    angle: np.ndarray
    pose: np.ndarray

    @property
    def theta(self) -> float:
        """The input at which the known pose closes."""
        return float(self.pose[0])

    def linkage(self, **options: Any) -> sb.Linkage:
        """As the product takes it."""
        angle = self.angle if "P" in self.kinds else None
        return sb.from_dh(
            self.kinds, length=self.length, twist=self.twist, offset=self.offset, angle=angle, **options
        )

    def begun_at(self, joint: int) -> Rows:
        """The same loop with another first joint, counted from 0."""
        arrays = (np.roll(a, -joint) for a in (self.length, self.twist, self.offset, self.angle, self.pose))
        return Rows(self.kinds[joint:] + self.kinds[:joint], *arrays)


@dataclass(frozen=True, eq=False)
class Drawn:
    """Joints as drawn, for `from_axes`; the drawn pose closes at input 0, `theta` is the input to take."""

    joints: tuple[Mapping[str, Any], ...]
    theta: float = 0.0

    @property
    def kinds(self) -> str:
        """One letter for each joint."""
        return "".join(joint["kind"] for joint in self.joints)

    def linkage(self, **options: Any) -> sb.Linkage:
        """As the product takes it."""
        return sb.from_axes(self.joints, **options)


Case = Rows | Drawn


def direction(rng: np.random.Generator) -> np.ndarray:
    """Uniform over all directions."""
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def angles(rng: np.random.Generator, count: int) -> np.ndarray:
    """Uniform over the circle."""
    return rng.uniform(-np.pi, np.pi, count)


# Denavit-Hartenberg rows


def step(angle: float, offset: float, length: float, twist: float) -> np.ndarray:
    """`Rz(angle) Tz(offset) Tx(length) Rx(twist)`."""
    c, s, ct, st = np.cos(angle), np.sin(angle), np.cos(twist), np.sin(twist)
    return np.array(
        [
            [c, -s * ct, s * st, length * c],
            [s, c * ct, -c * st, length * s],
            [0, st, ct, offset],
            [0, 0, 0, 1],
        ]
    )


def rows(
    rng: np.random.Generator,
    kinds: str,
    length: np.ndarray,
    twist: np.ndarray,
    offset: np.ndarray,
    pose: np.ndarray | None = None,
) -> Rows:
    """A loop whose links 1 to n - 2 are as given, closed by an axis n anywhere.

    `length`, `twist` are of links 1 to n - 2, `offset` of joints 2 to n - 2 (R) with the others read off;
    `pose` the joint values of joints 2 to n - 2 (random if left out).
    """
    count = len(kinds)
    inner = count - 3
    turns = angles(rng, inner) if pose is None else np.asarray(pose, dtype=np.float64)
    slides = np.where([k == "P" for k in kinds[1:-2]], rng.normal(size=inner), offset)
    # the frame of link 1 at the start of joint 2 is the origin
    frame = np.eye(4)
    for k in range(inner):
        frame = frame @ step(turns[k], slides[k], length[k + 1], twist[k + 1])
    first = np.linalg.inv(step(0.0, 0.0, length[0], twist[0]))
    # what is known: the lines of joints 1 and n - 1 with the common normals x_1 and x_(n-2)
    z1, x1, p1 = first[:3, 2], first[:3, 0], first[:3, 3]
    z6, x5, p6 = frame[:3, 2], frame[:3, 0], frame[:3, 3]
    z7, p7 = direction(rng), rng.normal(size=3)
    foot6, foot7a, x6, a6, alpha6 = common_normal(rng, p6, z6, p7, z7)
    foot7, foot1, x7, a7, alpha7 = common_normal(rng, p7, z7, p1, z1)
    all_length = np.array([*length, a6, a7])
    all_twist = np.array([*twist, alpha6, alpha7])
    joint_angle = np.array([_angle(z1, x7, x1), *turns, _angle(z6, x5, x6), _angle(z7, x6, x7)])
    joint_offset = np.array([(p1 - foot1) @ z1, *slides, (foot6 - p6) @ z6, (foot7 - foot7a) @ z7])
    sliding = np.array([k == "P" for k in kinds])
    return Rows(
        kinds,
        all_length,
        all_twist,
        np.where(sliding, 0.0, joint_offset),
        np.where(sliding, joint_angle, 0.0),
        np.where(sliding, joint_offset, joint_angle),
    )


def common_normal(
    rng: np.random.Generator, p: np.ndarray, z: np.ndarray, q: np.ndarray, w: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float, float]:
    """The feet on both lines, the direction between them (either way), the signed distance and the twist."""
    normal = np.cross(z, w)
    x = normal / np.linalg.norm(normal) * rng.choice([-1, 1])
    apart = q - p
    c = z @ w
    s = (apart @ z - c * (apart @ w)) / (1 - c * c)
    t = (c * (apart @ z) - apart @ w) / (1 - c * c)
    return p + s * z, q + t * w, x, float(apart @ x), float(np.arctan2(normal @ x, c))


def _angle(axis: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    return float(np.arctan2(np.cross(start, end) @ axis, start @ end))


def general(rng: np.random.Generator, kinds: str = "RRRRRRR") -> Rows:
    """Lengths and offsets normal, twists and angles uniform: no two axes meet or are parallel."""
    inner = len(kinds) - 2
    return rows(rng, kinds, rng.normal(size=inner), angles(rng, inner), rng.normal(size=inner - 1))


def _special(
    rng: np.random.Generator, kinds: str = "RRRRRRR"
) -> tuple[str, np.ndarray, np.ndarray, np.ndarray]:
    inner = len(kinds) - 2
    return kinds, rng.normal(size=inner), angles(rng, inner), rng.normal(size=inner - 1)


def _closed(
    rng: np.random.Generator,
    parts: tuple[str, np.ndarray, np.ndarray, np.ndarray],
    pose: np.ndarray | None = None,
) -> Rows:
    """Closed, and begun at any joint."""
    loop = rows(rng, *parts, pose)
    return loop.begun_at(int(rng.integers(len(loop.kinds))))


def parallel_neighbours(rng: np.random.Generator) -> Rows:
    """One to three pairs of neighbouring axes are parallel, no three of them."""
    kinds, length, twist, offset = _special(rng)
    pairs = ([0], [0, 2], [1, 3], [0, 2, 4], [2])[int(rng.integers(5))]
    twist[pairs] = rng.choice([0.0, np.pi], len(pairs))
    return _closed(rng, (kinds, length, twist, offset))


def three_parallel(rng: np.random.Generator) -> Rows:
    """Three axes in a row are parallel; now and then another three."""
    kinds, length, twist, offset = _special(rng)
    start = int(rng.integers(4))
    twist[start : start + 2] = rng.choice([0.0, np.pi], 2)
    if start == 0 and rng.random() < 0.5:
        twist[3:5] = 0.0
        # no turn of the seventh axis is made up for by two such triples: it stands still and cannot drive
        return rows(rng, kinds, length, twist, offset).begun_at(int(rng.integers(6)))
    return _closed(rng, (kinds, length, twist, offset))


def intersecting_neighbours(rng: np.random.Generator) -> Rows:
    """One to five pairs of neighbouring axes meet, at places of their own."""
    kinds, length, twist, offset = _special(rng)
    length[rng.random(5) < 0.6] = 0.0
    length[rng.integers(5)] = 0.0
    return _closed(rng, (kinds, length, twist, offset))


def coaxial(rng: np.random.Generator) -> Rows:
    """Two axes next but one can come onto one line: `a, alpha` alike on both links, no offset between."""
    kinds, length, twist, offset = _special(rng)
    at = int(rng.integers(4))
    length[at + 1], twist[at + 1] = length[at], twist[at]
    offset[at] = 0.0
    pose = angles(rng, 4)
    if rng.random() < 0.3:
        pose[at] = np.pi
    return _closed(rng, (kinds, length, twist, offset), pose)


def zero_lengths(rng: np.random.Generator) -> Rows:
    """Lengths and offsets vanish at random."""
    kinds, length, twist, offset = _special(rng)
    length, offset = _thinned(rng, length), _thinned(rng, offset)
    return _closed(rng, (kinds, length, twist, _without_four_in_a_point(length, offset)))


def right_twists(rng: np.random.Generator) -> Rows:
    """Twists of 0, 90, 180 and -90 degrees at random."""
    kinds, length, twist, offset = _special(rng)
    return _closed(rng, (kinds, length, _squared(rng, twist), offset))


def right_and_zero(rng: np.random.Generator) -> Rows:
    """Both: as drawn by people, with lengths and offsets of a few round values."""
    kinds, length, twist, offset = _special(rng)
    twist = _squared(rng, twist, share=0.85)
    length = _thinned(rng, np.round(length * 2) / 2)
    # axes on one line are one joint, not two
    length[(np.sin(twist) == 0) | (np.abs(np.sin(twist)) < 1e-9)] = 1.0
    offset = _without_four_in_a_point(length, _thinned(rng, np.round(offset * 2) / 2))
    return _closed(rng, (kinds, length, twist, offset))


def spherical_wrist(rng: np.random.Generator) -> Rows:
    """Three axes in a row meet in one point; half of them with right twists between."""
    kinds, length, twist, offset = _special(rng)
    start = int(rng.integers(4))
    length[start : start + 2] = 0.0
    offset[start] = 0.0
    if rng.random() < 0.5:
        twist[start : start + 2] = rng.choice([np.pi / 2, -np.pi / 2], 2)
    return _closed(rng, (kinds, length, twist, offset))


def prismatic(count: int) -> Callable[[np.random.Generator], Rows]:
    """Seven joints, so many of them slides, with some lengths zero and some twists right."""

    def draw(rng: np.random.Generator) -> Rows:
        letters = np.array(["R"] * 7)
        letters[rng.choice(7, count, replace=False)] = "P"
        kinds, length, twist, offset = _special(rng, "".join(letters))
        if rng.random() < 0.5:
            twist, length = _squared(rng, twist, share=0.4), _thinned(rng, length, share=0.3)
            flat = np.abs(np.sin(twist)) < 1e-9
            twist[flat] = np.pi / 2
        return _closed(rng, (kinds, length, twist, offset))

    return draw


def _thinned(rng: np.random.Generator, values: np.ndarray, share: float = 0.45) -> np.ndarray:
    return np.where(rng.random(values.size) < share, 0.0, values)


def _without_four_in_a_point(length: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Offsets with which no four axes in a row meet: such a part moves alone, the others cannot drive."""
    kept = offset.copy()
    for k in range(3):
        if not length[k : k + 3].any() and not kept[k : k + 2].any():
            kept[k] = 1.0
    return kept


def _squared(rng: np.random.Generator, twist: np.ndarray, share: float = 0.6) -> np.ndarray:
    chosen = rng.choice([0.0, np.pi / 2, np.pi, -np.pi / 2], twist.size, p=[0.2, 0.35, 0.1, 0.35])
    return np.where(rng.random(twist.size) < share, chosen, twist)


# Joints as drawn

#: Loops of more than one-freedom joints with Gruebler count 1, or 2 with an idle spin between two balls.
COMPOUND = (
    "RCCC", "RSCR", "RSUR", "RRSC", "RUUC", "CUUR", "RRRSR", "RRCRRR", "RUURR", "CRCRR", "RSRRR", "RUCRR",
    "RSPRR", "PSUR", "UUCR", "USU", "CSC", "RRSS", "RSSR", "RSSP", "PSSP", "RPUUR", "PPSC",
)  # fmt: skip


#: Loops of Gruebler count 1 with joints that slide in a plane.
PLANAR = ("RURE", "RERC", "ERRRR", "RRERR", "RRRER", "REUP", "PERRR", "EUC", "CEU", "RRCE")


def place(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    """A joint of a kind anywhere."""
    joint: dict[str, Any] = {"kind": kind, "at": rng.normal(size=3)}
    if "axis" in KINDS[kind].drawn_keys:
        joint["axis"] = direction(rng)
    if kind == "H":
        joint["pitch"] = float(rng.choice([-1, 1]) * 10 ** rng.uniform(-1, 1))
    if kind == "U":
        first = direction(rng)
        second = np.cross(first, direction(rng))
        # a cross has its axes square; others exist
        joint["axes"] = [first, second + (0.0 if rng.random() < 0.7 else rng.normal()) * first]
    return joint


def compound(rng: np.random.Generator, kinds: str = "") -> Drawn:
    """C, U and S joints anywhere; now and then parallel or meeting axes."""
    chosen = kinds or str(rng.choice(COMPOUND))
    joints = [place(rng, kind) for kind in chosen]
    if rng.random() < 0.3:
        # parallel slides move together and leave the input nothing to drive
        lined = [joint for joint in joints if joint["kind"] in "RC"]
        if len(lined) >= 2:
            one, other = rng.choice(len(lined), 2, replace=False)
            if rng.random() < 0.5 and "R" in lined[one]["kind"] + lined[other]["kind"]:
                lined[one]["axis"] = lined[other]["axis"]
            else:
                lined[one]["at"] = lined[other]["at"]
    return Drawn(tuple(joints), _near_or_at(rng))


def drawn(rng: np.random.Generator, kinds: str = "RRRRRRR") -> Drawn:
    """Axes anywhere in space."""
    return Drawn(tuple(place(rng, kind) for kind in kinds), _near_or_at(rng))


def planar(rng: np.random.Generator) -> Drawn:
    """A joint that slides in a plane among others, anywhere."""
    return drawn(rng, str(rng.choice(PLANAR)))


def screws(rng: np.random.Generator) -> Drawn:
    """Seven freedoms, one to three of them screws."""
    letters = np.array(["R"] * 7)
    letters[rng.choice(7, 2, replace=False)] = "P", "R"
    letters[rng.choice(7, int(rng.integers(1, 4)), replace=False)] = "H"
    return drawn(rng, "".join(letters))


def _near_or_at(rng: np.random.Generator) -> float:
    return 0.0 if rng.random() < 0.3 else float(rng.uniform(-0.5, 0.5))


# Overconstrained loops


def bennett(rng: np.random.Generator) -> Rows:
    """Opposite links alike, `a / sin(alpha) = b / sin(beta)`, no offsets: tan(t1/2) tan(t2/2) is constant."""
    alpha, beta = rng.uniform(0.2, 2.9, 2)
    size = 10 ** rng.uniform(-0.5, 0.5)
    a, b = size * np.sin(alpha), size * np.sin(beta)
    theta = rng.uniform(-np.pi, np.pi)
    product = np.sin((alpha + beta) / 2) / np.sin((beta - alpha) / 2)
    other = 2 * np.arctan2(product, np.tan(theta / 2))
    pose = np.array([theta, other, -theta, -other])
    zero = np.zeros(4)
    return Rows("RRRR", np.array([a, b, a, b]), np.array([alpha, beta, alpha, beta]), zero, zero, pose)


def planar_four_bar(rng: np.random.Generator) -> Drawn:
    """Four parallel axes, anywhere in space."""
    rotation, shift = random_rotation(rng), rng.normal(size=3)
    joints = tuple(
        {
            "kind": "R",
            "at": rotation @ rng.normal(size=3) + shift,
            "axis": rng.choice([-1, 1]) * rotation[:, 2],
        }
        for _ in range(4)
    )
    return Drawn(joints, _near_or_at(rng))


def spherical_four_bar(rng: np.random.Generator) -> Drawn:
    """Four axes through one point, each drawn somewhere along itself."""
    centre = rng.normal(size=3)
    axes = [direction(rng) for _ in range(4)]
    joints = tuple({"kind": "R", "at": centre + rng.normal() * axis, "axis": axis} for axis in axes)
    return Drawn(joints, _near_or_at(rng))


#: Special geometry of seven R and P joints.
SPECIAL: dict[str, Callable[[np.random.Generator], Case]] = {
    "parallel neighbours": parallel_neighbours,
    "three parallel axes": three_parallel,
    "intersecting neighbours": intersecting_neighbours,
    "coaxial": coaxial,
    "zero lengths": zero_lengths,
    "right twists": right_twists,
    "right twists and zero lengths": right_and_zero,
    "spherical wrist": spherical_wrist,
    "one slide": prismatic(1),
    "two slides": prismatic(2),
    "three slides": prismatic(3),
    "compound joints": compound,
}

OVERCONSTRAINED: dict[str, Callable[[np.random.Generator], Case]] = {
    "Bennett": bennett,
    "planar 4R": planar_four_bar,
    "spherical 4R": spherical_four_bar,
}
