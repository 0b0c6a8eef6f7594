"""Sentences on a net as drawn: nothing moves, one input is too few, a dead centre, nearly movable."""

from __future__ import annotations

from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.loop.mobility import Mobility
from sevenbar.kinematics.nets.drawn import DrawnPose, drawn_pose
from sevenbar.kinematics.nets.order import Parts
from sevenbar.text.words import say

#: Most joints that are offered as an input.
MOST_OTHERS = 3


def drawn_of(linkage: Solvable, column: int, mobility: Mobility) -> DrawnPose:
    """What the drawn pose of a net is for an input."""
    return drawn_pose(linkage, column, (mobility.finite or 0) + len(Parts(linkage).spins))


def drawn_lines(linkage: Solvable, input: int, mobility: Mobility, drawn: DrawnPose) -> list[str]:
    """Sentences on a drawing that is not a pose like others of a net with one freedom."""
    column = linkage.column_of(input)
    lines = []
    if drawn.word == "rigid":
        lines.append(say("nothing moves; leave out a joint or a rod, or give a joint more freedoms"))
        if drawn.nearly is not None:
            lines.append(
                say(
                    "nearly moves: {where} would open by {opens:.3g} {unit} for each {step} of {input}",
                    where=drawn.nearly.where,
                    opens=drawn.nearly.opens,
                    unit=linkage.length_unit,
                    step=column.unit,
                    input=column.name,
                )
            )
    elif drawn.word == "shaky":
        lines.append(say("as drawn it moves to first order alone; draw it in another pose"))
    elif mobility.finite and mobility.finite > 1:
        lines.append(
            say(
                "one input is too few for {count} freedoms; join links by more joints or rods",
                count=mobility.finite,
            )
        )
    if drawn.word == "change-point":
        lines.append(say("drawn at a change point, where branches meet; draw it in another pose"))
    elif drawn.word == "dead-centre":
        others = ", ".join(drawn.others[:MOST_OTHERS])
        lines.append(
            say(
                "drawn at a dead centre of {input}, where two modes meet; draw it in another pose, or drive "
                "{others}",
                input=column.name,
                others=others,
            )
        )
    return lines
