"""Nets in space: all modes against a search over the poses of all links, and each mode on one circuit.

The search shares nothing with the core: its unknowns are a quaternion and a place of each link, its rows
vectors that must be equal, so that none is turned over; it has no tree, no blocks, no legs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

import sevenbar as sb
from evidence.certainty.family import Family
from evidence.certainty.nets import STARTS, complete, isolated
from sevenbar.arrays import Floats

PART = "Several loops in space"

#: Joints and rods (-) between links; the first drives. F is the ground.
KINDS = {
    "RSSR-SS": "R F A|S A B|S B C|R C F|- F B",
    "double wishbone with track rod": "R F A|S A B|R F C|S C B|- F B",
    "coupler on a crank and three rods, a rocker on it": "R F A|S A B|- F B|- F B|- F B|R F C|- B C",
    "coupler on a crank, a slide and a rod": "R F A|S A B|P F C|S C B|- F B",
    "coupler between crank and hinge, a universal leg": "R F A|S A B|U F C|S C B|- F B|- F B",
    "platform on six legs, one driven": "P T Q|U F T|S Q B|- F B|- F B|- F B|- F B|- F B",
    "three legs on hinges, one on a crank": "R F A|U A T|S T B|R F C|S C B|R F D|S D B|- F B",
    "RSSR": "R F A|- A C|R C F",
    "RSSR train": "R F A|- A C|R C F|- C D|R D F",
    "rod to a slide": "R F A|- A C|P C F",
    "rods of a crank to a cylinder joint": "R F A|C F B|- A B|- A B",
    "rods of a crank to a universal joint": "R F A|U F B|- A B|- A B",
    "rods of a crank to a link on a ball, a slide on it": "R F A|S F B|- A B|- A B|- A B|P F C|- B C",
    "coupler on a universal joint, a rod to a rocker": "R F A|U A B|R F C|- B C|- F B|- F B",
    "planar four-bar and RSSR": "R F A|R A B|R B C|R C F|- C D|R D F",
}

#: Linkages of each kind.
COUNT = 40


@dataclass(frozen=True)
class Piece:
    """A joint or a rod of two links as drawn: places on both, its axis, a direction across it."""

    kind: str
    links: tuple[str, str]
    at: tuple[Floats, Floats]
    axis: Floats
    across: Floats


@dataclass(frozen=True)
class SpatialNet:
    """Joints and rods, of which the first drives."""

    pieces: Sequence[Piece]

    def linkage(self) -> sb.Linkage:
        """The same as a linkage."""
        joints, rods = [], []
        for k, piece in enumerate(self.pieces):
            row = {"name": f"j{k}", "between": piece.links}
            if piece.kind == "-":
                rods.append(row | {"at": [list(at) for at in piece.at]})
                continue
            row |= {"kind": piece.kind, "at": list(piece.at[0])}
            if piece.kind == "U":
                row["axes"] = [list(piece.axis), list(piece.across)]
            elif piece.kind != "S":
                row["axis"] = list(piece.axis)
            joints.append(row)
        return sb.from_axes(joints, rods=rods, ground="F", drive="j0")

    @property
    def moving(self) -> list[str]:
        """The links but the ground."""
        return list(dict.fromkeys(link for piece in self.pieces for link in piece.links if link != "F"))

    @property
    def slides(self) -> bool:
        """Whether the input slides."""
        return self.pieces[0].kind == "P"

    def flat(self, frames: Floats) -> Floats:
        """Poses (m, links, 4, 4) as numbers (m, links, 12)."""
        return frames[:, :, :3].reshape(*frames.shape[:2], 12)

    def open_by(self, frames: Floats, value: float) -> float:
        """The greatest error of a row at poses (m, links, 4, 4)."""
        count = len(self.moving)
        x = np.zeros((len(frames), count, 7))
        x[..., 4:] = frames[..., :3, 3]
        for n, rotations in enumerate(frames[..., :3, :3]):
            for k, rotation in enumerate(rotations):
                # the eigenvector of 1 is the quaternion's direction (Bar-Itzhack 2000)
                r = rotation
                matrix = np.array(
                    [
                        [r.trace(), r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
                        [0, r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
                        [0, 0, r[1, 1] - r[0, 0] - r[2, 2], r[1, 2] + r[2, 1]],
                        [0, 0, 0, r[2, 2] - r[0, 0] - r[1, 1]],
                    ]
                )
                x[n, k, :4] = np.linalg.eigh(matrix, UPLO="U")[1][:, -1]
        error, _ = self.equations(x.reshape(len(frames), 7 * count), value)
        return float(np.abs(error).max(initial=0.0))

    def equations(self, x: Floats, value: float) -> tuple[Floats, Floats]:
        """Errors (starts, rows) of all joints, rods, unit quaternions and the input; derivatives by x."""
        moving, count = self.moving, len(x)
        zero = np.zeros((count, 3, x.shape[1]))
        errors: list[Floats] = []
        slopes: list[Floats] = []

        def image(link: str, v: Floats, *, place: bool) -> tuple[Floats, Floats]:
            """A vector or a place of a link (starts, 3), and its derivatives."""
            slope = zero.copy()
            if link == "F":
                return np.broadcast_to(v, (count, 3)), slope
            first = 7 * moving.index(link)
            w, u = x[:, first : first + 1], x[:, first + 1 : first + 4]
            uv, dot = np.cross(u, v), u @ v
            turned = (w**2 - (u**2).sum(1, keepdims=True)) * v + 2 * dot[:, None] * u + 2 * w * uv
            slope[:, :, first] = 2 * w * v + 2 * uv
            for k, e in enumerate(np.eye(3)):
                by = -2 * u[:, k : k + 1] * v + 2 * v[k] * u + 2 * dot[:, None] * e + 2 * w * np.cross(e, v)
                slope[:, :, first + 1 + k] = by
            if place:
                turned = turned + x[:, first + 4 : first + 7]
                slope[:, :, first + 4 : first + 7] = np.eye(3)
            return turned, slope

        def equal(a: tuple[Floats, Floats], b: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
            return a[0] - b[0], a[1] - b[1]

        def product(a: tuple[Floats, Floats], b: tuple[Floats, Floats], less: float) -> None:
            errors.append((a[0] * b[0]).sum(1, keepdims=True) - less)
            slopes.append(
                (np.einsum("sk,skn->sn", a[0], b[1]) + np.einsum("sk,skn->sn", b[0], a[1]))[:, None]
            )

        def add(row: tuple[Floats, Floats]) -> None:
            errors.append(row[0])
            slopes.append(row[1])

        for number, piece in enumerate(self.pieces):
            (a, b), (p, q) = piece.links, piece.at
            apart = equal(image(b, q, place=True), image(a, p, place=True))
            axis, across = piece.axis, piece.across
            if piece.kind == "-":
                product(apart, apart, float(((p - q) ** 2).sum()))
            elif piece.kind in "RSU":
                add(apart)
            else:
                product(apart, image(a, across, place=False), 0.0)
                product(apart, image(a, np.cross(axis, across), place=False), 0.0)
            if piece.kind in "RPC":
                add(equal(image(a, axis, place=False), image(b, axis, place=False)))
            if piece.kind == "P":
                add(equal(image(a, across, place=False), image(b, across, place=False)))
            if piece.kind == "U":
                product(image(a, axis, place=False), image(b, across, place=False), 0.0)
            if number == 0 and piece.kind == "P":
                product(apart, image(a, axis, place=False), value)
            elif number == 0:
                turned = np.cos(value) * across + np.sin(value) * np.cross(axis, across)
                add(equal(image(b, across, place=False), image(a, turned, place=False)))
        for k in range(len(moving)):
            quaternion = x[:, 7 * k : 7 * k + 4]
            slope = np.zeros((count, 1, x.shape[1]))
            slope[:, 0, 7 * k : 7 * k + 4] = 2 * quaternion
            add(((quaternion**2).sum(1, keepdims=True) - 1.0, slope))
        return np.concatenate(errors, axis=1), np.concatenate(slopes, axis=1)

    def modes(self, value: float, rng: np.random.Generator) -> Floats:
        """Isolated poses (modes, links, 12) with the input at a value: where damped steps end."""
        count = len(self.moving)
        x = rng.normal(size=(STARTS, count, 7))
        x[..., :4] /= np.linalg.norm(x[..., :4], axis=-1, keepdims=True)
        # a few starts would run away
        found = isolated(
            partial(self.equations, value=value),
            x.reshape(STARTS, -1),
            lambda pose: self.flat(as_frames(pose.reshape(count, 7))[None])[0],
            longest=1.0,
        )
        return np.array(found).reshape(len(found), count, 12)


def as_frames(states: Floats) -> Floats:
    """Quaternions and places (links, 7) as frames (links, 4, 4)."""
    w, x, y, z = states[:, :4].T
    frames = np.zeros((len(states), 4, 4))
    frames[:, :3, :3] = np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    ).transpose(2, 0, 1)
    frames[:, :3, 3] = states[:, 4:]
    frames[:, 3, 3] = 1.0
    return frames


def drawn(kind: str, rng: np.random.Generator) -> SpatialNet:
    """A net of a kind: with places and axes anywhere, or in decimals as people draw."""
    decimals = rng.random() < 0.5
    pieces = []

    def place() -> Floats:
        at = rng.uniform(-1, 1, 3)
        return at.round(1) if decimals else at

    planar = kind.startswith("planar")
    for number, text in enumerate(KINDS[kind].split("|")):
        letter, first, second = text.split()
        at = place()
        axis = rng.normal(size=3)
        if decimals:
            axis = rng.choice([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, -1]]).astype(float)
        if planar and number < 4:
            axis = np.array([0.0, 0.0, 1.0])
        axis /= np.linalg.norm(axis)
        across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
        across /= np.linalg.norm(across)
        ends = (at, place()) if letter == "-" else (at, at)
        pieces.append(Piece(letter, (first, second), ends, axis, across))
    return SpatialNet(pieces)


FAMILIES = [Family(PART, kind, COUNT, complete(partial(drawn, kind)), quick=1) for kind in KINDS]
