"""From a checked net to a linkage: joints between links by name, pins, rods."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.links import NamedLinks
from sevenbar.description.written import drive_of, driven, entries, joints_of
from sevenbar.errors import DescriptionError, Problem
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import BallRod, Drive, Joint, Point
from sevenbar.kinematics.loop.joints import ANYWHERE, KINDS, columns_apart
from sevenbar.kinematics.loop.rigid import cross, inverse, pose, unit


def net_of(links: NamedLinks, raw: Mapping[str, Any], source: str) -> Linkage:
    """The net of links by name; raises `DescriptionError` with all that is wrong."""
    from sevenbar.description.formulas import context_of, with_numbers
    from sevenbar.description.net_proportions import net_disproportions
    from sevenbar.description.net_schema import check_net

    thick = [
        Problem(f"rod[{i}].radius", "is of a single loop so far; leave this rod out")
        for i, table in enumerate(entries(raw, "rod"), 1)
        if "between" not in table
    ]
    if thick:
        raise DescriptionError(thick, source)
    # pins are joints from here on
    tables = [{**edge.table, "name": edge.name, "between": list(edge.between)} for edge in links.joints]
    whole = {**raw, "joint": tables}
    context = context_of(whole, source)
    raw = with_numbers(raw, context)
    check_net(raw, context, source=source)
    first, last, problems = driven(joints_of(whole), drive_of(whole), _places(links), "a net")
    if problems:
        raise DescriptionError(problems, source)
    form = check_net({**with_numbers(whole, context), "pin": []}, context, source=source)
    if problems := net_disproportions(form, [edge.place for edge in links.edges]):
        raise DescriptionError(problems, source)
    number = {name: i for i, name in enumerate(links.links, 1)}
    points = tuple(Point(point.name, number[point.link], point.at) for point in form.point)
    joints, frames = [], []
    for edge, table in zip(links.joints, form.joint, strict=True):
        before, after, angle = drawn_frames(table.kind, table.at, table.axis, table.axes)
        joint = Joint(table.kind, edge.name, table.pitch or 0.0, angle, value=table.value or 0.0)
        joints.append(joint)
        frames.append(np.stack([before @ inverse(joint.to_drawn), after]))
    rods = tuple(
        BallRod(edge.name, (number[edge.between[0]], number[edge.between[1]]), table.at)
        for edge, table in zip(links.rods, form.rod, strict=True)
    )
    return Linkage(
        name=form.name,
        joints=tuple(joints),
        frames=np.stack(frames),
        point_frames=np.broadcast_to(np.eye(4), (len(number), 4, 4)).copy(),
        drive=Drive(first, last, form.drive.speed),
        length_unit=form.length_unit,
        points=points,
        description=raw,
        net=links.graph,
        link_names=tuple(links.links),
        rods=rods,
    )


def _places(links: NamedLinks) -> list[str]:
    """The columns that say where links are that rods alone hold."""
    joints = {joint.name for joint in links.joints}
    names = (name for number, name in enumerate(links.links, 1) if number in links.graph.apart)
    columns = (zip(columns_apart(name, joints), ANYWHERE.freedoms, strict=True) for name in names)
    return [column for each in columns for column, freedom in each if freedom == "slide"]


def drawn_frames(
    kind: str,
    at: tuple[float, float, float],
    axis: tuple[float, float, float] | None,
    axes: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
) -> tuple[Floats, Floats, float]:
    """The frames (4, 4) of a joint on both links, in ground coordinates, and the angle [rad] of its axes.

    x is the ground axis most nearly across z, so those of a ball are the ground's.
    """
    row = KINDS[kind]
    if axes is not None:
        first, second = unit(axes[0]), unit(axes[1])
        if row.has_cross:
            x = unit(cross(first, second))
            angle = float(np.arctan2(np.linalg.norm(cross(first, second)), first @ second))
            return _frame(x, first, at), _frame(x, second, at), angle
        # the pin is z, and its slot y
        pin, slot = (first, second) if row.slot_on_after else (second, first)
        slot = unit(slot - (slot @ pin) * pin)
        frame = _frame(cross(slot, pin), pin, at)
        return frame, frame, 0.0
    z = unit(axis) if axis is not None else np.array([0.0, 0.0, 1.0])
    aside = np.eye(3)[np.argmin(np.abs(z))]
    frame = _frame(unit(aside - (aside @ z) * z), z, at)
    return frame, frame, 0.0


def _frame(x: Floats, z: Floats, at: tuple[float, float, float]) -> Floats:
    """The frame with these axes x and z at a place."""
    return pose(np.stack([x, cross(z, x), z], axis=-1), at)
