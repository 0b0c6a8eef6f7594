"""What a report says of a net's links and of the order in which they are solved."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.nets.order import LinkBlock, order_of
from sevenbar.reporting.drawn import drawn_lines, drawn_of
from sevenbar.text.words import say

if TYPE_CHECKING:
    from sevenbar.reporting.page import Facts

#: How links of a block are found, in words.
SOLVERS = {
    "dyad": "a dyad, in closed form",
    "loop": "one loop",
    "links": "together",
}


def net_facts(motion: Motion) -> list[tuple[str, str]]:
    """How many links and joints there are, in which order they are solved, and what the drawing is."""
    linkage, mobility = motion.linkage, motion.mobility
    column = linkage.input_column(motion.input)
    drawn = drawn_lines(linkage, column, mobility, drawn_of(linkage, column, mobility))
    facts = [("net", net_text(linkage)), ("solving", order_text(linkage, column))]
    return facts + [("as drawn", line) for line in drawn]


def net_text(linkage: Solvable) -> str:
    """How many links, joints and rods there are."""
    return say(
        "{links} links, {joints} joint{j}, {rods} rod{s}; {ground} is the ground",
        links=linkage.graph.ground,
        joints=linkage.graph.joints.stop,
        j="" if linkage.graph.joints.stop == 1 else "s",
        rods=len(linkage.rods),
        s="" if len(linkage.rods) == 1 else "s",
        ground=linkage.link_names[-1],
    )


def order_text(linkage: Solvable, column: int) -> str:
    """In which order it is solved with a column held."""
    order = order_of(linkage, column)
    if order.free:
        return say("by the count these links keep a freedom: {links}", links=", ".join(order.free))
    if order.held:
        return say("by the count these hold links twice over: {joints}", joints=", ".join(order.held))
    blocks = (
        say(
            "{links} ({solver})", links=", ".join(names_of(linkage, block)), solver=say(SOLVERS[block.solver])
        )
        for block in order.blocks
    )
    return say("with the input held: {blocks}", blocks=say("; ").join(blocks))


def names_of(linkage: Solvable, block: LinkBlock) -> list[str]:
    """The links of a block."""
    return [linkage.link_name(link) for link in block.links]


def block_facts(linkage: Solvable, block: LinkBlock) -> Facts:
    """A block as a row of a table, and by its keys."""
    # JSON of a single loop needs nothing that prints pages
    from sevenbar.reporting.page import Facts

    names = names_of(linkage, block)
    by = [linkage.joints[joint].name for joint in block.joints]
    by += [linkage.rods[rod].name for rod in block.rods]
    row = Facts()
    row.add("block", ", ".join(names), links=names)
    row.add("joints and rods", ", ".join(by), by=by)
    row.add("moving", say(block.group), group=block.group)
    row.add("solved", say(SOLVERS[block.solver]), solver=block.solver)
    return row


def net_dict(linkage: Solvable, column: int) -> dict[str, Any]:
    """The links of a net, and the order in which they are solved with a column held, as values."""
    order = [block_facts(linkage, block).as_dict for block in order_of(linkage, column).blocks]
    return {"links": list(linkage.link_names), "order": order}
