"""A net of several loops before it moves: its freedoms, repeated constraints, the order of solving."""

from __future__ import annotations

from dataclasses import replace

from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Drive
from sevenbar.kinematics.loop.joint_text import joint_speed
from sevenbar.kinematics.nets.order import LinkBlock, Order
from sevenbar.reporting.drawn import drawn_lines, drawn_of
from sevenbar.reporting.page import Facts, Page, facts_table, page, page_report
from sevenbar.reporting.repeated import repeated_lines
from sevenbar.reporting.shown import drive_text
from sevenbar.text.words import retold, say

#: How links of a block are found, in words.
SOLVERS = {
    "dyad": "a dyad, in closed form",
    "loop": "one loop",
    "links": "together",
}


def driven_by(linkage: Linkage, joint: str | None, speed: str | None) -> Linkage:
    """A net with another input, or another speed of it, than its own where they are not `None`."""
    column = linkage.input_column(joint, "--input")
    drive = Drive(linkage.columns[column], linkage.columns[linkage.other_column(column)])
    rate = linkage.speed_of(column) if speed is None else joint_speed(speed, linkage, column)
    return replace(linkage, drive=replace(drive, speed=rate))


def net_page(linkage: Linkage) -> Page:
    """A net as it is drawn."""
    mobility, order = linkage.mobility(), linkage.order
    facts = Facts()
    facts.also(format=1, name=linkage.heading, links=list(linkage.link_names))
    count = {
        "links": linkage.graph.ground,
        "joints": linkage.graph.joints.stop,
        "rods": len(linkage.rods),
        "s": "" if len(linkage.rods) == 1 else "s",
        "ground": linkage.link_names[-1],
    }
    facts.add("net", say("{links} links, {joints} joints, {rods} rod{s}; {ground} stands still", **count))
    drive = linkage.column_of(linkage.input_column())
    speed = linkage.speed_of(drive.number)
    facts.add("drive", drive_text(drive.name, speed, drive.unit), drive={"input": drive.name, "speed": speed})
    facts.add(
        "freedoms",
        _freedoms_text(mobility.finite, mobility.gruebler),
        mobility={
            "gruebler": mobility.gruebler,
            "freedoms": mobility.finite,
            "idle": list(mobility.idle),
            "redundant": list(mobility.redundant),
        },
    )
    drawn = drawn_of(linkage, mobility)
    facts.also(drawn=drawn.word)
    for line in drawn_lines(linkage, mobility, drawn):
        facts.add("as drawn", line)
    for line in mobility.idle:
        facts.add("idle", retold(line))
    for line in repeated_lines(linkage, len(mobility.redundant)):
        facts.add("repeated", line)
    facts.add("solving", _order_text(order), order=[_block(block, linkage).as_dict for block in order.blocks])
    parts = [facts_table([_block(block, linkage) for block in order.blocks])] if order.blocks else []
    return page(linkage.heading, facts, *parts)


def _freedoms_text(finite: int | None, gruebler: int) -> str:
    moves = say("moves with {count} about the drawn pose", count=finite)
    return (
        moves if finite == gruebler else say("{moves}; Gruebler counts {count}", moves=moves, count=gruebler)
    )


def _order_text(order: Order) -> str:
    if order.free:
        return say("by the count these links keep a freedom: {links}", links=", ".join(order.free))
    if order.held:
        return say("by the count these hold links twice over: {joints}", joints=", ".join(order.held))
    return say("with the input held, block by block")


def _block(block: LinkBlock, linkage: Linkage) -> Facts:
    names = [linkage.link_name(link) for link in block.links]
    by = [linkage.joints[joint].name for joint in block.joints] + [
        linkage.rods[rod].name for rod in block.rods
    ]
    row = Facts()
    row.add("block", ", ".join(names), links=names)
    row.add("joints and rods", ", ".join(by), by=by)
    row.add("moving", say(block.group), group=block.group)
    row.add("solved", say(SOLVERS[block.solver]), solver=block.solver)
    return row


NET = page_report(net_page, "net", {})
