"""Any single loop by the general path."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import accumulate
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

import sevenbar._core as _core
from sevenbar.arrays import Floats, Integers, Words
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Trace
from sevenbar.kinematics.circuits.from_core import circuit_from, motion_from, tally_from, trace_from
from sevenbar.kinematics.circuits.long_circuit import LONG, LongCircuit
from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.circuits.motion import HeldFreedoms, Motion, Solvable
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.joints import Z
from sevenbar.kinematics.loop.no_length import no_length
from sevenbar.kinematics.loop.once import once_for
from sevenbar.kinematics.loop.rigid import axis_to_z, inverse, placed
from sevenbar.kinematics.loop.single import check_single
from sevenbar.kinematics.solvers.followed_last import FollowedLast

if TYPE_CHECKING:
    from sevenbar.kinematics.loop.law import Law
    from sevenbar.kinematics.loop.mobility import Mobility

T = TypeVar("T")

#: The closure error [rad, or relative to the size] up to which redundant constraints agree by default.
AGREE = _core.AGREE

#: Rank six, and the one that is driven.
MOST_FREEDOMS = 7

#: The motion that leaves all where it is.
STILL = np.eye(4)


class GeneralLoop:
    """The solver of one loop. Some joints are several for the core, so links are counted anew there."""

    def __init__(self, linkage: Solvable, agree: float = AGREE) -> None:
        self._linkage, self._agree = linkage, agree
        parts = expanded(linkage)
        self._base, self._link, self._behind = parts.base, parts.last, parts.behind
        self._core = _core.Loop(
            parts.letters, np.array(parts.advances), parts.base, parts.ground, np.array(parts.links), agree,
            linkage.drawn_pose if linkage.drawn_pose.any() else None,
        )  # fmt: skip
        self._found: dict[int, Mobility] = {}
        self._last = FollowedLast[_core.Followed]()
        held = (parts.columns[joint] for word, joint, _ in self._core.idle if "between-balls" not in word)
        for column in held:
            if linkage.drawn_pose[column]:
                raise RequestError(
                    f"value: joint '{linkage.columns[column]}' reads 0 wherever it is, as its freedom moves "
                    f"nothing else ({'; '.join(self.idle())}); leave its value out"
                )

    def __reduce__(self) -> tuple[type[GeneralLoop], tuple[Solvable, float]]:
        return GeneralLoop, (self._linkage, self._agree)

    @property
    def size(self) -> float:
        """The size [length] of which residuals are parts."""
        return self._core.size

    def idle(self) -> tuple[str, ...]:
        """Freedoms that move one link only, in words."""
        names = [joint.name for joint in self._linkage.joints]

        def text(word: str, links: range, held: int, other: int) -> str:
            first, second, who = names[held], names[other], _named(links)
            match word:
                case "between-balls" if self._linkage.kind == "RSSR":
                    return f"spin of the coupler ({who}) about the line of {first} and {second}"
                case "between-balls" | "chain-between-balls":
                    return f"spin of {who} about the line of {first} and {second}"
                case "ball-on-axis":
                    return f"spin of {who} about the axis of {first}, on which {second} lies"
                case "one-axis":
                    return f"turn of {who} about the common axis of {second} and {first}"
                case "on-plate":
                    return f"spin of {who} about the normal of {first} through {second}"
                case _:
                    return f"slide of {who} along the common direction of {second} and {first}"

        return tuple(text(*freedom) for freedom in self._idle())

    def held(self) -> HeldFreedoms:
        """How idle freedoms are held."""
        letters = expanded(self._linkage).letters
        first = np.concatenate([[0], np.cumsum([3 if letter == "S" else 1 for letter in letters])])
        balls, columns, spins = set(), [], 0
        for (word, held, _), (_, _, joint, _) in zip(self._core.idle, self._idle(), strict=True):
            if word == "between-balls":
                balls.add(joint)
                columns.append(int(first[held]) + 2)
            elif word == "chain-between-balls":
                spins += 1
            else:
                columns.append(int(first[held]))
        return HeldFreedoms(frozenset(balls), columns, spins)

    def idle_links(self) -> frozenset[int]:
        """The links that have such a freedom, counted from 1."""
        result: set[int] = set()
        for _, links, _, _ in self._idle():
            result |= set(links)
        return frozenset(result)

    def unheld(self) -> str | None:
        """The idle freedom for which the core has no rule, in words, of a loop that one input moves."""
        if self._core.can_be_driven or self._core.freedoms > MOST_FREEDOMS:
            return None
        return self.idle()[-1]

    def spin_axes(self) -> dict[str, Floats]:
        """The axis (3,) that holds the idle spin beyond a ball, by the ball's name, in its frame before."""
        owner = self._owners()
        return {
            self._linkage.joints[owner[joint]].name: np.array(axis) for joint, axis in self._core.spin_axes
        }

    def _owners(self) -> list[int]:
        """The joint of the description that each of the core's joints belongs to."""
        owner = [0] * (max(self._link) + 1)
        for joint, last in enumerate(self._link):
            owner[last] = joint
        for inner in range(len(owner)):
            if inner not in self._link:
                owner[inner] = owner[inner + 1]
        return owner

    def _idle(self) -> list[tuple[str, range, int, int]]:
        """Each such freedom: the core's word, links counted from 1, the joints held and on the other side."""
        owner = self._owners()
        result = []
        for word, held, other in self._core.idle:
            a, b = owner[held], owner[other]
            # the cross of a joint with two axes on one line counts as the link after it
            first = min(a, b) + 1
            result.append((word, range(first, max(a, b, first) + 1), a, b))
        return result

    def modes(self, column: int, value: float) -> Modes:
        """Every assembly mode at one value of a column."""
        q, residual, completeness, open_by, on_curve = self._solve(
            column, partial(self._core.assembly_modes, column, value)
        )
        columns = self._linkage.columns
        return Modes(
            q, residual * self.size, completeness, columns, value, np.array(open_by), self._agree,
            None if on_curve is None else np.array(on_curve),
        )  # fmt: skip

    def mobility(self, column: int) -> Mobility:
        """How freely the loop moves; poses are looked for over the values of a column."""
        column = self._free((column,))[0]
        if column not in self._found:
            self._found[column] = self._mobility(self._solve(column, partial(self._core.mobility, column)))
        return self._found[column]

    def motion(self, column: int, output: int, samples: int, speed: float, law: Law | None) -> Motion:
        """Every circuit over the whole range of one column."""
        linkage = self._linkage
        table = None if law is None else law.table
        keep = samples < LONG
        first, last = self._free((column, output))
        raw = self._solve(first, partial(self._core.motion, first, last, samples, speed, table, keep))
        assert raw.search is not None
        if raw.circuits and (first, last) != (column, output):
            raise self._held_end(column if first != column else output, is_input=first != column)
        mobility = self._mobility(raw.search.found)
        if law is None:
            self._found[first] = mobility
        if raw.moving is not None and not raw.circuits:
            raise at_rest(linkage, column, raw.moving)
        circuits = tuple(
            self._circuit(i, c, (column, output), speed, law) for i, c in enumerate(raw.circuits)
        )
        return motion_from(
            raw,
            linkage=linkage,
            columns=(column, output),
            speed=speed,
            samples=samples,
            law=law,
            circuits=circuits,
            size=self.size,
            redundant=mobility.redundant,
            agree=self._agree,
        )

    def circuit(
        self, pose: Floats, column: int, output: int, samples: int, speed: float, law: Law | None
    ) -> Circuit:
        """The one circuit through a pose (columns,)."""
        table = None if law is None else law.table
        if (known := self._last.of(pose, column, output)) is not None:
            again = self._core.circuit_again(known, column, output, samples, speed, table)
            return self._circuit(0, again, (column, output), speed, law)
        raw = self._solve(
            column, partial(self._core.circuit_through, pose, column, output, samples, speed, table)
        )
        match raw:
            case ():
                raise no_circuit(self._linkage, column, None, self.size)
            case tuple() as result:
                circuit, followed = result
                self._last.keep(followed, pose, column, output)
                return self._circuit(0, circuit, (column, output), speed, law)
            case other:
                raise no_circuit(self._linkage, column, other, self.size)

    def _free(self, ends: tuple[int, ...]) -> tuple[int, ...]:
        """Columns that move in the place of those that an idle freedom holds: a rigid loop is so for each."""
        columns = expanded(self._linkage).columns
        held = {columns[joint] for word, joint, _ in self._core.idle if "between-balls" not in word}
        names = self._linkage.columns
        others = [names.index(name) for name in self._linkage.drivable()]
        spare = [c for c in others if c not in held and c not in ends]
        return tuple(spare.pop() if c in held and spare else c for c in ends)

    def _held_end(self, column: int, *, is_input: bool) -> RequestError:
        linkage = self._linkage
        end, what = ("input", "drives the loop") if is_input else ("output", "the input moves")
        return RequestError(
            f"{end}: joint '{linkage.columns[column]}' has no freedom that {what} "
            f"({'; '.join(self.idle())}); give another: {', '.join(linkage.drivable(column))}"
        )

    def _solve(self, column: int, call: Callable[[], T]) -> T:
        try:
            return call()
        except _core.CoreError:
            linkage = self._linkage
            if self._core.freedoms > MOST_FREEDOMS:
                left = self._core.freedoms
                raise RequestError(
                    f"linkage: {left} freedoms remain with idle ones held, {left - 6} of which must be "
                    "driven; give a loop that one input moves"
                ) from None
            idle = "; ".join(self.idle())
            raise RequestError(
                f"input: joint '{linkage.columns[column]}' has no freedom that drives the loop"
                + (f" ({idle})" if idle else "")
                + f"; give another: {', '.join(linkage.drivable(column))}"
            ) from None

    def _mobility(self, raw: _core.RawFound | None) -> Mobility:
        from sevenbar.kinematics.loop.mobility import Mobility, redundant_constraints

        linkage = self._linkage
        freedoms = len(linkage.columns)
        finite = None if raw is None else raw.finite
        if raw is None and not self._core.can_be_driven:
            # rank six at most
            finite = self._core.freedoms - 6
        return Mobility(
            freedoms=freedoms,
            gruebler=freedoms - 6,
            rank=None if raw is None else raw.rank,
            idle=self.idle(),
            redundant=() if raw is None else redundant_constraints(raw.wrenches, self._base),
            finite=finite,
        )

    def _circuit(
        self, index: int, raw: _core.RawCircuit, columns: tuple[int, int], speed: float, law: Law | None
    ) -> Circuit:
        known = partial(
            circuit_from,
            raw,
            linkage=self._linkage,
            index=index,
            columns=columns,
            speed=speed,
            law=law,
            size=self.size,
        )
        if raw.course is None:
            return known(point=partial(self._trace, raw.rows))
        course = raw.course

        def made() -> Circuit:
            joints, status, branch, residual, condition, rows = self._core.rows(course)
            return known(point=partial(self._trace, rows), rows=(joints, status, branch, residual, condition))

        return LongCircuit.of(known(point=partial(self._trace, None)), tally_from(course, self.size), made)

    def _trace(self, rows: _core.Rows | None, order: Integers, status: Words, link: int, at: Floats) -> Trace:
        """A point, `at` in its link's own frame, along rows in an order and of a status."""
        if link == len(self._linkage.joints):
            return trace_from(None, order, status, at)
        assert rows is not None
        if self._behind[link - 1] is not STILL:
            at = placed(self._behind[link - 1], at)
        return trace_from(self._core.point(rows, self._link[link - 1], at), order, status, at)


