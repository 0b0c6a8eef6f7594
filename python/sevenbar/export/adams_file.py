"""A command file for ADAMS/View as it grows: its commands, its names and numbers, markers on bodies."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from sevenbar.arrays import Floats
from sevenbar.export.parts import Assembly
from sevenbar.kinematics.loop.joints import Step
from sevenbar.kinematics.loop.rigid import about
from sevenbar.text.units import LENGTHS


@dataclass(frozen=True)
class AdamsColumn:
    """A column of a joint in the file: the joint, its markers I and J, that of its axis, and its step."""

    joint: str
    i: str
    j: str
    along: str
    step: Step

    @property
    def turns(self) -> bool:
        """Whether it is an angle."""
        return self.step.freedom == "turn"

    def function(self, order: int) -> str:
        """The function that gives it, or its derivative of an order up to 2, as Sevenbar counts it."""
        axis = "XYZ"[self.step.axis]
        if self.turns and order == 0:
            return f"AZ({self.i}, {self.j})"
        word = (("", "W", "WDT") if self.turns else ("D", "V", "ACC"))[order]
        # the rate of a slide is seen from its axis
        seen = [self.along] * (not self.turns and order > 0)
        return f"{word}{axis}({', '.join([self.i, self.j, self.along, *seen])})"


class CommandFile:
    """The commands for an assembly as they are collected, in the length unit `unit` of `metre` metres."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly, self.pose, self.linkage = assembly, assembly.pose, assembly.pose.linkage
        #: How many links, the bodies before the crosses of universal joints.
        self.count = self.linkage.graph.ground
        own = self.linkage.length_unit
        # ADAMS has no micrometres
        self.unit = "mm" if own == "um" else own
        self.metre = LENGTHS[self.unit]
        #: The linkage's length unit in that of the file.
        self.scale = LENGTHS[own] / self.metre
        self.model = "." + word_of(self.linkage.name, "linkage")
        self.lines: list[str] = []
        #: What each column is in the file; none for turns of Hooke joints and balls.
        self.columns: dict[str, AdamsColumn] = {}

    def say(self, keywords: str, **parameters: str) -> None:
        """Writes a command: keywords, and parameters by their names."""
        words = [f"{key} = {value}" for key, value in parameters.items()]
        self.lines += [" &\n   ".join([keywords, *words]), "!"]

    def name(self, body: int) -> str:
        """The name of a body's part."""
        return f"{self.model}.{word_of(self.assembly.bodies[body], 'link')}"

    def marker(self, body: int, word: str, frame: Floats) -> str:
        """A marker on a body, by its frame (4, 4) on it."""
        name, own = f"{self.name(body)}.{word}", self.name(body)
        location, orientation = self.place(frame)
        self.say(
            "marker create", marker_name=name, location=location, orientation=orientation, relative_to=own
        )
        return name

    def place(self, frame: Floats) -> tuple[str, str]:
        """A frame as location and orientation: turns about z, x and z, each carried by the one before."""
        turn = frame[:3, :3]
        first = math.atan2(turn[0, 2], -turn[1, 2]) if math.hypot(turn[0, 2], turn[1, 2]) > 1e-12 else 0.0
        # what is left after the first, so that the three belong together where it is not defined
        turn = about(2, -first) @ turn
        second = math.atan2(-turn[1, 2], turn[2, 2])
        third = math.atan2(-turn[0, 1], turn[0, 0])
        location = ", ".join(map(number, self.scale * frame[:3, 3]))
        return location, ", ".join(f"{number(math.degrees(a))}d" for a in (first, second, third))


def number(value: float) -> str:
    """A number to its last digit, with the point that makes it a real one."""
    return repr(float(value) + 0.0).replace("e", "E")


def word_of(name: str, otherwise: str) -> str:
    """A name of letters, digits and underscores that begins with a letter."""
    word = re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_")
    return word if re.match(r"[A-Za-z]", word) else f"{otherwise}_{word}".rstrip("_")
