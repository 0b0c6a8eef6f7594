"""The report of forces in the poses at one value of the input."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from sevenbar.forces.result import COMPONENTS, Forces
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.one_pose import OnePose
from sevenbar.reporting import force_words
from sevenbar.reporting.files import Report
from sevenbar.reporting.page import Facts, number_table, page
from sevenbar.reporting.pose_text import driven_text, in_report, reaction_rows, stops_dict, stops_text
from sevenbar.reporting.shown import Shown, number
from sevenbar.text.words import say


@dataclass(frozen=True, eq=False)
class PoseForces:
    """The forces in some poses of a linkage, each with its forces of one row."""

    linkage: Solvable
    poses: Sequence[tuple[OnePose, Forces]]


def pose_forces_report() -> Report[PoseForces]:
    """How they are reported."""
    return Report(text, as_dict, spoken=True)


def text(found: PoseForces) -> RenderableType:
    """The forces in each pose as a page."""
    linkage = found.linkage
    pose, forces = found.poses[0]
    sliding = [column.name for column in linkage.each_column if not column.turns]
    facts = Facts()
    value = Shown(linkage.unit_of(pose.input))(pose[pose.input])
    facts.add(say("pose"), say("{joint} = {value}", joint=pose.input, value=value))
    driven = driven_text(linkage, pose)
    if forces.at_rest:
        driven = say("at rest: no inertia, no damping")
    facts.add(say("drive"), driven)
    facts.add_all(force_words.acting_facts(forces, sliding))
    # the table says which are known
    facts.add_all(force_words.open_facts(forces)[:2])
    meaning = say(
        "what the link before a joint puts on the link after it, at the joint's place, along x, y, z of the "
        "report frame"
    )
    return page(linkage.heading, facts, *_parts(found), Text(meaning, style="dim"))


def _parts(found: PoseForces) -> Iterator[RenderableType]:
    linkage = found.linkage
    for pose, forces in found.poses:
        facts = Facts()
        where = say(
            "{circuit}, pass {number}",
            circuit=say("circuit {number}", number=pose.circuit),
            number=pose.branch,
        )
        joints = ", ".join(
            f"{column.name} {Shown(column.unit)(value)}"
            for column, value in zip(linkage.each_column, pose.q, strict=True)
        )
        facts.add(where, joints)
        if pose.status != "ok":
            facts.add(say("rates"), say(pose.status))
        if stops := stops_text(pose):
            facts.add(say("stops"), stops)
        label = say("input force") if forces.slides else say("input torque")
        torque = float(forces.torque[0])
        known = torque == torque
        facts.add(label, f"{number(torque)} {forces.unit}" if known else say(force_words.OPEN), "bold")
        if known and not forces.at_rest:
            facts.add(say("power"), f"{number(float(forces.power[0]))} W")
        head, rows = reaction_rows(list(forces.reactions.values()))
        yield Group(facts.grid, number_table(head, rows))


def as_dict(found: PoseForces) -> dict[str, Any]:
    """The forces in each pose as plain values, along the axes of the report frame; null where open."""
    linkage = found.linkage
    pose, forces = found.poses[0]
    return {
        "format": 1,
        "linkage": {"name": linkage.name, "kind": linkage.kind},
        "units": {
            "length": linkage.length_unit,
            "angle": "rad",
            "time": "s",
            "force": "N",
            "moment": "N m",
            "power": "W",
            "torque": forces.unit,
        },
        "drive": {
            "input": pose.input,
            "value": pose[pose.input],
            "speed": None if forces.at_rest else pose.speed,
            "acceleration": None if forces.at_rest else pose.acceleration,
            "at_rest": forces.at_rest,
        },
        "poses": [_pose_dict(pose, forces) for pose, forces in found.poses],
        "not_determined": list(forces.indeterminate),
    }


def _pose_dict(pose: OnePose, forces: Forces) -> dict[str, Any]:
    return {
        "circuit": pose.circuit,
        "branch": pose.branch,
        "q": pose.q.tolist(),
        "rates": pose.status,
        **stops_dict(pose),
        "torque": float(forces.torque[0]),
        "power": None if forces.at_rest else float(forces.power[0]),
        "joints": {
            name: {
                "at": one.at[0].tolist(),
                "force": in_report(one, "force").tolist(),
                "moment": in_report(one, "moment").tolist(),
                "determinate": dict(zip(COMPONENTS, one.determinate.tolist(), strict=True)),
            }
            for name, one in forces.reactions.items()
        },
    }