def at_rest(linkage: Loop, column: int, moving: list[int]) -> RequestError:
    """That a column stands still while others move."""
    moving_names = {linkage.columns[c] for c in moving}
    others = [name for name in linkage.drivable(column) if name in moving_names]
    advice = f"; give another: {', '.join(others)}" if others else ""
    if reason := no_length(linkage):
        advice += f"; {' and '.join(reason.joints)} are on one axis, so the link between them has no length"
    return RequestError(
        f"input: joint '{linkage.columns[column]}' stands still while others move, so it cannot drive{advice}"
    )


def no_circuit(linkage: Loop, column: int, why: float | list[int] | None, size: float) -> RequestError:
    """Why no circuit goes through a pose: how far it is from closing, or the columns that move instead."""
    if why is None:
        return RequestError("pose: no motion through it could be followed; see mobility()")
    if isinstance(why, list):
        return at_rest(linkage, column, why)
    return RequestError(
        f"pose: the loop does not close near it (closure error {why * size:.3g} "
        f"{linkage.length_unit}); give a row of assembly_modes() or of a circuit"
    )


def _named(links: range) -> str:
    """Links in a row, in words: "link 1", or "links 1, 2 and 3 together"."""
    *others, last = map(str, links)
    return f"links {', '.join(others)} and {last} together" if others else f"link {last}"


