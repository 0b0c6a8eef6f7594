"""The report of forces in the poses at one value of the input."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Group
from rich.text import Text

from sevenbar.forces.result import COMPONENTS, Forces
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.one_pose import OnePose
from sevenbar.reporting import force_words
from sevenbar.reporting.files import Report, head_of
from sevenbar.reporting.page import Facts, Page, number_table, page
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
    return Report(page_of, lambda result: page_of(result).facts.as_dict, spoken=True)


def page_of(result: PoseForces) -> Page:
    """The forces in each pose, along the axes of the report frame; null where open."""
    linkage = result.linkage
    pose, forces = result.poses[0]
    sliding = [column.name for column in linkage.each_column if not column.turns]
    units = {"force": "N", "moment": "N m", "power": "W", "torque": forces.unit}
    facts = Facts()
    facts.also(**head_of(linkage, **units))
    value = Shown(linkage.unit_of(pose.input))(pose[pose.input])
    facts.add(say("pose"), say("{joint} = {value}", joint=pose.input, value=value))
    rest = forces.at_rest
    drive = {"input": pose.input, "value": pose[pose.input]}
    drive |= {name: None if rest else getattr(pose, name) for name in ("speed", "acceleration")}
    driven = say("at rest: no inertia, no damping") if rest else driven_text(linkage, pose)
    facts.add(say("drive"), driven, drive={**drive, "at_rest": rest})
    facts.add_all(force_words.acting_facts(forces, sliding))
    # the table says which are known
    facts.add_all(force_words.open_facts(forces)[:2])
    meaning = say(
        "what the link before a joint puts on the link after it, at the joint's place, along x, y, z of the "
        "report frame"
    )
    poses = [_facts(linkage, *one) for one in result.poses]
    facts.also(poses=[one.as_dict for one in poses], not_determined=list(forces.indeterminate))
    parts = [
        Group(one.grid, number_table(*reaction_rows(list(loads.reactions.values()))))
        for one, (_, loads) in zip(poses, result.poses, strict=True)
    ]
    return page(linkage.heading, facts, *parts, Text(meaning, style="dim"))


def _facts(linkage: Solvable, pose: OnePose, forces: Forces) -> Facts:
    """The forces in one pose."""
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
    facts.add(where, joints, circuit=pose.circuit, branch=pose.branch, q=pose.q.tolist())
    facts.add(say("rates"), "" if pose.status == "ok" else say(pose.status), rates=pose.status)
    facts.add(say("stops"), stops_text(pose), **stops_dict(pose))
    label = say("input force") if forces.slides else say("input torque")
    torque, power = float(forces.torque[0]), None if forces.at_rest else float(forces.power[0])
    known = torque == torque
    text = f"{number(torque)} {forces.unit}" if known else say(force_words.OPEN)
    facts.add(label, text, "bold", torque=torque)
    facts.add(say("power"), "" if power is None or not known else f"{number(power)} W", power=power)
    bearings = {
        name: {
            "at": one.at[0].tolist(),
            "force": in_report(one, "force").tolist(),
            "moment": in_report(one, "moment").tolist(),
            "determinate": dict(zip(COMPONENTS, one.determinate.tolist(), strict=True)),
        }
        for name, one in forces.reactions.items()
    }
    facts.also(joints=bearings)
    return facts
