"""What is drawn and built of each kind of joint: one `Shape` for figures, the studio and exports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

from sevenbar.kinematics.loop.joints import JointKind, ShapeName

#: How far a hub may be shifted along its axis, and a slide across it, in heights of a hub.
SHIFTS, ASIDE = (0.0, 1.2, -1.2, 2.4, -2.4, 4.0, -4.0), 2.4


@dataclass(frozen=True)
class JointSolid:
    """A solid of a joint in the studio: a unit mesh of `studio.pictures.shapes` stretched between two places.

    `on`: the joint's axis as it turns, its first, last or each drawn axis, its centre, or the link that holds
    its ball; the middle of the solid is at a `share` of the distance from the first of the two places.
    `radius` and `length` are in units of thickness; a solid that `reaches` is wider by how far the joint
    slides in its plane. The `colour` is that of the joint or of that link, or one of the studio's.
    """

    mesh: str
    on: Literal["spin", "first", "last", "each", "centre", "link"]
    radius: float
    length: float
    colour: Literal["joint", "link", "steel", "bright"] = "joint"
    reaches: bool = False
    share: float = 0.5


@dataclass(frozen=True)
class Seat:
    """Where a joint's hubs sit in an export, in heights of a hub.

    `side` is that of the axis on which the sleeve lies, as seen from what carries the shaft; `shift` goes
    along the axis, `aside` across it. A universal joint has `side` and `other`, one for each of its axes.
    """

    side: int = 1
    shift: float = 0.0
    aside: tuple[float, float] = (0.0, 0.0)
    other: int = 1


@dataclass(frozen=True)
class Shape:
    """What is drawn and built of a kind of joint.

    In figures: the words of its `marks`; `half` their length along the axis, as a share of the linkage's
    extent, 0 for a mark at a point; its marker `legend`, and `legend_flat` where it is seen along its axis.
    In the studio: its `solids`; where it slides the `slider`, a mesh with its sizes across and along, in
    units of thickness. A plate or a slot is drawn wider than it slides, by shares `margins` along x and y.
    In exports: the `seats` that its hubs may have, and whether they are `square`.
    """

    marks: tuple[str, ...]
    half: float
    legend: Mapping[str, Any]
    legend_flat: Mapping[str, Any] | None = None
    solids: tuple[JointSolid, ...] = ()
    slider: tuple[str, float, float] = ("box", 1.9, 5.0)
    seats: tuple[Seat, ...] = tuple(Seat(side, shift) for side, shift in product((1, -1), SHIFTS))
    square: bool = False
    margins: tuple[float, float] = (1.0, 1.0)


#: The shape of each kind, by the word in its row.
_SHAPES: Mapping[ShapeName, Shape] = {
    "cylinder": Shape(
        ("cylinder",), 0.032,
        {"marker": "s", "ms": 7},
        legend_flat={"marker": "o", "ms": 7, "mfc": "white", "mew": 2.0, "mec": "#303030"},
        solids=(JointSolid("cylinder", "spin", 1.05, 3.4), JointSolid("cylinder", "spin", 0.5, 4.1, "steel")),
        slider=("cylinder", 1.05, 5.0),
    ),
    "block": Shape(
        ("block",), 0.04,
        {"marker": "s", "ms": 9, "mec": "#202020", "mew": 0.8},
        seats=tuple(
            Seat(side, shift, aside)
            for side, shift in product((1, -1), SHIFTS[:3])
            for aside in ((0.0, 0.0), (ASIDE, 0.0), (-ASIDE, 0.0), (0.0, ASIDE), (0.0, -ASIDE))
        ),
        square=True,
    ),
    "thread": Shape(
        ("cylinder", "thread"), 0.032,
        {"marker": "s", "ms": 6, "mfc": "white", "mew": 2.4},
        slider=("hexagon", 1.75, 2.2),
    ),
    "arm": Shape(
        ("arm",), 0.032,
        {"marker": "P", "ms": 8},
        solids=(JointSolid("cylinder", "each", 0.62, 5.0), JointSolid("ball", "centre", 0.95, 0.95)),
        seats=tuple(Seat(a, shift, other=b) for a, b, shift in product((1, -1), (1, -1), (0.0, 1.0))),
    ),
    "ball": Shape(
        ("ball",), 0.0,
        {"color": "#f4f4f4", "ls": "", "marker": "o", "ms": 8, "mec": "#303030", "mew": 2.4},
        solids=(
            JointSolid("ball", "centre", 1.2, 1.2, "bright"),
            JointSolid("socket", "link", 1.5, 1.5, "link", share=1.0),
        ),
        seats=(),
    ),
    "plate": Shape(
        ("block",), 0.04,
        {"marker": "D", "ms": 7, "mfc": "white", "mew": 1.6},
        solids=(
            JointSolid("cylinder", "first", 1.5, 0.4, "steel", reaches=True),
            JointSolid("cylinder", "last", 1.5, 1.4),
        ),
    ),
    "slot": Shape(
        ("cylinder",), 0.032,
        {"marker": "s", "ms": 7, "mfc": "white", "mew": 2.2},
        solids=(
            JointSolid("cylinder", "first", 1.5, 0.4, "steel", reaches=True),
            JointSolid("cylinder", "last", 0.7, 1.4),
        ),
        margins=(0.4, 0.6),
    ),
}  # fmt: skip

#: Half the height of a hinge, as a share of the linkage's extent.
HINGE_HALF = _SHAPES["cylinder"].half


def shape_of(kind: JointKind) -> Shape:
    """What is drawn and built of a kind of joint."""
    return _SHAPES[kind.shape]
