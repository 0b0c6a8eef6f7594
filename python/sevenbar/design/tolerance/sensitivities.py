"""Exact derivatives of all outputs of a circuit by all numbers of the linkage's description."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Booleans, Floats, Integers, Words, short_way
from sevenbar.description.draft import Draft
from sevenbar.design.tolerance.outputs import Output, outputs_of, slopes_of, values_of
from sevenbar.design.tolerance.tolerances import Tolerances, tolerances
from sevenbar.errors import NotCoveredError, RequestError, check_word, shown, suggestion
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable, chosen_circuit
from sevenbar.kinematics.dynamics.force_measures import force_slopes
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.numbers.dimensions import Dimension, Following
from sevenbar.kinematics.numbers.gradients import QUANTITIES, MeasureSlopes, measure_slopes
from sevenbar.kinematics.numbers.sensitivity import NumberedLoop, Numbers
from sevenbar.kinematics.ranges.extent_slopes import extent_slopes
from sevenbar.kinematics.transmission.slopes import transmission_slopes
from sevenbar.text.printing import Printed, lines, text_of

#: A change that counts as small where no tolerance is given [share of the linkage's size, rad].
SMALL = 1e-3

#: How far a row must be from a dead centre of the input for a linear estimate, relative to what that dead
#: centre may itself be moved by: there the output goes with the root of the distance, and at three such parts
#: the root of what is left, sqrt(1 - 1/3), differs by a tenth from its tangent, 1 - 1/6 .. in its change.
CLEAR = 3.0

#: The quantities of a joint that are estimated.
ESTIMATED = QUANTITIES[:3]

#: The status of a row that is nearer.
NEAR = "near-dead-centre"


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities(Printed):
    """The outputs of a circuit, and their derivatives by all dimensions.

    `values` (rows, outputs) and `slopes` (rows, outputs, dimensions) are in the outputs' units (angles in
    rad), and by the dimensions' units, which are the file's. NaN in rows whose `status` says why, in columns
    of dimensions that open the loop (`opening`), and in outputs of what spins idly. `input` (rows,) [rad, or
    length]; rates are at `speed`. `poses` (n, columns) are those of the `loop` on some `rows` (n,). A coupler
    that is `following` has no derivatives of its own.
    """

    loop: NumberedLoop
    rows: Integers
    poses: Floats
    circuit: Circuit
    input_name: str
    output_name: str
    speed: float
    samples: int
    outputs: tuple[Output, ...]
    status: Words
    values: Floats
    slopes: Floats
    measures: tuple[MeasureSlopes, ...]
    opening: tuple[str, ...]
    draft: Draft
    following: Following | None

    @property
    def linkage(self) -> Solvable:
        """The linkage as it is meant."""
        return self.loop.numbers.linkage

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """The dimensions in the order of the file."""
        return self.loop.numbers.dimensions

    @property
    def input(self) -> Floats:
        """The input of each row [rad, or length]."""
        return self.circuit.input

    def place(self, output: str | None = None, quantity: str = "position") -> int:
        """The place among the outputs of one by its name, or of a quantity of a joint, the output by default.

        Raises `RequestError` for one that does not exist.
        """
        check_word("quantity", quantity, ESTIMATED)
        name = self.output_name if output is None else output
        for k, one in enumerate(self.outputs):
            if name == one.name and quantity in ("position", one.quantity):
                return k
            if one.joint and (name, quantity) == (one.owner, one.quantity):
                return k
        known = [one.name for one in self.outputs]
        raise RequestError(
            f"output: no {shown(name)} with a {quantity}; {suggestion(name, known)}"
            f"give one of {', '.join(known)}"
        )

    def of(self, output: str | None = None, quantity: str = "position") -> Floats:
        """The derivatives (rows, dimensions) of an output."""
        return np.asarray(self.slopes[:, self.place(output, quantity)])

    def measure(self, name: str) -> MeasureSlopes:
        """A measure by its name; `RequestError` where this circuit has none."""
        for one in self.measures:
            if one.name == name:
                return one
        known = [one.name for one in self.measures]
        raise RequestError(
            f"measure: no {shown(name)} of this circuit; {suggestion(name, known)}"
            f"it has {', '.join(known) or 'none'}"
        )

    @property
    def followers(self) -> tuple[str, ...]:
        """The dimensions that follow from others."""
        return () if self.following is None else (self.loop.numbers.names[self.following.own],)

    @property
    def opens(self) -> Booleans:
        """Which dimensions (dimensions,) open the loop."""
        return np.array([name in self.opening for name in self.loop.numbers.names])

    @property
    def input_turns(self) -> bool:
        """Whether the input is an angle, not a slide."""
        return bool(self.loop.numbers.turns[self.loop.input])

    def tolerances(self, given: Mapping[str, float | str]) -> Tolerances:
        """Half widths of the dimensions by name or pattern, as `tolerances` has them."""
        return tolerances(
            self.dimensions,
            given,
            length_unit=self.linkage.length_unit,
            opening=self.opening,
            following=self.followers,
            lengths=[one.name for one in self.draft.lengths],
        )

    def designs(self, changes: Floats) -> Floats:
        """The numbers (.., dimensions) of designs changed by so much, with what follows from them."""
        designs = self.loop.numbers.nominal + changes
        return designs if self.following is None else self.following.whole(designs)

    def changed(self, change: Floats) -> Linkage:
        """The linkage that a file with other numbers describes, by the change (dimensions,) of each."""
        values = dict(zip(self.loop.numbers.names, self.designs(change).tolist(), strict=True))
        return self.draft.with_values(values).linkage

    @property
    def small(self) -> Floats:
        """A change of each dimension that counts as small, in its unit."""
        return np.asarray(SMALL * self.loop.numbers.units)

    def clear(self, reach: Floats) -> Words:
        """The status (rows,) if dimensions may be off by `reach` (dimensions,): also "near-dead-centre"."""
        status = self.status.copy()
        for one in self.measures:
            if not one.name.startswith("limit_"):
                continue
            apart = self.input - one.value * one.scale
            if self.input_turns:
                apart = short_way(apart)
            moves = float(np.nansum(np.abs(one.slopes) * reach)) * one.scale
            status[(status == "ok") & (np.abs(apart) <= CLEAR * moves)] = NEAR
        return status

    def ranking(
        self, output: str | None = None, quantity: str = "position"
    ) -> list[tuple[Dimension, float, float]]:
        """Each dimension, the greatest effect of a small change of it and the input there; greatest first."""
        effects = np.abs(self.of(output, quantity)) * self.small
        effects[self.clear(self.small) != "ok"] = np.nan
        result = []
        for dimension, effect in zip(self.dimensions, effects.T, strict=True):
            if np.isfinite(effect).any():
                row = int(np.nanargmax(effect))
                result.append((dimension, float(effect[row]), float(self.input[row])))
        return sorted(result, key=lambda one: -one[1])


def sensitivities(
    linkage: Linkage,
    *,
    circuit: int = 0,
    samples: int = 90,
    input: str | None = None,
    output: str | None = None,
    speed: float | str | None = None,
    follow: Collection[str] = (),
    lengths: Collection[str] = (),
) -> Sensitivities:
    """Exact derivatives of every output of a circuit by every number of the linkage's description.

    Outputs are each joint's position, velocity and acceleration (the position only of a ball's turns), each
    named point's position and velocity, and the circuit's measures. Numbers are M, N, L1, L2, L3 and D of an
    RSSR; lengths, twists, offsets, angles and pitches of rows; coordinates of joints and axes as drawn; and
    those of points. L2 that a file leaves out is a number of its own, as of a rod that is made; in `follow`
    it follows from the others, and its derivatives are 0. `lengths` of a drawing, by the names that its
    report has, are numbers as its coordinates are. The arguments are those of `Linkage.motion`. Raises
    `RequestError` for a linkage made without a description and for an argument that does not fit.

        >>> import sevenbar as sb
        >>> found = sensitivities(sb.load("rssr"))
        >>> [dimension.name for dimension, _, _ in found.ranking()[:2]]
        ['L2', 'L1']
    """
    draft = Draft.of_linkage(linkage).giving(lengths).holding(follow)
    numbers = Numbers(draft.linkage)
    following = Following.among(numbers.dimensions)
    motion = draft.linkage.motion(samples, input=input, output=output, speed=speed)
    chosen = chosen_circuit(motion, circuit)
    loop = numbers.loop(chosen.input_column)
    rows, poses = loop.poses(chosen)
    here = loop.slopes(poses)
    good = np.isfinite(here.rates[:, 0]).all(axis=1)
    if not good.any():
        raise NotCoveredError("tolerance: no joint follows the input, so there is nothing to estimate")
    rows, poses = rows[good], poses[good]
    here = loop.slopes(poses)
    outputs = outputs_of(numbers, loop.input)
    count = len(chosen.q)
    values = np.full((count, len(outputs)), np.nan)
    slopes = np.full((count, len(outputs), len(numbers.names)), np.nan)
    values[rows] = values_of(outputs, np.where(numbers.is_ball, chosen.q[rows], poses), here, motion.speed)
    slopes[rows] = slopes_of(numbers, outputs, chosen.q[rows], here, motion.speed)
    measures = [
        one for one in measure_slopes(numbers, chosen, motion.speed) if not one.name.startswith("jerk_")
    ]
    measures += transmission_slopes(numbers, chosen)
    measures += force_slopes(numbers, chosen, motion.speed)
    measures += extent_slopes(numbers, chosen)
    if following is not None:
        slopes = following.chained(slopes, numbers.nominal)
        measures = [replace(one, slopes=following.chained(one.slopes, numbers.nominal)) for one in measures]
    slopes[:, :, here.opening] = np.nan
    status = chosen.status.astype("<U20")
    status[~np.isin(np.arange(count), rows) & (status == "ok")] = "dead-centre"
    # where a pose stands but its rates do not exist, so do derivatives not
    slopes[status == "dead-centre"] = np.nan
    result = Sensitivities(
        loop=loop,
        rows=rows,
        poses=poses,
        circuit=chosen,
        input_name=motion.input,
        output_name=motion.output,
        speed=motion.speed,
        samples=motion.samples,
        outputs=outputs,
        status=status,
        values=values,
        slopes=slopes,
        measures=tuple(measures),
        opening=tuple(np.array(numbers.names)[here.opening].tolist()),
        draft=draft,
        following=following,
    )
    if np.isnan(result.of()).all() and not here.opening.all():
        raise RequestError(f"output: {motion.input} does not determine {motion.output}; give another output")
    return result


@text_of.register(Sensitivities)
def _(result: Sensitivities) -> str:
    names = [dimension.name for dimension in result.dimensions]
    greatest = [f"{dimension.name} {effect:.3g}" for dimension, effect, _ in result.ranking()[:3]]
    return lines(
        f"Sensitivities of '{result.linkage.name}', circuit {result.circuit.index}",
        [
            ("slopes", f"{result.slopes.shape}: rows, outputs, dimensions"),
            ("outputs", ", ".join(dict.fromkeys(output.owner for output in result.outputs))),
            ("dimensions", ", ".join(names)),
            ("open the loop", ", ".join(result.opening)),
            ("greatest", f"of a small change on {result.output_name}: {', '.join(greatest)}"),
            ("measures", ", ".join(measure.name for measure in result.measures)),
        ],
    )
