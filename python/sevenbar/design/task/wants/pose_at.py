"""The want of a pose at an input: a link takes it to within a box, and turned by no more than an angle.

With d the place of the frame's origin less that of the pose, in the axes of the pose, D_k what the frame's
three axes are off, h the half sides of the box and a the angle, a design must keep

    |d_i| <= h_i,        sum |D_k|^2 <= 8 sin^2(a / 2)                                                  (1)

since a turn by b moves the ends of the three axes by distances whose squares have the sum 8 sin^2(b / 2).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from sevenbar.arrays import Floats, short_way
from sevenbar.description.values import Angle, key, refuse, three
from sevenbar.design.task.flaws import Flaws, link_flaws
from sevenbar.design.task.given import reading
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.task import DesignTask, SampledWant, WantForm
from sevenbar.design.task.values import OF_INPUT, Link, Value, Weight
from sevenbar.design.task.wanted import Bound, Used, WantFact
from sevenbar.design.task.wants.places import PlacesWanted, frame_ends, frame_places
from sevenbar.design.task.wants.pose_form import PoseForm
from sevenbar.design.task.words import ends_in_words
from sevenbar.errors import shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.rigid import flaw_of_rotation
from sevenbar.kinematics.loop.stops import Three

#: Two inputs that differ by less are one [rad, or of the linkage's size].
SAME_INPUT = 1e-9


def _sides(value: object, info: ValidationInfo) -> Three:
    """Half the sides of a box: three lengths, or one for all."""
    result = three(value if isinstance(value, (list, tuple)) else [value] * 3, info, "length")
    if not min(result) > 0:
        raise refuse(
            f"{shown(value)} is no box; give how far the place may be off, > 0, as in 2 or [2, 2, 1]"
        )
    return result


_Sides = Annotated[
    Three,
    BeforeValidator(_sides),
    WithJsonSchema({"type": ["number", "string", "array"], "exclusiveMinimum": 0}),
]


class PoseAtForm(WantForm):
    """A pose of a link at an input, to within a box."""

    kind: Annotated[Literal["pose"], key("this want")]
    link: Annotated[Link, key("the link, counted from 1")]
    input: Annotated[Value, key("the input at which the pose is taken", OF_INPUT)]
    pose: Annotated[PoseForm, key("a table of at, axis, angle, or at, matrix")]
    within: Annotated[
        _Sides,
        key("how far the place may be off to either side: one length, or three along its axes", "length"),
    ]
    turn: Annotated[
        Angle | None, key("the most that the frame may be turned from the pose; left out, any", "degrees")
    ] = None
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0

    def want(self, linkage: Linkage, folder: Path) -> PoseAtWant:
        at = reading("input", self.input, linkage, linkage.drive.joint)
        return PoseAtWant(self.link, at, self.pose.pose("pose"), self.within, self.turn, self.weight)


@dataclass(frozen=True, eq=False)
class PoseAtWant(SampledWant):
    """A `pose` (4, 4) of a link, counted from 1, at an `input` [rad, or length], to within a box.

    The frame's origin must lie in the box about that of the pose with half sides `within` (3,) along the axes
    of the pose, and the frame be turned by `turn` at most [rad], by any angle where that is `None`; a design
    that is off by more is refused. Residuals, of the frame's origin and where `turn` is given the ends of its
    axes, which a turn by that angle takes as far as the longest half side, are relative to that side.
    """

    form = PoseAtForm
    fault = "box"
    ease = "a larger box"
    in_space = "a pose at an input"

    link: int
    input: float
    pose: Floats
    within: Three
    turn: float | None = None
    weight: float = 1.0

    def residual_unit(self, linkage: Linkage) -> float:
        return max(self.within)

    def flaws(self, task: DesignTask) -> Flaws:
        linkage = task.draft.linkage
        yield from link_flaws(linkage, self.link)
        if not math.isfinite(self.input):
            yield "input", f"{self.input} is no value; give a finite number"
        if not (np.isfinite(self.within).all() and min(self.within) > 0):
            yield "within", f"{self.within} is no box; give three lengths > 0"
        if self.turn is not None and not 0 < self.turn <= math.pi:
            yield "turn", f"{math.degrees(self.turn):g} deg is no such angle; give one > 0, up to 180 deg"
        if self.pose.shape != (4, 4) or not np.isfinite(self.pose).all():
            yield "pose", f"an array of shape {self.pose.shape} is no pose; give a finite one (4, 4)"
        elif flaw := flaw_of_rotation(self.pose[:3, :3]):
            yield "pose", flaw
        else:
            for i, other in enumerate(task.wants):
                if other is self:
                    break
                if isinstance(other, PoseAtWant) and self._contradicts(other, linkage):
                    yield (
                        "pose",
                        f"want {i + 1} wants link {self.link} elsewhere at this input; leave one out",
                    )

    def _contradicts(self, other: PoseAtWant, linkage: Linkage) -> bool:
        """Whether another pose of the same link at the same input is further away than both boxes reach."""
        turns = linkage.turns(linkage.drive.joint)
        gap = self.input - other.input
        same = abs(float(short_way(gap))) < SAME_INPUT if turns else abs(gap) < SAME_INPUT * linkage.size
        reach = math.hypot(*self.within) + math.hypot(*other.within)
        apart = float(np.linalg.norm(self.pose[:3, 3] - other.pose[:3, 3]))
        return self.link == other.link and same and apart > reach

    def words(self, linkage: Linkage) -> str:
        at, box = (", ".join(f"{x + 0.0:.6g}" for x in part) for part in (self.pose[:3, 3], self.within))
        turn = "" if self.turn is None else f" and {math.degrees(self.turn):g} deg"
        where = ends_in_words([self.input], linkage, linkage.drive.joint)
        return f"link {self.link} at the input {where}: ({at}) to within {box} {linkage.length_unit}{turn}"

    def input_range(self) -> tuple[float, float]:
        return self.input, self.input

    def readings_of(self, column: str, linkage: Linkage) -> Floats | None:
        return np.array([self.input]) if column == linkage.drive.joint else None

    def in_loop(self, loop: TaskLoop) -> _PoseAtResiduals:
        return _PoseAtResiduals(loop, self)


class _PoseAtResiduals(PlacesWanted):
    def __init__(self, loop: TaskLoop, want: PoseAtWant) -> None:
        self._want, self._length = want, loop.linkage.length_unit
        unit, turn = max(want.within), want.turn
        # the end of an axis of this length moves by the unit when the frame turns by the angle
        self._arm = unit if turn is None else unit / (2 * math.sin(turn / 2))
        count = 1 if turn is None else 4
        seen = [(want.link, end) for end in frame_ends(self._arm)[:count]]
        places = frame_places(want.pose[None], self._arm)[:, :count]
        super().__init__(loop, want, seen, places, np.array([want.input]))

    def _axes_off(self, places: Floats) -> Floats:
        """What the frame's axes (3, 3) are off, from the places of its origin and the ends of its axes."""
        return np.asarray((places[1:] - places[0] - (self.places[0, 1:] - self.places[0, 0])) / self._arm)

    def bound(self, here: Here) -> Bound:
        places, by = here.points[0, self.numbers], here.points_by[0, self.numbers]
        half = np.array(self._want.within)
        axes = self._want.pose[:3, :3]
        off, off_by = axes.T @ (places[0] - self.places[0, 0]), axes.T @ by[0]
        slack = np.concatenate([half - off, half + off]) / self.unit
        slack_by = np.concatenate([-off_by, off_by]) / self.unit
        missed, asked = (f"{_in_words(part)} {self._length}" for part in (off, half))
        if self._want.turn is not None:
            # (1)
            axes_off = self._axes_off(places)
            axes_by = (by[1:] - by[0]) / self._arm
            most = 8 * math.sin(self._want.turn / 2) ** 2
            slack = np.append(slack, 1 - float((axes_off**2).sum()) / most)
            slack_by = np.concatenate([slack_by, -2 * np.einsum("ki,kij->j", axes_off, axes_by)[None] / most])
            missed = f"{missed} and {math.degrees(_turned(axes_off)):.4g} deg"
            asked = f"{asked} and {math.degrees(self._want.turn):g} deg"
        return Bound(slack, slack_by, f"the pose is off by {missed} along its axes, at most {asked} is asked")

    def facts(self, used: Used) -> Sequence[WantFact]:
        places = used.points(self.numbers, used.station_poses)[0]
        off = float(np.linalg.norm(places[0] - self.places[0, 0]))
        result = [WantFact("off", self._length, off, tabled=True)]
        if self._want.turn is not None:
            angle = math.degrees(_turned(self._axes_off(places)))
            result.append(WantFact("turned", "deg", angle, tabled=True))
        return result


def _turned(axes_off: Floats) -> float:
    """The angle [rad] by which a frame is turned, from what the ends of its axes (3, 3) are off."""
    return 2 * math.asin(min(math.sqrt(float((axes_off**2).sum()) / 8), 1.0))


def _in_words(values: Floats) -> str:
    return ", ".join(f"{x + 0.0:.4g}" for x in values)
