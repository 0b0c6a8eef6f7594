"""The want of poses: a link takes poses in order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import StrictBool

from sevenbar.arrays import Floats
from sevenbar.description.values import Length, Text, key
from sevenbar.design.curve_table import read_poses
from sevenbar.design.task.flaws import Flaws, link_flaws, not_positive, order_flaws
from sevenbar.design.task.given import one_of, read_file, timing
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.task import DesignTask, WantForm, linkage_size
from sevenbar.design.task.values import OF_INPUT, Link, Timing, Weight
from sevenbar.design.task.wants.places import PlacesWanted, TimedWant, frame_ends, frame_places
from sevenbar.design.task.wants.pose_form import PoseForm
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.rigid import flaw_of_rotation, inverse


class PosesForm(WantForm):
    """Poses of a link, in order."""

    kind: Annotated[Literal["poses"], key("this want")]
    link: Annotated[Link, key("the link, counted from 1")]
    arm: Annotated[
        Length | None,
        key("the length at which a radian counts as much as it; left out, the linkage's size", "length"),
    ] = None
    frame: Annotated[
        PoseForm | None,
        key(
            "a frame on the link, as its points are written, whose poses are given; left out, the link's own"
        ),
    ] = None
    poses: Annotated[tuple[PoseForm, ...] | None, key("tables of at, axis, angle, or at, matrix")] = None
    table: Annotated[
        Text | None,
        key("a CSV file or workbook: x, y, z [length]; turn_x, turn_y, turn_z: axis times angle [deg, rad]"),
    ] = None
    timing: Annotated[
        Timing | None,
        key("inputs at which the poses are taken; true: those of the table; left out, any", OF_INPUT),
    ] = None
    phase: Annotated[StrictBool, key("whether the inputs count from a free start")] = False
    exact: Annotated[StrictBool, key("whether all poses must be met exactly")] = False
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0

    def want(self, linkage: Linkage, folder: Path) -> PoseWant:
        one_of(self, "poses", "table")
        inputs: Floats | None = None
        if self.table is not None:
            poses, inputs = read_file(lambda path: read_poses(path, linkage), folder, self.table)
        else:
            poses = np.array([one.pose(f"poses[{i + 1}]") for i, one in enumerate(self.poses or ())])
        if self.frame is not None:
            poses = poses @ inverse(self.frame.pose("frame"))
        arm = linkage_size(linkage) if self.arm is None else self.arm
        return PoseWant(self.link, poses, arm, timing(self.timing, inputs, linkage), self.phase, self.weight)


@dataclass(frozen=True, eq=False)
class PoseWant(TimedWant):
    """Poses (n, 4, 4) of a link, counted from 1, in order: rotation and shift from its frame to the report's.

    The link's frame is that in which its points are written (`[[point]] at`): of a drawn linkage the report's
    own in the drawn pose. `timing` and `phase` as of a path. Residuals: where the frame's origin and the ends
    of its three axes, each `arm` long, are off; relative to `arm`, so that an angle counts by the radian.
    """

    form = PosesForm

    link: int
    poses: Floats
    arm: float
    timing: Floats | None = None
    phase: bool = False
    weight: float = 1.0

    def residual_unit(self, linkage: Linkage) -> float:
        return self.arm

    def flaws(self, task: DesignTask) -> Flaws:
        linkage, poses = task.draft.linkage, self.poses
        yield from link_flaws(linkage, self.link)
        if self.link not in linkage.graph.moving:
            return
        yield from not_positive("arm", self.arm, "length")
        if not poses.size:
            yield (
                "poses",
                "none given; give tables of at, axis and angle, as in { at = [0, 0, 0], angle = 30 }",
            )
            return
        if poses.ndim != 3 or poses.shape[1:] != (4, 4) or not len(poses) or not np.isfinite(poses).all():
            yield "poses", f"an array of shape {poses.shape} holds no poses; give finite ones (n, 4, 4)"
            return
        for i, pose in enumerate(poses):
            if flaw := flaw_of_rotation(pose[:3, :3]):
                yield f"poses[{i + 1}]", flaw
        if self.timing is not None:
            if self.timing.size != len(poses):
                yield "timing", f"{self.timing.size} inputs for {len(poses)} poses; give one for each"
            else:
                yield from order_flaws(self.timing, "timing", "input of pose")
        yield from self.phase_flaws()
        count = len(poses) * (2 if self.timing is None else 3)
        yield from self.exact_flaws(task, count, task.placings + self.phase)

    def words(self, linkage: Linkage) -> str:
        return (
            f"link {self.link} in {len(self.poses)} poses, arm {self.arm:.4g} {linkage.length_unit}"
            f"{self.timed}"
        )

    def in_loop(self, loop: TaskLoop) -> PlacesWanted:
        seen = [(self.link, end) for end in frame_ends(self.arm)]
        places = frame_places(self.poses, self.arm)
        return PlacesWanted(loop, self, seen, places, self.timing, phase=self.phase)
