"""Any single loop by the general path: what the core's arrays come to, and what they mean."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from sevenbar import _core
from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.mobility import Mobility, redundant_constraints
from sevenbar.motion import (
    ChangePoint,
    Circuit,
    Count,
    Integers,
    Law,
    Modes,
    Motion,
    OpenRange,
    Trace,
    Words,
    change_points_from,
    circuit_from,
    status_words,
)
from sevenbar.sensitivity import sensitivity_of
from sevenbar.written import Freedom

if TYPE_CHECKING:
    from sevenbar.linkage import Linkage

#: Rank six, and the one that is driven.
MOST_FREEDOMS = 7

#: An angle [rad] short of a full turn by less is zero.
ROUNDING = 1e-12

#: Limits [rad, or parts of the size] nearer than this are one.
SAME_LIMIT = 1e-6


class GeneralLoop:
    """The solver of one loop. C and U are two joints each for the core, so links are counted anew there."""

    def __init__(self, linkage: Linkage) -> None:
        self._linkage = linkage
        letters, advances, links, self._link = expanded(linkage)
        self._core = _core.Loop(letters, np.array(advances), linkage.base, linkage.ground, np.array(links))
        self._found: dict[int, Mobility] = {}

    def __reduce__(self) -> tuple[type[GeneralLoop], tuple[Linkage]]:
        return GeneralLoop, (self._linkage,)

    @property
    def size(self) -> float:
        """The size [length] of which residuals are parts."""
        return self._core.size

    def idle(self) -> tuple[str, ...]:
        """Freedoms that move one link only, in words."""
        names = [joint.name for joint in self._linkage.joints]

        def told(word: str, link: int, held: int, other: int) -> str:
            first, second = names[held], names[other]
            match word:
                case "between-balls" if self._linkage.kind == "RSSR":
                    return f"spin of the coupler (link {link}) about the line of {first} and {second}"
                case "between-balls":
                    return f"spin of link {link} about the line of {first} and {second}"
                case "chain-between-balls":
                    links = [str(i) for i in range(held + 1, other + 1)]
                    told = f"{', '.join(links[:-1])} and {links[-1]}"
                    return f"spin of links {told} together about the line of {first} and {second}"
                case "ball-on-axis":
                    return f"spin of link {link} about the axis of {first}, on which {second} lies"
                case "one-axis":
                    return f"turn of link {link} about the common axis of {second} and {first}"
                case _:
                    return f"slide of link {link} along the common direction of {second} and {first}"

        return tuple(told(*freedom) for freedom in self._idle())

    def held(self) -> tuple[frozenset[int], list[int], int]:
        """How idle freedoms are held: balls as two turns, columns at zero, and how many spins otherwise.

        Balls are joints counted from 0; their third turns are among the columns.
        """
        letters = expanded(self._linkage)[0]
        first = np.concatenate([[0], np.cumsum([3 if letter == "S" else 1 for letter in letters])])
        spun, columns, spins = set(), [], 0
        for (word, held, _), (_, _, joint, _) in zip(self._core.idle, self._idle(), strict=True):
            if word == "between-balls":
                spun.add(joint)
                columns.append(int(first[held]) + 2)
            elif word == "chain-between-balls":
                spins += 1
            else:
                columns.append(int(first[held]))
        return frozenset(spun), columns, spins

    def idle_links(self) -> frozenset[int]:
        """The links that have such a freedom, counted from 1."""
        found: set[int] = set()
        for word, link, held, other in self._idle():
            found |= set(range(held + 1, other + 1)) if word == "chain-between-balls" else {link}
        return frozenset(found)

    def unheld(self) -> str | None:
        """The idle freedom for which the core has no rule, in words, of a loop that one input moves."""
        if self._core.can_be_driven or self._core.freedoms > MOST_FREEDOMS:
            return None
        return self.idle()[-1]

    def _idle(self) -> list[tuple[str, int, int, int]]:
        """Each such freedom: the core's word, the link, and the joints held and beside it."""
        owner = [0] * (max(self._link) + 1)
        for joint, last in enumerate(self._link):
            owner[last] = joint
        for inner in range(len(owner)):
            if inner not in self._link:
                owner[inner] = owner[inner + 1]
        count = len(self._linkage.joints)
        found = []
        for word, held, other in self._core.idle:
            a, b = owner[held], owner[other]
            found.append((word, 1 + (a if (a + 1) % count == b else b), a, b))
        return found

    def modes(self, column: int, value: float) -> Modes:
        """Every assembly mode at one value of a column."""
        found = self._solve(column, self._core.assembly_modes, column, value)
        q, residual, completeness, misfits = found
        return Modes(q, residual * self.size, completeness, self._linkage.columns, value, np.array(misfits))

    def mobility(self, column: int) -> Mobility:
        """How freely the loop moves; poses are looked for over the values of a column."""
        if column not in self._found:
            self._found[column] = self._mobility(self._solve(column, self._core.mobility, column))
        return self._found[column]

    def motion(self, column: int, output: int, samples: int, speed: float, law: Law | None) -> Motion:
        """Every circuit over the whole range of one column."""
        linkage = self._linkage
        table = None if law is None else law.table
        raw = self._solve(column, self._core.motion, column, output, samples, speed, table)
        mobility = self._mobility(raw)
        if law is None:
            self._found[column] = mobility
        if raw["input_rests"] and not raw["circuits"]:
            raise self._rests(column, raw["moving"])
        circuits = tuple(
            self._circuit(i, c, (column, output), speed, law) for i, c in enumerate(raw["circuits"])
        )
        count = _count(raw, linkage.columns)
        change_points = change_points_from(raw["change_points"], column)
        limits = [d.input for c in circuits for d in c.dead_centres if d.kind == "input"]
        return Motion(
            linkage=linkage,
            input=linkage.columns[column],
            output=linkage.columns[output],
            speed=math.nan if law is not None else speed,
            samples=samples,
            motion_type=_motion_type(circuits, change_points, mobility),
            limits=merged(limits, turns=linkage.column_kinds[column] == "turn", size=self.size),
            change_points=change_points,
            circuits=circuits,
            completeness=_completeness(raw, count),
            redundant=mobility.redundant,
            established=_established(raw, linkage.columns, count),
            misfits=np.array(raw["misfits"]),
            law=law,
            count=count,
        )

    def circuit(
        self, pose: Floats, column: int, output: int, samples: int, speed: float, law: Law | None
    ) -> Circuit:
        """The one circuit through a pose (columns,)."""
        table = None if law is None else law.table
        raw = self._solve(column, self._core.circuit_through, pose, column, output, samples, speed, table)
        if "apart" in raw:
            raise RequestError(
                f"pose: the loop does not close near it (closure error {raw['apart'] * self.size:.3g} "
                f"{self._linkage.length_unit}); give a row of assembly_modes() or of a circuit"
            )
        if "still" in raw:
            raise RequestError("pose: no motion through it could be followed; see mobility()")
        if "moving" in raw:
            raise self._rests(column, raw["moving"])
        return self._circuit(0, raw, (column, output), speed, law)

    def _rests(self, column: int, moving: list[int]) -> RequestError:
        linkage = self._linkage
        moving_names = {linkage.columns[c] for c in moving}
        others = [name for name in linkage.drivable(column) if name in moving_names]
        advice = f"; give another: {', '.join(others)}" if others else ""
        return RequestError(
            f"input: joint '{linkage.columns[column]}' stands still while others move, so it cannot "
            f"drive{advice}"
        )

    def _solve(self, column: int, call: Any, *arguments: Any) -> Any:
        try:
            return call(*arguments)
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

    def _mobility(self, raw: Mapping[str, Any]) -> Mobility:
        linkage = self._linkage
        freedoms = len(linkage.columns)
        rank = raw.get("rank")
        idle = self.idle()
        finite = raw.get("finite") if rank is not None else None
        if rank is None and not self._core.can_be_driven:
            # rank six at most
            finite = self._core.freedoms - 6
        return Mobility(
            freedoms=freedoms,
            gruebler=freedoms - 6,
            rank=rank,
            idle=idle,
            redundant=redundant_constraints(np.array(raw.get("wrenches", [])).reshape(-1, 6), linkage.base),
            finite=finite,
        )

    def _circuit(
        self, index: int, raw: Mapping[str, Any], columns: tuple[int, int], speed: float, law: Law | None
    ) -> Circuit:
        order = np.arange(len(raw["status"]))
        kinds = self._linkage.column_kinds
        turns_back = any(kind == "input" for kind, *_ in raw["dead_centres"])
        if speed < 0 and law is None and raw["turns"] and not turns_back:
            order = np.append(order[:1], order[:0:-1])
            raw = _run_backwards(raw, order, kinds)
        q = raw["joints"][0]
        status = status_words(raw["status"])
        # the pose of a row may be known where a ball's turns are not
        undefined = np.isnan(q).any(axis=1)
        if undefined.any():
            status[(status == "ok") & undefined] = "turns-undefined"
        words = [
            word(kinds[column], rocks=span is not None, endless=is_endless(raw, span))
            for column, span in zip(columns, (raw["input"], raw["output"]), strict=True)
        ]
        return circuit_from(
            raw,
            linkage=self._linkage,
            index=index,
            columns=columns,
            speed=speed,
            law=law,
            size=self.size,
            motion_type="change-point" if raw["singular"] else pair(*words),
            closed=raw["closed"],
            status=status,
            mode=np.full(len(q), index),
            transmission=None,
            _point=partial(self._trace, raw["rows"], order, status),
            _sensitivity=partial(sensitivity_of, self._linkage),
        )

    def _trace(self, rows: _core.Rows, order: Integers, status: Words, link: int, at: Floats) -> Trace:
        """A point, `at` in its link's own frame, along rows in an order and of a status."""
        count = len(self._linkage.joints)
        if link == count:
            position = np.broadcast_to(at, (len(status), 3)).copy()
            position[status == "no-solution"] = np.nan
            rest = np.where(np.isnan(position), np.nan, 0.0)
            rest[status == "dead-centre"] = np.nan
            velocity, acceleration, jerk = rest, rest.copy(), rest.copy()
        else:
            position, velocity, acceleration, jerk = (
                np.asarray(part)[order] for part in self._core.point(rows, self._link[link - 1], at)
            )
        own = np.array(status)
        own[own == "turns-undefined"] = "ok"
        return Trace(position, velocity, acceleration, jerk, own)


