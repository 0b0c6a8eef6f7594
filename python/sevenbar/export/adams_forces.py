"""Gravity, loads and springs of a linkage as commands of ADAMS/View."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.left_out import left_out
from sevenbar.export.pose import Pose
from sevenbar.forces.acting import Load, Spring
from sevenbar.kinematics.loop.joints import Step
from sevenbar.text.units import LENGTHS


class Say(Protocol):
    """Writes a command with its parameters."""

    def __call__(self, keywords: str, **parameters: str) -> None:
        """Keywords, and parameters by their names."""


class AdamsForces:
    """What acts on a linkage, for a file with lengths of `metre` metres.

    `marker` puts a marker on a link; `columns` has each column's joint, its markers I and J, and its step.
    """

    def __init__(
        self,
        linkage_pose: Pose,
        model: str,
        say: Say,
        marker: Callable[[int, str, Floats], str],
        columns: Mapping[str, tuple[str, str, str, Step]],
    ) -> None:
        self._linkage, self._model, self._say, self._marker = linkage_pose.linkage, model, say, marker
        self._columns, self._turns = columns, _turns(linkage_pose)
        self._scale = file_scale(self._linkage.length_unit)
        self._metre = LENGTHS[self._linkage.length_unit] / self._scale

    def add(self, drive: str) -> None:
        """Adds what a file can hold; `drive` is the input as a function of time."""
        loading = self._linkage.loading
        if any(loading.gravity):
            parts = {f"{axis}_component_gravity": g for axis, g in zip("xyz", loading.gravity, strict=True)}
            self._say(
                "force create body gravitational",
                gravity_field_name=f"{self._model}.gravity",
                **{key: number(g / self._metre) for key, g in parts.items()},
            )
        for place, load in enumerate(loading.loads, 1):
            if load.table is None:
                self._add_load(place, load, drive)
        for place, spring in enumerate(loading.springs, 1):
            if spring.links is not None:
                self._add_spring(place, spring)
            else:
                self._add_joint_spring(place, spring)

    def left_out(self) -> list[str]:
        """What is not in the file, in words: loads by tables."""
        loads = self._linkage.loading.loads
        words = left_out(self._linkage.loading, loads=sum(load.table is not None for load in loads))
        return [words] if words else []

    def _place(self, link: int, at: Floats) -> Floats:
        """A frame on a link at a point, with the axes along which its points are written."""
        frame: Floats = self._linkage.point_frames[link - 1].copy()
        frame[:3, 3] += frame[:3, :3] @ at
        return frame

    def _add_load(self, place: int, load: Load, drive: str) -> None:
        own = self._place(load.link, np.array(load.at))
        marker = self._marker(load.link - 1, f"load_{place}", own)
        turns = load.axes == "link"
        ground = len(self._linkage.joints) - 1
        axes = marker if turns else self._marker(ground, f"load_{place}_axes", np.eye(4))
        share = self._share(load, drive)
        values = [*load.force, *(np.array(load.torque) / self._metre)]
        self._general(f"load_{place}", marker, ground, axes, [f"{share}{number(x)}" for x in values])

    def _share(self, load: Load, drive: str) -> str:
        """How much of a load acts, as a factor before it."""
        if load.between is None:
            return ""
        first, second = load.between
        if not self._turns:
            low, high = number(self._scale * first), number(self._scale * second)
            return f"IF({drive} - {low}: 0, 1, 1)*IF({drive} - {high}: 1, 1, 0)*"
        width = (second - first) % math.tau
        # what is left of a turn, counted from 0 also where the input is below the first
        rest = f"MOD(MOD({drive} - {number(first)}, 2*PI) + 2*PI, 2*PI)"
        return f"IF({rest} - {number(width)}: 1, 1, 0)*"

    def _add_spring(self, place: int, spring: Spring) -> None:
        assert spring.links is not None
        assert spring.at is not None
        ends = [
            self._marker(link - 1, f"spring_{place}_{side}", self._place(link, np.array(at)))
            for side, link, at in zip("ij", spring.links, spring.at, strict=True)
        ]
        self._say(
            "force create element_like translational_spring_damper",
            spring_damper_name=f"{self._model}.spring_{place}",
            i_marker_name=ends[0],
            j_marker_name=ends[1],
            stiffness=number(spring.stiffness / self._scale),
            damping=number(spring.damping / self._scale),
            preload="0.0",
            displacement_at_preload=number(self._scale * spring.length),
        )

    def _add_joint_spring(self, place: int, spring: Spring) -> None:
        assert spring.joint is not None
        _, i, j, step = self._columns[spring.joint]
        turns, axis = step.freedom == "turn", step.axis
        unit, length = (1 / self._metre, 1.0) if turns else (1 / self._scale, self._scale)
        value = f"AZ({i}, {j})" if turns else f"D{'XYZ'[axis]}({i}, {j}, {j})"
        rate = f"{'W' if turns else 'V'}{'XYZ'[axis]}({i}, {j}, {j})"
        pull = (
            f"-{number(unit * spring.stiffness)}*({value} - {number(length * spring.length)})"
            f" - {number(unit * spring.damping)}*{rate}"
        )
        functions = ["0.0"] * 6
        functions[axis + 3 * turns] = pull
        self._general(f"spring_{place}", i, j, j, functions)

    def _general(self, name: str, marker: str, against: int | str, axes: str, functions: list[str]) -> None:
        """A force and a torque on a marker's part, and against them on another part."""
        part = against.rpartition(".")[0] if isinstance(against, str) else f"{self._model}.ground"
        keys = [f"{axis}_{what}_function" for what in ("force", "torque") for axis in "xyz"]
        self._say(
            "force create direct general_force",
            general_force_name=f"{self._model}.{name}",
            i_marker_name=marker,
            j_part_name=part,
            ref_marker_name=axes,
            **{key: f'"{function}"' for key, function in zip(keys, functions, strict=True)},
        )


def _turns(linkage_pose: Pose) -> bool:
    linkage = linkage_pose.linkage
    return linkage.turns(linkage_pose.circuit.input_column)


def file_scale(unit: str) -> float:
    """A linkage's length unit in that of its file: ADAMS has no micrometres, so they are in millimetres."""
    return LENGTHS[unit] / LENGTHS["mm"] if unit == "um" else 1.0


def number(value: float) -> str:
    """A number to its last digit, with the point that makes it a real one."""
    return repr(float(value) + 0.0).replace("e", "E")
