"""A linkage as a command file for ADAMS/View: parts, markers, joints, the motion, one simulated cycle.

Written by the public documentation of the command language. No ADAMS was at hand to run it.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, shown
from sevenbar.export.adams_file import AdamsColumn, CommandFile, number, word_of
from sevenbar.export.adams_forces import add_forces
from sevenbar.export.mass import MASSLESS, BodyMass, has_masses, masses
from sevenbar.export.parts import Assembly, Ball, Rod, Solid, foot_of, length_of
from sevenbar.kinematics.loop.joints import KINDS, Y
from sevenbar.kinematics.loop.rigid import about, half_turn, inverse, placed
from sevenbar.kinematics.loop.rigid import pose as matrix
from sevenbar.text.progress import Progress, silent

#: The names ADAMS has for length units.
UNITS = {"mm": "mm", "cm": "cm", "m": "meter", "in": "inch", "ft": "foot"}

#: How much of the way to a dead centre of the input is driven: at it, constant speed asks the impossible.
DRIVEN_SHARE = 0.98

#: Axes [rad] nearer than this to a right angle make a Hooke joint.
RIGHT = 1e-9

#: A body, and the frame (4, 4) of a joint on it.
Side = tuple[int, Floats]


def write_cmd(assembly: Assembly, path: Path, _progress: Progress = silent) -> None:
    """Writes the command file in the linkage's own length unit, kilograms, seconds and degrees.

    A part for each moving link, in place in the pose, its frame that of the link; at each joint a marker on
    either part, so that `AZ(I, J)` is the joint's angle as Sevenbar counts it and `DZ(I, J, J)` its slide.
    What acts on the linkage acts in the file too, except loads by tables.
    """
    path.write_text(_LinkageFile(assembly).text(), encoding="utf-8")


class _LinkageFile(CommandFile):
    """The commands of a linkage."""

    def text(self) -> str:
        """All commands."""
        joints = self.linkage.joints
        speed, end, steps = self._drive()
        self._head()
        weights = masses(self.assembly)
        for body in range(len(self.assembly.bodies)):
            if self._has_part(body):
                self._part(body, weights[body])
        for i, word in enumerate(_distinct([word_of(joint.name, "joint") for joint in joints])):
            self._joint(i, word)
        for point in self.linkage.points:
            # from how the file writes a point to its link's own frame; that of the ground is the report frame
            body = point.link - 1
            place = placed(self.linkage.point_frames[body], point.at)
            self.marker(body, f"point_{word_of(point.name, 'p')}", matrix(np.eye(3), place))
        add_forces(self, self._motion(speed))
        self.say(
            "simulation single_run transient",
            type="auto_select",
            initial_static="no",
            end_time=number(end),
            number_of_steps=str(steps),
            model_name=self.model,
        )
        return "\n".join(self.lines) + "\n"

    def _drive(self) -> tuple[float, float, int]:
        """The input's speed, and the time and the steps of one cycle, or of the way to a dead centre."""
        motion, circuit = self.pose.motion, self.pose.circuit
        if motion.law is not None:
            raise RequestError(
                "cmd: a motion driven by a law has no constant speed; give one that is driven at a speed"
            )
        if any(motion.input in joint.columns for joint in self.linkage.joints if joint.row.has_plane):
            raise RequestError(
                f"cmd: ADAMS has no motion for {shown(motion.input)}, a part of a planar joint; "
                "give another input"
            )
        ends = circuit.pass_range(self.pose.branch)
        if ends is None:
            turns = max(1, circuit.turns)
            return motion.speed, turns * math.tau / abs(motion.speed), turns * motion.samples
        low, high = ends
        way = (high - self.pose.input) if motion.speed > 0 else (self.pose.input - low)
        return motion.speed, DRIVEN_SHARE * way / abs(motion.speed), motion.samples

    def _has_part(self, body: int) -> bool:
        """Whether a cross is a part of its own: not where a Hooke joint holds it."""
        if body < self.count:
            return True
        return not self._hooke(self._crosses[body - self.count])

    @property
    def _crosses(self) -> list[int]:
        """The joints with a cross, whose bodies follow the links."""
        return [i for i, joint in enumerate(self.linkage.joints) if joint.row.has_cross]

    def _hooke(self, i: int) -> bool:
        joint = self.linkage.joints[i]
        motion, springs = self.pose.motion, self.linkage.loading.springs
        given = {motion.input, motion.output, *(spring.joint for spring in springs)}
        return abs(joint.angle - math.pi / 2) < RIGHT and not set(joint.columns) & given

    def _head(self) -> None:
        loading = self.linkage.loading
        left_out = loading.left_out(loads=sum(load.table is not None for load in loading.loads))
        own = f"the linkage; parts that have none weigh {MASSLESS:g} of the heaviest"
        origin = own if has_masses(self.linkage) else "the drawn bodies in steel"
        self.lines += [
            f"! {_ascii(self.linkage.name)}",
            "! An ADAMS/View command file written by Sevenbar from the documentation of the language;",
            "! it has not been run in ADAMS. Lengths in " + self.unit + ", masses in kg; masses are those of",
            f"! {origin}. Plain angles in functions are in radians."
            + " No gravity." * (not any(loading.gravity)),
            *([f"! Left out, for it follows a table: {left_out}."] if left_out else []),
            *(f"! Idle freedom: {_ascii(words)}." for words in self.linkage.idle),
            *(f"! Redundant constraint, which the solver takes out itself: {_ascii(words)}."
              for words in self.pose.motion.redundant),
            "!",
        ]  # fmt: skip
        self.say(
            "defaults units", length=UNITS[self.unit], angle="deg", force="newton", mass="kg", time="sec"
        )
        self.say("defaults units", coordinate_system_type="cartesian", orientation_type="body313")
        self.say("model create", model_name=self.model)
        self.say("defaults model", model_name=self.model)
        self.say("defaults coordinate_system", default_coordinate_system=f"{self.model}.ground")

    def _part(self, body: int, mass: BodyMass) -> None:
        name = self.name(body)
        if self.assembly.bodies[body] != "ground":
            location, orientation = self.place(self.assembly.frames[body])
            self.say(
                "part create rigid_body name_and_position",
                part_name=name,
                location=location,
                orientation=orientation,
            )
            # the marker has the principal axes, so that no products of inertia are left
            moments, axes = np.linalg.eigh(mass.inertia)
            axes[:, 2] *= np.linalg.det(axes)
            self.marker(body, "cm", matrix(axes, mass.centre))
            moments = self.scale**2 * moments
            self.say(
                "part modify rigid_body mass_properties",
                part_name=name,
                mass=number(mass.mass),
                center_of_mass_marker=f"{name}.cm",
                ixx=number(moments[0]), iyy=number(moments[1]), izz=number(moments[2]),
                ixy="0.0", izx="0.0", iyz="0.0",
            )  # fmt: skip
        solids = [s for part in self.assembly.parts if part.body == body for s in part.add]
        for k, solid in enumerate(solids, 1):
            self._shape(body, k, solid)

    def _shape(self, body: int, k: int, solid: Solid) -> None:
        """A drawn solid, with a marker from which ADAMS builds it."""
        part, frame = self.name(body), foot_of(solid)
        marker = f"{part}.shape_{k}"
        if isinstance(solid, Ball):
            across = number(2 * self.scale * solid.radius)
            kind, own = "ellipsoid", {"ellipsoid_name": f"{part}.ball_{k}", "center_marker": marker}
            own |= {f"{axis}_scale_factor": across for axis in "xyz"}
        elif isinstance(solid, Rod):
            kind, own = "cylinder", {"cylinder_name": f"{part}.rod_{k}", "center_marker": marker}
            own |= {"angle_extent": "360.0", "length": number(self.scale * length_of(solid))}
            own["radius"] = number(self.scale * solid.radius)
        else:
            kind, own = "block", {"block_name": f"{part}.bar_{k}", "corner_marker": marker}
            size = self.scale * np.array([solid.width, solid.width, length_of(solid)])
            own["diag_corner_coords"] = ", ".join(map(number, size))
        self.marker(body, f"shape_{k}", frame)
        self.say(f"geometry create shape {kind}", **own)

    def _joint(self, i: int, word: str) -> None:
        joint = self.linkage.joints[i]
        before, after = (link - 1 for link in self.linkage.graph.between[i])
        row = joint.row
        j_side = before, inverse(self.pose.frames[before]) @ self.pose.near[i]
        i_side = after, inverse(self.pose.frames[after]) @ self.pose.far[i]
        if row.has_cross:
            self._universal(i, word, j_side, i_side)
            return
        if joint.backwards:
            # the file counts the link against the ground, so I and J change places and the axis turns round
            row, turned = KINDS[joint.kind], half_turn(joint.row.half_turn)
            j_side, i_side = ((body, frame @ turned) for body, frame in (i_side, j_side))
        # the link of the slot is I or J of the file
        slot_on_i = row.has_slot and row.slot_on_after != joint.backwards
        result = self._connect(joint.row.adams, word, j_side, i_side)
        if row.has_slot:
            # a planar joint slides any way in its plane; a slot along y of its link holds the pin across it
            (slotted, frame), (pinned, pin) = (i_side, j_side) if slot_on_i else (j_side, i_side)
            self.say(
                "constraint create primitive_joint inplane",
                jprim_name=f"{self.model}.{word}_slot",
                i_marker_name=self.marker(pinned, f"{word}_pin", pin),
                j_marker_name=self.marker(slotted, f"{word}_across", frame @ about(Y, math.pi / 2, 4)),
            )
        if joint.row.is_screw:
            # a screw joint ties the slide to the turn and nothing else; the cylindrical one holds the axis
            pitch = number(self.scale * joint.pitch)
            self._constrain("screw", f"{word}_thread", *result[1:], pitch=pitch)
        if not joint.row.is_ball:
            along = result[1 if slot_on_i else 2]
            self.columns |= {
                column: AdamsColumn(*result, along, step) for column, step in row.named(joint.name)
            }

    def _universal(self, i: int, word: str, j_side: Side, i_side: Side) -> None:
        joint = self.linkage.joints[i]
        body = self.count + self._crosses.index(i)
        if self._hooke(i):
            # its crosspiece: y of the J marker and x of the I marker
            square, near, far = self.assembly.frames[body, :3, 0], self.pose.near[i], self.pose.far[i]
            first, second = near[:3, 2], far[:3, 2]
            turn_j = np.stack([np.cross(first, square), first, square], axis=1)
            turn_i = np.stack([second, np.cross(square, second), square], axis=1)
            sides = ((j_side[0], matrix(turn_j, near[:3, 3])), (i_side[0], matrix(turn_i, far[:3, 3])))
            self._connect("hooke", word, *((b, inverse(self.pose.frames[b]) @ frame) for b, frame in sides))
            return
        tilt = joint.before(joint.row.steps[-1])
        sides_of_steps = ((j_side, (body, np.eye(4))), ((body, tilt), i_side))
        for k, (column, step, sides) in enumerate(
            zip(joint.columns, joint.row.steps, sides_of_steps, strict=True), 1
        ):
            joined = self._connect("revolute", f"{word}_{k}", *sides)
            self.columns[column] = AdamsColumn(*joined, joined[2], step)

    def _connect(self, kind: str, word: str, j_side: Side, i_side: Side) -> tuple[str, str, str]:
        """A joint between markers on two bodies; returns its name and those of the markers I and J."""
        j = self.marker(j_side[0], f"{word}_j", j_side[1])
        i = self.marker(i_side[0], f"{word}_i", i_side[1])
        return self._constrain(kind, word, i, j), i, j

    def _constrain(self, kind: str, word: str, i: str, j: str, **more: str) -> str:
        name = f"{self.model}.{word}"
        keywords = f"constraint create joint {kind}"
        self.say(keywords, joint_name=name, i_marker_name=i, j_marker_name=j, **more)
        return name

    def _motion(self, speed: float) -> str:
        """Adds the drive and measures of input and output; returns the input as a function of time."""
        motion = self.pose.motion
        driven = self.columns[motion.input]
        unit = 1.0 if driven.turns else self.scale
        drive = f"{number(unit * self.pose.input)} + {number(unit * speed)}*time"
        self.say(
            "constraint create motion_generator",
            motion_name=f"{self.model}.drive",
            type_of_freedom="rotational" if driven.turns else "translational",
            joint_name=driven.joint,
            function=f'"{drive}"',
        )
        for name in (motion.input, motion.output):
            if name not in self.columns:
                continue
            own, word = self.columns[name], word_of(name, "joint")
            position = "angle" if own.turns else "length"
            for order, quantity in enumerate(("position", "velocity", "acceleration")):
                units = "angular_" * own.turns + quantity if order else position
                self.say(
                    "measure create function",
                    measure_name=f"{self.model}.{word}_{quantity}",
                    function=f'"{own.function(order)}"',
                    units=f'"{units}"',
                    create_measure_display="no",
                )
        return drive


def _distinct(words: list[str]) -> list[str]:
    """The words, those that occur before with a number behind."""
    result: list[str] = []
    for word in words:
        lowered = [w.lower() for w in result]
        tail = ""
        while (word + tail).lower() in lowered:
            tail = f"_{int(tail[1:] or 1) + 1}"
        result.append(word + tail)
    return result


def _ascii(text: str) -> str:
    return text.encode("ascii", "replace").decode()
