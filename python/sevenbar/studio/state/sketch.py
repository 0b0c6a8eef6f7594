"""A linkage that is begun in the studio: from a kind of the gallery, or from places that are written down."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sevenbar.description.draft import Draft, plain_number
from sevenbar.description.gallery import text
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.loop.joints import JOINT_KINDS, KINDS

Vector = tuple[float, float, float]

#: Fewest and most joints of a loop.
FEWEST, MOST = 2, 12

#: A loop with more freedoms than these moves in space, whatever its axes.
PLANAR_FREEDOMS = 6

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class DrawnJoint:
    """A joint as it is drawn: its kind, its place, its axes as far as its kind has them, its pitch."""

    kind: str
    at: Vector
    axes: tuple[Vector, Vector] = (Z, Y)
    pitch: float = 10.0
    name: str = ""

    @property
    def axis_count(self) -> int:
        """How many axes its kind has."""
        return sum({"axis": 1, "axes": 2}.get(key, 0) for key in KINDS[self.kind].drawn_keys)

    @property
    def has_pitch(self) -> bool:
        """Whether its kind has a pitch."""
        return "pitch" in KINDS[self.kind].drawn_keys

    @property
    def table(self) -> dict[str, Any]:
        """Its table in a file."""
        result: dict[str, Any] = {"name": self.name.strip()} if self.name.strip() else {}
        result |= {"kind": self.kind, "at": [plain_number(float(x)) for x in self.at]}
        values = {
            "axis": [plain_number(float(x)) for x in self.axes[0]],
            "axes": [[plain_number(float(x)) for x in axis] for axis in self.axes],
            "pitch": plain_number(self.pitch),
        }
        return result | {key: values[key] for key in KINDS[self.kind].drawn_keys}


#: Where to begin: loops that move, by their kinds.
BEGINNINGS: Mapping[str, tuple[DrawnJoint, ...]] = {
    "RRRR": (
        DrawnJoint("R", (0, 0, 0), name="crank"),
        DrawnJoint("R", (0, 40, 0), name="a"),
        DrawnJoint("R", (100, 80, 0), name="b"),
        DrawnJoint("R", (90, 0, 0), name="rocker"),
    ),
    "RRRP": (
        DrawnJoint("R", (0, 0, 0), name="crank"),
        DrawnJoint("R", (0, 40, 0), name="crank_pin"),
        DrawnJoint("R", (130, 0, 0), name="piston_pin"),
        DrawnJoint("P", (130, 0, 0), axes=(X, Y), name="slider"),
    ),
    "RSSR": (
        DrawnJoint("R", (0, 0, 0), name="crank"),
        DrawnJoint("S", (0, 40, 0), name="ball_a"),
        DrawnJoint("S", (120, 65, 160), name="ball_b"),
        DrawnJoint("R", (120, 0, 100), axes=(X, Y), name="rocker"),
    ),
    "RSSP": (
        DrawnJoint("R", (0, 0, 0), name="crank"),
        DrawnJoint("S", (0, 40, 0), name="ball_a"),
        DrawnJoint("S", (130, 0, 30), name="ball_b"),
        DrawnJoint("P", (130, 0, 30), axes=(X, Y), name="slider"),
    ),
}


def kinds_of(words: str) -> tuple[str, ...]:
    """The kinds of joints that a person wrote in loop order, as in `R S S R`, `RSSR` or `r, s, s, r`.

    Raises `RequestError` for what are none, or too few, or too many.
    """
    letters = [letter for letter in words.upper() if letter not in " ,;-"]
    wrong = next((letter for letter in letters if letter not in JOINT_KINDS), None)
    if wrong is not None:
        raise RequestError(
            f"joints: {shown(wrong)} is not a kind of joint; give letters of {', '.join(JOINT_KINDS)}"
        )
    if not FEWEST <= len(letters) <= MOST:
        raise RequestError(
            f"joints: a loop has {FEWEST} to {MOST} joints, not {len(letters)}; give as in R R R R"
        )
    return tuple(letters)


def beginning(kinds: Sequence[str], before: Sequence[DrawnJoint] = ()) -> tuple[DrawnJoint, ...]:
    """Joints of these kinds in places to begin with; those of `before` stay where their kinds do.

    A loop without a beginning of its own is laid round an arc in the xy plane. Its axes stand on that plane,
    unless it has the freedoms of a spatial loop, whose axes go in three directions in turn.
    """
    known = BEGINNINGS.get("".join(kinds))
    if known is not None:
        return known
    last = len(kinds) - 1
    spatial = sum(len(KINDS[kind].freedoms) for kind in kinds) > PLANAR_FREEDOMS
    result = []
    for i, kind in enumerate(kinds):
        if i < len(before) and before[i].kind == kind:
            result.append(before[i])
            continue
        angle = math.pi * (1 - i / last)
        at = (round(50 + 50 * math.cos(angle), 1), round(60 * math.sin(angle), 1), 0.0)
        turned = (Z, X, Y)[i % 3] if spatial else X if kind == "P" else Z
        result.append(DrawnJoint(kind, at, (turned, X if turned == Y else Y)))
    return tuple(result)


def drawn(name: str, unit: str, joints: Sequence[DrawnJoint]) -> str:
    """The TOML text of a linkage that is drawn by its joints; raises `DescriptionError`."""
    raw = {"format": 1, "name": _named(name), "length_unit": unit, "joint": [joint.table for joint in joints]}
    return _written(raw)


def of_kind(name: str, kind: str) -> str:
    """The TOML text of a linkage with the dimensions of one of the gallery, under a name of its own."""
    raw = dict(Draft.of(text(kind), kind).raw)
    return _written(raw | {"name": _named(name)})


def _named(name: str) -> str:
    if not name.strip():
        raise RequestError("name: missing; give the linkage a name")
    return name.strip()


def _written(raw: Mapping[str, Any]) -> str:
    content = Draft("", raw, str(raw["name"])).toml()
    Draft.of(content, str(raw["name"]))
    return content
