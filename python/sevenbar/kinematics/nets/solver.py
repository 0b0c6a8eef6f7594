"""What a net of several loops answers so far: its freedoms, its redundant constraints, modes of dyads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sevenbar.kinematics.loop.mobility import Mobility
from sevenbar.kinematics.nets.modes import net_modes
from sevenbar.kinematics.nets.order import Parts
from sevenbar.kinematics.nets.tree import Tree

if TYPE_CHECKING:
    from sevenbar.kinematics.circuits.modes import Modes
    from sevenbar.kinematics.circuits.motion import Solvable

#: Three constraints of a planar or spherical cycle repeat others.
BY_GROUP = {
    "planar": ("a force across the plane", "a moment about one direction in it", "a moment about another"),
    "spherical": ("a force along x", "a force along y", "a force along z"),
}


class NetSolver:
    """The solver of a net."""

    def __init__(self, linkage: Solvable) -> None:
        self._linkage = linkage

    def mobility(self, column: int) -> Mobility:
        """How freely the net moves about the drawn pose; the tree begins with a column's joint.

        Redundant constraints are those by which a part moves in a plane or about a point, cycle by cycle, and
        how many there are besides.
        """
        linkage = self._linkage
        tree = Tree(linkage, linkage.column_of(column).joint)
        rank, repeated, free = tree.core().freedoms()
        freedoms = sum(len(joint.row.freedoms) for joint in linkage.joints)
        lines, graph = [], linkage.graph
        parts = Parts(linkage)
        for links, cycles, group in parts.cycles:
            lines += [
                f"{line}, in cycle {cycle} of {_listed(linkage, links)}"
                for cycle in range(1, cycles + 1)
                for line in BY_GROUP.get(group, ())
            ]
        besides = len(repeated) - len(lines)
        lines += ["a constraint that repeats the others of its cycles"] * besides
        return Mobility(
            freedoms=freedoms,
            gruebler=6 * (graph.ground - 1)
            - sum(6 - len(j.row.freedoms) for j in linkage.joints)
            - len(linkage.rods),
            rank=rank,
            # spins move nothing else
            finite=len(free) - len(parts.spins),
            idle=self.idle(),
            redundant=tuple(lines) if besides >= 0 else ("a constraint that repeats others",) * len(repeated),
        )

    def modes(self, column: int, value: float) -> Modes:
        """Every assembly mode at one value of a column; of nets of dyads."""
        return net_modes(self._linkage, column, value)

    def idle(self) -> tuple[str, ...]:
        """Freedoms that move no other link."""
        spinning = [rod.name for rod in self._linkage.rods]
        spinning += [self._linkage.link_name(link) for link in Parts(self._linkage).spins.values()]
        return tuple(f"turn of {name} about the line of its two balls" for name in spinning)


def _listed(linkage: Solvable, links: list[int]) -> str:
    return ", ".join(map(linkage.link_name, links))
