"""What keeps a linkage from moving on, as a file has it: the models of [[stop]] and [[rod]]."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo

from sevenbar.description.formulas import stop_kinds
from sevenbar.description.load_schema import Link
from sevenbar.description.values import (
    Angle,
    Component,
    Direction,
    Length,
    TableForm,
    Text,
    carried,
    flaws_of_value,
    key,
    parts_of,
    refuse,
    valid_tables,
)
from sevenbar.description.written import Written, named_column, unknown_link
from sevenbar.errors import Problem, RequestError, shown
from sevenbar.kinematics.loop.stops import Cone, check_range


def _range(value: object, info: ValidationInfo) -> tuple[float, float]:
    """Low and high, angles in radians; `joint` is read before it."""
    ends = parts_of(value, 2, "is not a range; give low and high, as in [-30, 60]")
    kind = stop_kinds({"joint": info.data.get("joint")}, info.context or {})["range"]
    low, high = (carried(end, info, kind) for end in ends)
    try:
        return check_range("range", low, high, turns=kind == "angle")
    except RequestError as error:
        raise refuse(f"{shown(list(ends))}: {str(error).partition(': ')[2]}") from None


class StopForm(TableForm):
    """How far a joint may go; it changes no motion, but says what part of a circuit can be used."""

    # before the range, whose unit depends on it
    joint: Annotated[Text, key("the joint, or one of its columns")]
    range: Annotated[
        Annotated[tuple[Component, Component], BeforeValidator(_range)] | None,
        key("low and high of a joint that is no ball, a turn at most", "angle_unit, or length"),
    ] = None
    cone: Annotated[
        Angle | None,
        key("of S and U: the greatest angle between seat and stud, up to 180 degrees", "angle_unit"),
    ] = None
    seat: Annotated[
        Direction | None,
        key("of S and U: a direction on the link before, as its points are written; left out, the middle"),
    ] = None
    stud: Annotated[
        Direction | None, key("of S and U: a direction on the link after; left out, towards its other joint")
    ] = None


class RodForm(TableForm):
    """How thick a link is, as a rod between its joints."""

    link: Annotated[Link, key("the link, counted from 1; the last is the ground")]
    radius: Annotated[Length, key("links that share no joint keep the sum of theirs apart", "length")]


def stop_contradictions(
    raw: Mapping[str, Any], joints: Sequence[Written], context: Mapping[str, Any]
) -> list[Problem]:
    """What is wrong with stops whose values are each right, or with joints and links that they name."""
    problems: list[Problem] = []
    ranged, coned, thick = set[str](), set[str](), set[int]()
    for place, stop in valid_tables(raw, "stop", StopForm, context):
        problems += _of_stop(place, stop, joints, ranged, coned)
    for place, rod in valid_tables(raw, "rod", RodForm, context):
        problems += unknown_link(f"{place}.link", rod.link, joints)
        if rod.link in thick:
            problems.append(Problem(f"{place}.link", f"link {rod.link} has a radius already; leave one out"))
        thick.add(rod.link)
    return problems


def _of_stop(
    place: str, stop: StopForm, joints: Sequence[Written], ranged: set[str], coned: set[str]
) -> list[Problem]:
    of_cone = [name for name in ("cone", "seat", "stud") if getattr(stop, name) is not None]
    if stop.range is None and not of_cone:
        return [Problem(place, "says nothing; give a range, a cone of S or U, or leave it out")]
    owner = next((joint for joint in joints if joint.name == stop.joint), None)
    problems = []
    if stop.range is not None and joints:
        column, wrong = named_column(stop.joint, joints)
        if owner is not None and owner.is_ball:
            message = f"joint {shown(stop.joint)} is a ball; give it a cone in place of a range"
            problems.append(Problem(f"{place}.range", message))
        elif wrong:
            problems.append(Problem(f"{place}.joint", wrong))
        elif column in ranged:
            problems.append(Problem(f"{place}.range", f"joint {shown(column)} has a range already"))
        ranged.add(column)
    for name in of_cone if joints else ():
        if owner is None or not owner.bends:
            known = [joint.name for joint in joints if joint.bends]
            remedy = f"give it to {' or '.join(known)}" if known else "leave it out, the loop has none"
            problems.append(
                Problem(
                    f"{place}.{name}", f"is of joints S and U, which {shown(stop.joint)} is not; {remedy}"
                )
            )
    if of_cone and stop.joint in coned:
        problems.append(Problem(f"{place}.{of_cone[0]}", f"joint {shown(stop.joint)} has a cone already"))
    coned.update([stop.joint] if of_cone else [])
    return problems or flaws_of_value(place, lambda: Cone(stop.cone))