def _run_backwards(raw: Mapping[str, Any], order: Integers, kinds: Sequence[Freedom]) -> Mapping[str, Any]:
    """A circuit that goes round as the core walked it, with rising input, in the order of a falling one."""
    joints = np.array(raw["joints"])
    q = joints[0]
    # what the joints have turned when the circuit closes, which falls when it is run the other way
    ahead = 2 * q[-1] - q[-2] - q[0]
    gained = np.where([kind == "turn" for kind in kinds], np.round(ahead / math.tau) * math.tau, 0.0)
    joints = joints[:, order]
    joints[0, 1:] -= gained
    rows = {name: np.asarray(raw[name])[order] for name in ("status", "branch", "residual", "condition")}
    return {**raw, **rows, "joints": joints}


def expanded(linkage: Linkage) -> tuple[str, list[float], list[Floats], list[int]]:
    """The joints as the core takes them: letters, advances for a radian, links, and where each link went."""
    letters, advances, links, last = "", [], [], []
    still = np.eye(4)
    for i, joint in enumerate(linkage.joints):
        if joint.kind == "C":
            letters += "RP"
            advances += [0.0, 0.0]
            links.append(still)
        elif joint.kind == "U":
            letters += "RR"
            advances += [0.0, 0.0]
            cosine, sine = math.cos(joint.angle), math.sin(joint.angle)
            links.append(
                np.array([[1, 0, 0, 0], [0, cosine, -sine, 0], [0, sine, cosine, 0], [0, 0, 0, 1.0]])
            )
        else:
            letters += joint.kind
            advances.append(joint.pitch / math.tau)
        last.append(len(letters) - 1)
        if i < len(linkage.links):
            links.append(np.array(linkage.links[i]))
    return letters, advances, links, last


