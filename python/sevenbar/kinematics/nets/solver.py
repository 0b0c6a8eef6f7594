"""A net of several loops: its freedoms, its redundant constraints, its modes and its motion."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from sevenbar.arrays import Floats, Integers, Words
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.circuits.from_core import circuit_from, motion_from, trace_from
from sevenbar.kinematics.loop.mobility import Mobility
from sevenbar.kinematics.nets.modes import net_modes
from sevenbar.kinematics.nets.order import Parts, order_of
from sevenbar.kinematics.nets.parts import parts_of
from sevenbar.kinematics.nets.tree import CoreCircuit, NetFollowed, NetRows, Tree
from sevenbar.kinematics.solvers.followed_last import FollowedLast
from sevenbar.kinematics.solvers.general import AGREE, at_rest, no_circuit

if TYPE_CHECKING:
    from sevenbar.kinematics.circuits.circuit import Circuit
    from sevenbar.kinematics.circuits.modes import Modes
    from sevenbar.kinematics.circuits.motion import Motion, Solvable
    from sevenbar.kinematics.loop.law import Law

#: Three constraints of a planar or spherical cycle repeat others.
BY_GROUP = {
    "planar": ("a force across the plane", "a moment about one direction in it", "a moment about another"),
    "spherical": ("a force along x", "a force along y", "a force along z"),
}


class NetSolver:
    """The solver of a net."""

    def __init__(self, linkage: Solvable) -> None:
        self._linkage = linkage
        self._trees: dict[tuple[int, int], Tree] = {}
        self._found: dict[int, Mobility] = {}
        self._last = FollowedLast[NetFollowed]()

    def __reduce__(self) -> tuple[type[NetSolver], tuple[Solvable]]:
        return NetSolver, (self._linkage,)

    def mobility(self, column: int) -> Mobility:
        """How freely the net moves about the drawn pose; the tree begins with a column's joint.

        Redundant constraints are those by which a part moves in a plane or about a point, cycle by cycle, and
        how many there are besides.
        """
        if column not in self._found:
            self._found[column] = self._mobility(column)
        return self._found[column]

    def _mobility(self, column: int) -> Mobility:
        linkage = self._linkage
        tree = Tree(linkage, (linkage.joint_of(column),))
        _, repeated, free = tree.core.freedoms()
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
            # of all joints: those off the tree are determined by it
            rank=freedoms - len(free),
            # spins move nothing else
            finite=len(free) - len(parts.spins),
            idle=self.idle(),
            redundant=tuple(lines) if besides >= 0 else ("a constraint that repeats others",) * len(repeated),
        )

    def modes(self, column: int, value: float) -> Modes:
        """Every assembly mode at one value of a column."""
        return net_modes(self._linkage, self._tree(column, column), column, value)

    def motion(self, column: int, output: int, samples: int, speed: float, law: Law | None) -> Motion:
        """Every circuit through the modes at many values of a column."""
        linkage, tree = self._linkage, self._tree(column, output)
        table = None if law is None else law.table
        parts = parts_of(linkage, tree)
        raw, rows = tree.followed(lambda core: core.motion(parts, column, output, samples, speed, table))
        if raw.moving is not None and not raw.circuits:
            raise at_rest(linkage, column, raw.moving)
        circuits = tuple(
            self._circuit(i, raw_circuit, (column, output), speed, law)
            for i, raw_circuit in enumerate(zip(raw.circuits, rows, strict=True))
        )
        return motion_from(
            raw,
            linkage=linkage,
            columns=(column, output),
            speed=speed,
            samples=samples,
            law=law,
            circuits=circuits,
            size=linkage.size,
            redundant=self.mobility(column).redundant,
            agree=AGREE,
        )

    def circuit(
        self, pose: Floats, column: int, output: int, samples: int, speed: float, law: Law | None
    ) -> Circuit:
        """The one circuit through a pose (columns,)."""
        linkage, tree = self._linkage, self._tree(column, output)
        table = None if law is None else law.table
        if (known := self._last.of(pose, column, output)) is not None:
            again = tree.core.circuit_again(known, column, output, samples, speed, table)
            if again is None:
                raise no_circuit(linkage, column, None, linkage.size)
            return self._circuit(0, again, (column, output), speed, law)
        parts = parts_of(linkage, tree)
        raw = tree.followed(
            lambda core: core.circuit_through(parts, pose, column, output, samples, speed, table)
        )
        match raw:
            case ():
                raise no_circuit(linkage, column, None, linkage.size)
            case tuple() as result:
                circuit, followed = result
                self._last.keep(followed, pose, column, output)
                return self._circuit(0, circuit, (column, output), speed, law)
            case other:
                raise no_circuit(linkage, column, other, linkage.size)

    def ratio_at_rest(self, pose: Floats, column: int, output: int) -> float | None:
        """d(output)/d(input) at a pose (columns,) where both rest; `None` where one of them moves."""
        return self._tree(column, output).followed(lambda core: core.ratio_at_rest(pose, column, output))

    def _tree(self, column: int, output: int) -> Tree:
        """The tree of an input and an output, made once."""
        if (column, output) not in self._trees:
            ends = [self._linkage.column_of(end).joint for end in (column, output)]
            # where a link on rods alone is has columns in every tree
            joints = tuple(dict.fromkeys(joint for joint in ends if joint is not None))
            self._trees[column, output] = Tree(self._linkage, joints, order_of(self._linkage, column))
        return self._trees[column, output]

    def _circuit(
        self,
        index: int,
        circuit: CoreCircuit,
        columns: tuple[int, int],
        speed: float,
        law: Law | None,
    ) -> Circuit:
        raw, rows = circuit
        return circuit_from(
            raw,
            linkage=self._linkage,
            index=index,
            columns=columns,
            speed=speed,
            law=law,
            size=self._linkage.size,
            point=partial(self._trace, rows, columns),
        )

    def _trace(
        self,
        rows: NetRows,
        columns: tuple[int, int],
        order: Integers,
        status: Words,
        link: int,
        at: Floats,
    ) -> Trace:
        """A point along rows of a circuit over input and output `columns`, in an order and of a status."""
        tree = self._tree(*columns)
        step = tree.carrier[link]
        return trace_from(None if step is None else tree.core.point(rows, step, at), order, status, at)

    def idle(self) -> tuple[str, ...]:
        """Freedoms that move no other link."""
        spinning = [rod.name for rod in self._linkage.rods]
        spinning += [self._linkage.link_name(link) for link in Parts(self._linkage).spins.values()]
        return tuple(f"turn of {name} about the line of its two balls" for name in spinning)

    def idle_links(self) -> frozenset[int]:
        """The links, counted from 1, that have such a freedom."""
        return frozenset(Parts(self._linkage).spins.values())


def _listed(linkage: Solvable, links: list[int]) -> str:
    return ", ".join(map(linkage.link_name, links))
