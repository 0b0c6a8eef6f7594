"""Gravity, loads and springs of a linkage as commands of ADAMS/View."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.export.adams_file import CommandFile, number
from sevenbar.forces.acting import Load, Spring, Three
from sevenbar.kinematics.loop.rigid import placed, pose


def add_forces(file: CommandFile, drive: str) -> None:
    """Adds what acts and a file can hold; `drive` is the input as a function of time."""
    loading = file.linkage.loading
    if any(loading.gravity):
        parts = zip("xyz", loading.gravity, strict=True)
        file.say(
            "force create body gravitational",
            gravity_field_name=f"{file.model}.gravity",
            **{f"{axis}_component_gravity": number(g / file.metre) for axis, g in parts},
        )
    for place, load in enumerate(loading.loads, 1):
        if load.table is None:
            _add_load(file, f"load_{place}", load, drive)
    for place, spring in enumerate(loading.springs, 1):
        add = _add_joint_spring if spring.links is None else _add_spring
        add(file, f"spring_{place}", spring)


def _marker(file: CommandFile, link: int, word: str, at: Three | None) -> str:
    """A marker on a link at a point, with the axes along which its points are written."""
    frame = file.linkage.point_frames[link - 1]
    return file.marker(link - 1, word, pose(frame[:3, :3], placed(frame, np.array(at))))


def _add_load(file: CommandFile, name: str, load: Load, drive: str) -> None:
    marker = _marker(file, load.link, name, load.at)
    axes = marker if load.axes == "link" else file.marker(file.count - 1, f"{name}_axes", np.eye(4))
    share = _share(file, load, drive)
    values: list[float] = [*load.force, *(np.array(load.torque) / file.metre)]
    functions = [f"{share}{number(x)}" for x in values]
    _add_general_force(file, name, marker, f"{file.model}.ground", axes, functions)


def _share(file: CommandFile, load: Load, drive: str) -> str:
    """How much of a load acts, as a factor before it."""
    turns = file.linkage.turns(file.pose.circuit.input_column)
    if load.between is None or load.acts_always(turns=turns):
        return ""
    first, second = load.between
    if not turns:
        low, high = number(file.scale * first), number(file.scale * second)
        return f"IF({drive} - {low}: 0, 1, 1)*IF({drive} - {high}: 1, 1, 0)*"
    width = (second - first) % math.tau
    # what is left of a turn, counted from 0 also where the input is below the first
    rest = f"MOD(MOD({drive} - {number(first)}, 2*PI) + 2*PI, 2*PI)"
    return f"IF({rest} - {number(width)}: 1, 1, 0)*"


def _add_spring(file: CommandFile, name: str, spring: Spring) -> None:
    assert spring.links is not None
    assert spring.at is not None
    ends = zip("ij", spring.links, spring.at, strict=True)
    file.say(
        "force create element_like translational_spring_damper",
        spring_damper_name=f"{file.model}.{name}",
        **{f"{side}_marker_name": _marker(file, link, f"{name}_{side}", at) for side, link, at in ends},
        stiffness=number(spring.stiffness / file.scale),
        damping=number(spring.damping / file.scale),
        preload="0.0",
        displacement_at_preload=number(file.scale * spring.length),
    )


def _add_joint_spring(file: CommandFile, name: str, spring: Spring) -> None:
    assert spring.joint is not None
    own = file.columns[spring.joint]
    unit, length = (1 / file.metre, 1.0) if own.turns else (1 / file.scale, file.scale)
    pull = (
        f"-{number(unit * spring.stiffness)}*({own.function(0)} - {number(length * spring.length)})"
        f" - {number(unit * spring.damping)}*{own.function(1)}"
    )
    functions = ["0.0"] * 6
    functions[own.step.number] = pull
    _add_general_force(file, name, own.i, own.j.rpartition(".")[0], own.j, functions)


def _add_general_force(
    file: CommandFile, name: str, marker: str, part: str, axes: str, functions: list[str]
) -> None:
    """A force and a torque on a marker's part, and against them on another part."""
    keys = [f"{axis}_{what}_function" for what in ("force", "torque") for axis in "xyz"]
    file.say(
        "force create direct general_force",
        general_force_name=f"{file.model}.{name}",
        i_marker_name=marker,
        j_part_name=part,
        ref_marker_name=axes,
        **{key: f'"{function}"' for key, function in zip(keys, functions, strict=True)},
    )