def is_endless(circuit: Mapping[str, Any], span: tuple[float, float] | None) -> bool:
    """Whether a turn with this range goes on without end: over more than a turn, and nothing comes back.

    Such a circuit has no end of its own, but is followed to where a screw or a slide is far out.
    """
    open_ended = not circuit["closed"] and not circuit["singular"]
    return open_ended and span is not None and span[1] - span[0] > math.tau


def word(kind: str, *, rocks: bool, endless: bool = False) -> str:
    """What a joint of a kind is called that rocks, turns fully, or turns on without the loop coming back."""
    if kind == "slide":
        return "slider"
    if endless:
        return "spindle"
    return "rocker" if rocks else "crank"


def pair(first: str, second: str) -> str:
    """The motion type of an input and an output by what each is called."""
    return f"double-{first}" if first == second else f"{first}-{second}"


def words_of(motion_type: str) -> tuple[str, str]:
    """What input and output are called, read off the motion type of a circuit.

    >>> words_of("double-spindle"), words_of("spindle-slider"), words_of("change-point")
    (('spindle', 'spindle'), ('spindle', 'slider'), ('change', 'point'))
    """
    first, _, second = motion_type.partition("-")
    return (second, second) if first == "double" else (first, second)


def _motion_type(
    circuits: Sequence[Circuit], change_points: Sequence[ChangePoint], mobility: Mobility
) -> str:
    if any(not point.isolated and point.circuits for point in change_points):
        return "change-point"
    if circuits:
        types = {c.motion_type for c in circuits}
        return types.pop() if len(types) == 1 else "mixed"
    if mobility.finite is not None and mobility.finite > 1:
        return "two-inputs"
    return "cannot-assemble" if mobility.rank is None else "rigid"


def _count(raw: Mapping[str, Any], columns: Sequence[str]) -> Count | None:
    if "count" not in raw:
        return None
    column, real, complex_points, poles, ranges = raw["count"]
    open_ranges = tuple(OpenRange(*each) for each in ranges)
    return Count(columns[column], real, complex_points, poles, open_ranges)