class Steps(NamedTuple):
    """The freedoms of all joints as the core takes them: screws and balls whole, any other step by step.

    `letters` R P H S, `advances` [length for a radian] and `columns` of each, a ball's first.
    """

    letters: str
    advances: list[float]
    columns: list[int]


@once_for(0)
def steps_of(linkage: Loop) -> Steps:
    """The freedoms of the joints of a loop or a net, in order."""
    letters, advances, columns = "", list[float](), list[int]()
    for joint, own in zip(linkage.joints, linkage.places, strict=True):
        whole = joint.row.is_screw or joint.row.is_ball
        for number, step in enumerate(joint.row.steps[:1] if whole else joint.row.steps):
            letters += joint.kind if whole else step.letter
            advances.append(joint.advance)
            columns.append(own.start + number)
    return Steps(letters, advances, columns)


class Expanded(NamedTuple):
    """The joints as the core takes them, each about or along z of its frame.

    `letters` R P H S, `advances` [length for a radian], `base` (4, 4) the frame of the first, `links` (4, 4)
    between them, `ground` (4, 4) the frame behind the last; `last` the number of the last one of each joint
    of the linkage, `behind` (4, 4) from its frame to the joint's; `columns` that of each, a ball's first.
    """

    letters: str
    advances: list[float]
    base: Floats
    links: list[Floats]
    ground: Floats
    last: list[int]
    behind: list[Floats]
    columns: list[int]

    @property
    def frames(self) -> list[Floats]:
        """The frames (4, 4) of all, each where those before it are at zero."""
        return list(accumulate([self.base, *self.links], np.matmul))

    @property
    def around(self) -> list[Floats]:
        """The transforms (4, 4) from each to the next one, of the last to the first."""
        return [*self.links, inverse(self.ground) @ self.base]


@once_for(0)
def expanded(linkage: Loop) -> Expanded:
    """The joints of a loop as the core takes them: screws and balls whole, any other step by step."""
    check_single(linkage)
    letters, advances, columns = steps_of(linkage)
    fixed: list[Floats] = []
    last: list[int] = []
    behind: list[Floats] = []
    ahead = linkage.base
    for i, joint in enumerate(linkage.joints):
        whole = joint.row.is_screw or joint.row.is_ball
        for step in joint.row.steps[:1] if whole else joint.row.steps:
            ahead = ahead @ joint.before(step) if step.tilted else ahead
            fixed.append(ahead if step.axis == Z else ahead @ axis_to_z(step.axis))
            ahead = STILL if step.axis == Z else inverse(axis_to_z(step.axis))
        last.append(len(fixed) - 1)
        behind.append(ahead)
        if i < len(linkage.links):
            ahead = linkage.links[i] if ahead is STILL else ahead @ linkage.links[i]
    ground = linkage.ground if ahead is STILL else linkage.ground @ inverse(ahead)
    return Expanded(letters, advances, fixed[0], fixed[1:], ground, last, behind, columns)
