"""A linkage as a command file for ADAMS/View: parts, markers, joints, the motion, one simulated cycle.

Written by the public documentation of the command language. No ADAMS was at hand to run it.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, shown
from sevenbar.export.adams_forces import AdamsForces, file_scale, number
from sevenbar.export.mass import MASSLESS, BodyMass, has_masses, masses
from sevenbar.export.parts import Assembly, Ball, Rod, Solid, frame_of, length_of
from sevenbar.export.pose import Pose
from sevenbar.kinematics.loop.joints import KINDS, Step
from sevenbar.kinematics.loop.rigid import about, half_turn, inverse, placed
from sevenbar.kinematics.loop.rigid import pose as matrix

#: The names ADAMS has for length units; micrometres are written in millimetres.
UNITS = {"mm": "mm", "cm": "cm", "m": "meter", "in": "inch", "ft": "foot", "um": "mm"}

#: How much of the way to a dead centre of the input is driven: at it, constant speed asks the impossible.
DRIVEN_SHARE = 0.98

#: Axes [rad] nearer than this to a right angle make a Hooke joint.
RIGHT = 1e-9


def write_cmd(assembly: Assembly, path: Path) -> None:
    """Writes the command file in the linkage's own length unit, kilograms, seconds and degrees.

    A part for each moving link, in place in the pose, its frame that of the link; at each joint a marker on
    either part, so that `AZ(I, J)` is the joint's angle as Sevenbar counts it and `DZ(I, J, J)` its slide.
    What acts on the linkage acts in the file too, except loads by tables.
    """
    path.write_text(_AdamsCommands(assembly).text(), encoding="utf-8")


class _AdamsCommands:
    """The commands as they are collected."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self.pose: Pose = assembly.pose
        self.linkage = self.pose.linkage
        unit = self.linkage.length_unit
        self.scale = file_scale(unit)
        self.model = "." + _word(self.linkage.name, "linkage")
        self.lines: list[str] = []
        self.joints = _distinct([_word(joint.name, "joint") for joint in self.linkage.joints])
        #: Each column's joint, its markers, and its step; none for turns of Hooke joints and balls.
        self.columns: dict[str, tuple[str, str, str, Step]] = {}
        self.forces = AdamsForces(self.pose, self.model, self.say, self.marker, self.columns)
        #: The input as a function of time.
        self.input = ""

    def text(self) -> str:
        drive = self._drive()
        self._head()
        weights = masses(self.assembly)
        for body, name in enumerate(self.assembly.bodies):
            if name == "ground" or self._has_part(body):
                self._part(body, weights[body])
        for i in range(len(self.linkage.joints)):
            self._joint(i)
        for point in self.linkage.points:
            # from how the file writes a point to its link's own frame; that of the ground is the report frame
            body = point.link - 1
            place = placed(self.linkage.point_frames[body], point.at)
            self.marker(body, f"point_{_word(point.name, 'p')}", matrix(np.eye(3), place))
        self._motion(drive)
        self.forces.add(self.input)
        self._simulate(drive)
        return "\n".join(self.lines) + "\n"

    def _drive(self) -> tuple[float, float, int]:
        """The input's speed, and the time and the steps of one cycle."""
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
        count = len(self.linkage.joints)
        if body < count:
            return True
        crosses = [i for i, joint in enumerate(self.linkage.joints) if joint.row.has_cross]
        return not self._hooke(crosses[body - count])

    def _hooke(self, i: int) -> bool:
        joint = self.linkage.joints[i]
        motion, springs = self.pose.motion, self.linkage.loading.springs
        given = {motion.input, motion.output, *(spring.joint for spring in springs)}
        return abs(joint.angle - math.pi / 2) < RIGHT and not set(joint.columns) & given

    def say(self, keywords: str, **parameters: str) -> None:
        words = [f"{key} = {value}" for key, value in parameters.items()]
        self.lines += [" &\n   ".join([keywords, *words]), "!"]

    def _head(self) -> None:
        unit = self.linkage.length_unit
        written = "mm" if unit == "um" else unit
        own = f"the linkage; parts that have none weigh {MASSLESS:g} of the heaviest"
        whose = own if has_masses(self.linkage) else "the drawn bodies in steel"
        self.lines += [
            f"! {_ascii(self.linkage.name)}",
            "! An ADAMS/View command file written by Sevenbar from the documentation of the language;",
            "! it has not been run in ADAMS. Lengths in " + written + ", masses in kg; masses are those of",
            f"! {whose}. Plain angles in functions are in radians."
            + " No gravity." * (not any(self.linkage.loading.gravity)),
            *(f"! Left out, for it follows a table: {words}." for words in self.forces.left_out()),
            *(f"! Idle freedom: {_ascii(words)}." for words in self.linkage.idle),
            *(f"! Redundant constraint, which the solver takes out itself: {_ascii(words)}."
              for words in self.pose.motion.redundant),
            "!",
        ]  # fmt: skip
        self.say("defaults units", length=UNITS[unit], angle="deg", force="newton", mass="kg", time="sec")
        self.say("defaults units", coordinate_system_type="cartesian", orientation_type="body313")
        self.say("model create", model_name=self.model)
        self.say("defaults model", model_name=self.model)
        self.say("defaults coordinate_system", default_coordinate_system=f"{self.model}.ground")

    def _name(self, body: int) -> str:
        return f"{self.model}.{_word(self.assembly.bodies[body], 'link')}"

    def _part(self, body: int, mass: BodyMass) -> None:
        name = self._name(body)
        if self.assembly.bodies[body] != "ground":
            location, orientation = self._place(self.assembly.frames[body])
            self.say(
                "part create rigid_body name_and_position",
                part_name=name,
                location=location,
                orientation=orientation,
            )
            # about its main axes, so that no products of inertia are left
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
        name = self._name(body)
        marker = f"shape_{k}"
        if isinstance(solid, Ball):
            self.marker(body, marker, matrix(np.eye(3), solid.centre))
            across = number(2 * self.scale * solid.radius)
            self.say(
                "geometry create shape ellipsoid",
                ellipsoid_name=f"{name}.ball_{k}",
                center_marker=f"{name}.{marker}",
                x_scale_factor=across, y_scale_factor=across, z_scale_factor=across,
            )  # fmt: skip
            return
        frame = frame_of(solid).copy()
        frame[:3, 3] = solid.start
        length = self.scale * length_of(solid)
        if isinstance(solid, Rod):
            self.marker(body, marker, frame)
            self.say(
                "geometry create shape cylinder",
                cylinder_name=f"{name}.rod_{k}",
                center_marker=f"{name}.{marker}",
                angle_extent="360.0",
                length=number(length),
                radius=number(self.scale * solid.radius),
            )
            return
        frame[:3, 3] -= solid.width / 2 * (frame[:3, 0] + frame[:3, 1])
        self.marker(body, marker, frame)
        width = self.scale * solid.width
        self.say(
            "geometry create shape block",
            block_name=f"{name}.bar_{k}",
            corner_marker=f"{name}.{marker}",
            diag_corner_coords=", ".join(map(number, (width, width, length))),
        )

    def marker(self, body: int, word: str, frame: Floats) -> str:
        """A marker on a body, by its frame (4, 4) on it."""
        name = f"{self._name(body)}.{word}"
        location, orientation = self._place(frame)
        self.say(
            "marker create",
            marker_name=name,
            location=location,
            orientation=orientation,
            relative_to=self._name(body),
        )
        return name

    def _joint(self, i: int) -> None:
        joint, word = self.linkage.joints[i], self.joints[i]
        count = len(self.linkage.joints)
        before, after = (i - 1) % count, i
        on_before = inverse(self.pose.frames[before]) @ self.pose.near[i]
        on_after = inverse(self.pose.frames[after]) @ self.pose.far[i]
        if joint.row.has_cross:
            self._universal(i, on_before, on_after)
            return
        row, j_side, i_side = joint.row, (before, on_before), (after, on_after)
        if joint.backwards:
            # as written: the link, from the ground, about the axis as drawn
            row, turned = KINDS[joint.kind], half_turn(joint.row.half_turn)
            j_side, i_side = (after, on_after @ turned), (before, on_before @ turned)
        j_marker = self.marker(j_side[0], f"{word}_j", j_side[1])
        i_marker = self.marker(i_side[0], f"{word}_i", i_side[1])
        name = self._connect(joint.row.adams, word, i_marker, j_marker)
        if joint.row.is_screw:
            # a screw joint ties the slide to the turn and nothing else; the cylindrical one holds the axis
            self._connect("screw", f"{word}_thread", i_marker, j_marker, self.scale * joint.pitch)
        if not joint.row.is_ball:
            for column, step in row.named(joint.name):
                self.columns[column] = (name, i_marker, j_marker, step)

    def _universal(self, i: int, on_before: Floats, on_after: Floats) -> None:
        joint, word = self.linkage.joints[i], self.joints[i]
        count = len(self.linkage.joints)
        before = (i - 1) % count
        body = count + sum(other.row.has_cross for other in self.linkage.joints[:i])
        cross = self.assembly.frames[body]
        if self._hooke(i):
            # its crosspiece: y of the J marker and x of the I marker
            square, first, second = cross[:3, 0], self.pose.near[i, :3, 2], self.pose.far[i, :3, 2]
            turn_j = np.stack([np.cross(first, square), first, square], axis=1)
            turn_i = np.stack([second, np.cross(square, second), square], axis=1)
            frame_j = inverse(self.pose.frames[before]) @ matrix(turn_j, self.pose.near[i, :3, 3])
            frame_i = inverse(self.pose.frames[i]) @ matrix(turn_i, self.pose.far[i, :3, 3])
            j_marker = self.marker(before, f"{word}_j", frame_j)
            i_marker = self.marker(i, f"{word}_i", frame_i)
            self._connect("hooke", word, i_marker, j_marker)
            return
        tilt = joint.before(joint.row.steps[-1])
        for k, (j_body, j_frame, i_body, i_frame) in enumerate(
            ((before, on_before, body, np.eye(4)), (body, tilt, i, on_after)), 1
        ):
            j_marker = self.marker(j_body, f"{word}_{k}_j", j_frame)
            i_marker = self.marker(i_body, f"{word}_{k}_i", i_frame)
            name = self._connect("revolute", f"{word}_{k}", i_marker, j_marker)
            self.columns[joint.columns[k - 1]] = (name, i_marker, j_marker, joint.row.steps[k - 1])

    def _connect(self, kind: str, word: str, i_marker: str, j_marker: str, pitch: float | None = None) -> str:
        name = f"{self.model}.{word}"
        more = {} if pitch is None else {"pitch": number(pitch)}
        self.say(
            f"constraint create joint {kind}",
            joint_name=name,
            i_marker_name=i_marker,
            j_marker_name=j_marker,
            **more,
        )
        return name

    def _motion(self, drive: tuple[float, float, int]) -> None:
        motion = self.pose.motion
        joint, _, _, step = self.columns[motion.input]
        turns = step.freedom == "turn"
        unit = 1.0 if turns else self.scale
        self.input = f"{number(unit * self.pose.input)} + {number(unit * drive[0])}*time"
        self.say(
            "constraint create motion_generator",
            motion_name=f"{self.model}.drive",
            type_of_freedom="rotational" if turns else "translational",
            joint_name=joint,
            function=f'"{self.input}"',
        )
        for column in (motion.input, motion.output):
            if column not in self.columns:
                continue
            _, i, j, step = self.columns[column]
            turns, axis = step.freedom == "turn", "XYZ"[step.axis]
            word = _word(column, "joint")
            for quantity, function, units in (
                (
                    "position",
                    f"AZ({i}, {j})" if turns else f"D{axis}({i}, {j}, {j})",
                    "angle" if turns else "length",
                ),
                (
                    "velocity",
                    f"{'W' if turns else 'V'}{axis}({i}, {j}, {j})",
                    "angular_velocity" if turns else "velocity",
                ),
                (
                    "acceleration",
                    f"{'WDT' if turns else 'ACC'}{axis}({i}, {j}, {j})",
                    "angular_acceleration" if turns else "acceleration",
                ),
            ):
                self.say(
                    "measure create function",
                    measure_name=f"{self.model}.{word}_{quantity}",
                    function=f'"{function}"',
                    units=f'"{units}"',
                    create_measure_display="no",
                )

    def _simulate(self, drive: tuple[float, float, int]) -> None:
        _, end, steps = drive
        self.say(
            "simulation single_run transient",
            type="auto_select",
            initial_static="no",
            end_time=number(end),
            number_of_steps=str(steps),
            model_name=self.model,
        )

    def _place(self, frame: Floats) -> tuple[str, str]:
        """A frame as location and orientation: turns about z, x and z, each carried by the one before."""
        turn = frame[:3, :3]
        first = math.atan2(turn[0, 2], -turn[1, 2]) if math.hypot(turn[0, 2], turn[1, 2]) > 1e-12 else 0.0
        # what is left after the first, so that the three belong together where it is not defined
        turn = about(2, -first) @ turn
        second = math.atan2(-turn[1, 2], turn[2, 2])
        third = math.atan2(-turn[0, 1], turn[0, 0])
        location = ", ".join(map(number, self.scale * frame[:3, 3]))
        return location, ", ".join(f"{number(math.degrees(a))}d" for a in (first, second, third))


def _word(name: str, otherwise: str) -> str:
    """A name of letters, digits and underscores that begins with a letter."""
    word = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_")
    return word if re.match(r"[A-Za-z]", word) else f"{otherwise}_{word}".rstrip("_")


def _distinct(words: list[str]) -> list[str]:
    """The words, those that occur before with a number behind."""
    found: list[str] = []
    for word in words:
        lowered = [w.lower() for w in found]
        tail = ""
        while (word + tail).lower() in lowered:
            tail = f"_{int(tail[1:] or 1) + 1}"
        found.append(word + tail)
    return found


def _ascii(text: str) -> str:
    return text.encode("ascii", "replace").decode()