def _completeness(raw: Mapping[str, Any], count: Count | None) -> Literal["counted", "algebraic", "searched"]:
    if raw["completeness"] != "algebraic":
        return "searched"
    return "counted" if count is not None and not count.open else "algebraic"


#: Why circuits were not counted, by the core's word; a search says so itself.
UNCOUNTED = {
    "lost": "circuits are not counted, since a solution over the complex numbers was lost on the way",
    "still": "circuits are not counted, since there may be motions with the joint at rest",
}


def _counted(raw: Mapping[str, Any], count: Count | None) -> str:
    """What the count of branch points tells; empty where nothing was counted."""
    if count is None:
        return UNCOUNTED.get(raw.get("uncounted", ""), "")
    if not count.open:
        others = f" and {count.complex_branch_points} complex" if count.complex_branch_points else ""
        many = f"{count.dead_centres or 'no'} dead centre{'s' * (count.dead_centres > 1)}"
        return f"branch points of {count.joint} are all accounted for: {many}{others}"
    told = []
    for each in count.open[:MOST_RANGES_TOLD]:
        what = "some" if each.missing is None else f"{each.missing}"
        start, wide = math.degrees(each.start), math.degrees(each.end - each.start)
        if wide < NARROW_RANGE_DEG:
            told.append(f"{what} within {wide / 2:.1g} deg of {(start + wide / 2) % 360:.6g} deg")
        else:
            told.append(f"{what} between {start % 360:.6g} and {start % 360 + wide:.6g} deg")
    more = " and elsewhere" if len(count.open) > MOST_RANGES_TOLD else ""
    return f"branch points of {count.joint} are not all accounted for: {', '.join(told)}{more}"


#: Ranges that do not balance told in one sentence.
MOST_RANGES_TOLD = 4

#: A range narrower than this [deg] is given by its middle, as one about a change point.
NARROW_RANGE_DEG = 0.01


def _established(raw: Mapping[str, Any], columns: Sequence[str], count: Count | None) -> str:
    if not raw["seeds"]:
        return "from the drawn pose only"
    how = {
        "algebraic": "all modes over the complex numbers",
        "searched": "modes by search from many starts, screws within one turn to each side",
    }[raw["completeness"]]
    joints = " and of ".join(columns[c] for c in raw["seed_columns"]) or "a turn of a ball"
    text = f"{how} at {raw['seeds']} values of {joints}; "
    if raw.get("rank") is None:
        text += "there are none"
    elif raw["circuits"]:
        text += "each lies on a circuit"
        if raw["still"]:
            text += f", but {raw['still']} from which no motion could be followed"
        if free := sum(freedoms > 1 for *_, freedoms in raw["change_points"]):
            text += "; motions with more than one freedom, not followed, "
            text += f"begin in {free} of the change points"
    elif raw["finite"] > 1:
        text += f"the loop moves out of them with {raw['finite']} freedoms"
    else:
        text += "no motion leads out of them"
    if told := _counted(raw, count):
        text += f"; {told}"
    if raw["misfits"]:
        text += f"; {left_open(raw['misfits'])}"
    return text


def left_open(misfits: Sequence[float] | Floats) -> str:
    """How many poses redundant constraints alone keep open, and by how much; of one or more, rising."""
    count = len(misfits)
    return (
        f"{count} more pose{'s close' if count > 1 else ' closes'} but for redundant constraints, which miss "
        f"by {misfits[0]:.1e} to {misfits[-1]:.1e} (rad, or parts of the size) and are taken to agree up to "
        f"{_core.AGREE:.0e}"
    )


def size_of(linkage: Linkage) -> float:
    """The size [length] of a loop, as the core has it: all links' lengths, and pitches by radian."""
    lengths = float(np.linalg.norm(linkage.transforms[:, :3, 3], axis=1).sum())
    return lengths + sum(abs(joint.pitch) / math.tau for joint in linkage.joints) or 1.0


def merged(limits: npt.ArrayLike, *, turns: bool, size: float) -> Floats:
    """Limits of all circuits [rad in [0, 2 pi), or length], rising, equal ones once.

    `size` [length] is that of the loop, by which a slide tells what is equal.
    """
    values: Floats = np.asarray(limits, dtype=np.float64)
    same = SAME_LIMIT if turns else SAME_LIMIT * size
    if turns:
        values = np.mod(values, math.tau)
        values[values > math.tau - ROUNDING] = 0.0
    values = np.sort(values)
    if values.size == 0:
        return np.array([])
    kept: Floats = values[np.concatenate([[True], np.diff(values) > same])]
    if turns and kept.size > 1 and kept[0] + math.tau - kept[-1] < same:
        kept = kept[:-1]
    return kept
