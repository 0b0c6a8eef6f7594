"""A net of several loops that one input does not move: its freedoms, repeated constraints, blocks."""

from __future__ import annotations

from dataclasses import replace

from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Drive
from sevenbar.kinematics.loop.joint_text import joint_speed
from sevenbar.reporting.drawn import drawn_lines, drawn_of
from sevenbar.reporting.net_facts import block_facts, net_text, order_text
from sevenbar.reporting.page import Facts, Page, facts_table, page, page_report
from sevenbar.reporting.repeated import repeated_lines
from sevenbar.reporting.shown import drive_text
from sevenbar.text.words import retold, say


def driven_by(linkage: Linkage, joint: str | None, speed: str | None) -> Linkage:
    """A net with another input, or another speed of it, than its own where they are not `None`."""
    if joint is None and speed is None:
        # which keeps what was worked out of it
        return linkage
    column = linkage.input_column(joint, "--input")
    drive = Drive(linkage.columns[column], linkage.columns[linkage.other_column(column)])
    rate = linkage.speed_of(column) if speed is None else joint_speed(speed, linkage, column)
    return replace(linkage, drive=replace(drive, speed=rate))


def net_page(linkage: Linkage) -> Page:
    """A net as it is drawn."""
    mobility = linkage.mobility()
    facts = Facts()
    facts.also(format=1, name=linkage.heading, links=list(linkage.link_names))
    facts.add("net", net_text(linkage))
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
    drawn = drawn_of(linkage, drive.number, mobility)
    facts.also(drawn=drawn.word)
    for line in drawn_lines(linkage, drive.number, mobility, drawn):
        facts.add("as drawn", line)
    for line in mobility.idle:
        facts.add("idle", retold(line))
    for line in repeated_lines(linkage, len(mobility.redundant)):
        facts.add("repeated", line)
    rows = [block_facts(linkage, block) for block in linkage.order.blocks]
    facts.add("solving", order_text(linkage, drive.number), order=[row.as_dict for row in rows])
    parts = [facts_table(rows)] if rows else []
    return page(linkage.heading, facts, *parts)


def _freedoms_text(finite: int | None, gruebler: int) -> str:
    moves = say("moves with {count} about the drawn pose", count=finite)
    return (
        moves if finite == gruebler else say("{moves}; Gruebler counts {count}", moves=moves, count=gruebler)
    )


NET = page_report(net_page, "net", {})
