"""The dimensions of a real linkage from its measured curve: least squares with exact sensitivities.

With r the differences of measured and computed values relative to their noise and J their exact derivatives
by the dimensions (`sevenbar.kinematics.sensitivity`), `|r|^2` is least by scipy's trust-region steps; then

    s^2 = |r|^2 / (n - k),      covariance s^2 (J^T J)^-1,      value +- t(n - k) sqrt(covariance)         (1)

with Student's t. Where several quantities were measured, the noise of each is taken from its differences.

What data cannot tell is held, not guessed. A direction v in the space of the dimensions (J v = 0 to rounding,
or so small that the standard error along v exceeds `UNTOLD` of the linkage's size) changes the curve by
nothing that could be seen: of an RSSR measured by its angles, making all lengths twice as long. For each such
direction one dimension stays at its nominal value, and the report names it and those that undo its change;
intervals of the others then hold for that value. A dimension whose change alone would open an overconstrained
loop is held too.

Source: docs/theory_design.md, (10) and (11).
"""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import MissingExtraError, NotCoveredError, RequestError, shown, suggestion
from sevenbar.kinematics.circuits import Law
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.sensitivity import Numbers, Slopes
from sevenbar.measuring.compare import Comparison, compare, ends_of, inputs_of
from sevenbar.measuring.measured import OUTPUTS, Ends, Measured
from sevenbar.text.printing import Printed

#: Zeros of the measured joints that may be free too: linkage input = measured input + input_offset,
#: measured output = linkage output + output_offset.
OFFSETS = ("input", "output")

#: The order in which dimensions of a row are held where the data do not tell them all.
ROW_ORDER = ("length", "twist", "angle", "offset", "pitch")

#: Standard error [share of the linkage's size, or rad] beyond which a direction counts as not told: the curve
#: bends over such a distance, so that (1), which takes it for straight, would mean nothing.
UNTOLD = 0.03

#: Singular value, relative to the greatest, that is zero up to rounding.
ROUNDING = 1e-9

#: A share in a direction below which a dimension does not take part in it.
TAKES_PART = 1e-2

#: Correlation of neighbouring residuals, in standard deviations of that of random ones, that is told of.
FOLLOWS = 4.0

#: How often the choice of what is held, or the noise of each quantity, is checked again.
MOST_ROUNDS = 8

Status = Literal["calibrated", "fixed", "untold", "opens the loop"]


@dataclass(frozen=True)
class Parameter:
    """A dimension or an offset: nominal and calibrated value [length, rad], and how well it is known.

    `error` is its standard error, `low` and `high` the ends of its interval; NaN where it was not calibrated.
    `undone_by` names the dimensions whose changes undo one of an `untold` dimension.
    """

    name: str
    kind: str
    status: Status
    nominal: float
    value: float
    error: float = math.nan
    low: float = math.nan
    high: float = math.nan
    undone_by: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Printed):
    """What a measured curve tells of a linkage's dimensions.

    Arrays (n,) hold the rows that were used: `input` [rad, or length] as calibrated, `measured` as in the
    file, `computed` with the calibrated and `nominal` with the nominal dimensions, both with the offset of
    the output. `noise` is the standard deviation of each quantity's differences, `covariance` (k, k) that of
    the calibrated parameters in their order.
    """

    linkage: Linkage
    ends: Ends
    source: str
    before: Comparison
    parameters: tuple[Parameter, ...]
    covariance: Floats
    confidence: float
    freedom: int
    noise: Mapping[str, float]
    line: npt.NDArray[np.int64]
    input: Floats
    measured: Mapping[str, Floats]
    computed: Mapping[str, Floats]
    nominal: Mapping[str, Floats]
    evaluations: int
    notes: tuple[str, ...]

    @property
    def outputs(self) -> tuple[str, ...]:
        """The quantities that were measured."""
        return tuple(self.measured)

    def parameter(self, name: str) -> Parameter:
        """The parameter of a name; `KeyError` where there is none."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)

    @property
    def calibrated(self) -> tuple[Parameter, ...]:
        """The parameters that the data tell."""
        return tuple(p for p in self.parameters if p.status == "calibrated")


def calibrate(
    linkage: Linkage,
    measured: Measured,
    ends: Ends | None = None,
    *,
    free: Sequence[str] = ("*",),
    hold: Sequence[str] = (),
    offsets: Sequence[str] = (),
    speed: float | str | None = None,
    start: float = 0.0,
    circuit: int | None = None,
    branch: int | None = None,
    confidence: float = 0.95,
) -> Calibration:
    """The dimensions that explain measured rows best, with their intervals.

    `free` names the dimensions to be found and `hold` those to be kept, by names or patterns ("length_*"):
    M, N, L1, L2, L3, D of an RSSR, length_1, offset_1, twist_1 .. of Denavit-Hartenberg rows, coordinates of
    joints and axes as drawn. `offsets` of "input" and "output" frees the zeros of the two measured joints.
    The others are as for `compare`. Raises `RequestError` for a wrong argument, too few rows and a linkage
    made without a description, `NotCoveredError` for an output that spins idly, `MissingExtraError` without
    scipy.

        >>> import sevenbar as sb
        >>> real = sb.rssr(M=700, N=700, L1=251, L3=550, D=0, L2=998)
        >>> inputs = np.linspace(0.0, 6.0, 50)
        >>> measured = Measured(
        ...     "by hand", np.arange(50), {"input": inputs, "angle": real.output(inputs).position[0]}
        ... )
        >>> found = calibrate(sb.load("rssr"), measured, free=["L1", "L2"])
        >>> [(p.name, round(p.value, 6)) for p in found.calibrated]
        [('L1', 251.0), ('L2', 998.0)]
    """
    _need_scipy()
    if not 0 < confidence < 1:
        raise RequestError(f"confidence: {shown(confidence)} is not a probability; give one like 0.95")
    for word in offsets:
        if word not in OFFSETS:
            raise RequestError(f"offset: {shown(word)} is not offered; give {' or '.join(OFFSETS)}")
    ends = ends_of(linkage) if ends is None else ends
    numbers = Numbers(linkage)
    align = [word for word, side in (("phase", "input"), ("offset", "output")) if side in offsets]
    before = compare(
        linkage, measured, ends, align=align, speed=speed, start=start, circuit=circuit, branch=branch
    )
    model = _Model(numbers, before, inputs_of(measured, before.speed, start), offsets)
    wanted = model.chosen(free, hold)
    fit = _Fit(model, wanted)
    untold = fit.run()
    return _told(linkage, measured, before, model, fit, untold, confidence)


def _in_order(numbers: Numbers) -> list[int]:
    """The numbers that move joints, not points alone, in the order in which they are held."""

    def order(k: int) -> tuple[int, int]:
        place = numbers.dimensions[k].place
        row = place[0] == "link" and isinstance(place[1], int)
        return (int(place[1]), ROW_ORDER.index(str(place[2]))) if row else (0, k)

    moving = [k for k, d in enumerate(numbers.dimensions) if d.place[0] != "point"]
    return sorted(moving, key=order)


def _need_scipy() -> None:
    try:
        import scipy.optimize
        import scipy.stats  # noqa: F401
    except ImportError:
        raise MissingExtraError(
            "calibrate needs scipy and tomlkit; install them with: pip install 'sevenbar[calibrate]'"
        ) from None


class _Model:
    """The measured quantities as functions of all parameters, in units of the linkage's size and radians."""

    def __init__(self, numbers: Numbers, before: Comparison, inputs: Floats, offsets: Sequence[str]) -> None:
        chosen, ends = before.chosen, before.ends
        self.before, self.offsets = before, tuple(offsets)
        self.slides = ends.output_slides
        self.speed = before.speed
        count = len(inputs)
        begin = inputs + chosen.phase + math.tau * chosen.turn
        law = Law.of(np.arange(float(count)), begin, 1.0, 0.0)
        motion = before.linkage.motion(input=ends.input, output=ends.output, law=law)
        part = slice(chosen.branch * count, (chosen.branch + 1) * count)
        circuit = motion.circuits[chosen.circuit]
        self.places = _in_order(numbers)
        self.output = circuit.output_column
        loop = numbers.loop(circuit.input_column, only=self.places)
        q = circuit.q[part]
        # rates do not exist at a dead centre of the input, nor do sensitivities
        self.rows = np.flatnonzero((circuit.status[part] != "dead-centre") & np.isfinite(q).all(axis=1))
        self.begin = q[self.rows, loop.input] - chosen.phase
        poses = numbers.poses(q[self.rows])
        self.values = {q: before.measured[q][self.rows].copy() for q in before.outputs}
        if "angle" in self.values:
            self.values["angle"] += chosen.offset
        self.order = max(OUTPUTS.index(q) for q in self.values)
        dimensions = [numbers.dimensions[k] for k in self.places]
        self.names = [d.name for d in dimensions] + ["input_offset", "output_offset"]
        self.kinds: list[str] = [d.kind for d in dimensions]
        self.kinds += ["length" if slides else "angle" for slides in (ends.input_slides, ends.output_slides)]
        #: The size of one of the file's units, angles being in radians here.
        self.units = np.array([d.scale for d in dimensions])
        self.nominal = np.append(numbers.nominal[self.places] * self.units, [0.0, 0.0])
        lengths = [kind in ("length", "pitch") for kind in self.kinds]
        size = float(np.abs(self.nominal[lengths]).max(initial=0.0)) or 1.0
        self.scales = np.where(lengths, size, 1.0)
        self.first = self.nominal + np.array([0.0] * len(dimensions) + [chosen.phase, chosen.offset])
        self._last: tuple[bytes, tuple[Floats, Slopes] | None] = (b"", None)
        here = loop.slopes(poses, 0)
        self._known = (loop, poses, here)
        if here.idle[self.output]:
            raise NotCoveredError(
                f"calibrate: {ends.output} takes part in an idle motion, which the input does not tell; give "
                "another output"
            )
        self.opening = frozenset(n for n, opens in zip(self.names, here.opening, strict=False) if opens)

    def chosen(self, free: Sequence[str], hold: Sequence[str]) -> list[int]:
        """The places of the parameters that are to be found."""
        dimensions = self.names[:-2]
        for option, patterns in (("free", free), ("hold", hold)):
            for pattern in patterns:
                if not fnmatch.filter(dimensions, pattern):
                    raise RequestError(
                        f"{option}: no dimension {shown(pattern)}; {suggestion(pattern, dimensions)}"
                        f"this linkage has {', '.join(dimensions)}"
                    )
        named = [
            name
            for name in dimensions
            if any(fnmatch.fnmatchcase(name, pattern) for pattern in free)
            and not any(fnmatch.fnmatchcase(name, pattern) for pattern in hold)
        ]
        named += [f"{side}_offset" for side in OFFSETS if side in self.offsets]
        if not named:
            raise RequestError("free: nothing is left to be found; free a dimension or an offset")
        return [self.names.index(name) for name in named if name not in self.opening]

    def response(self, z: Floats) -> tuple[Floats, Slopes] | None:
        """Poses and derivatives at parameters z; `None` where a row does not close on its pass."""
        key = z.tobytes()
        if self._last[0] == key:
            return self._last[1]
        loop, poses, here = self._known
        p = loop.p.copy()
        p[self.places] = z[:-2] / self.units
        x = self.begin + z[-2]
        ahead = np.einsum("nkc,k->nc", here.by_number[:, 0], (p - loop.p)[self.places])
        ahead += here.by_input[:, 0] * (x - poses[:, loop.input])[:, None]
        there = loop.numbers.loop(loop.input, p, self.places)
        near = there.followed(x, poses, steps=ahead[None])[0][0]
        if not np.isfinite(near).all():
            near = loop.closed(x, poses, p)
        found = None
        if np.isfinite(near).all():
            found = near, there.slopes(near, self.order)
            self._known = (there, *found)
        self._last = (key, found)
        return found

    def computed(self, z: Floats) -> dict[str, Floats] | None:
        """Each measured quantity as computed, an angle within half a turn of the measured one."""
        found = self.response(z)
        if found is None:
            return None
        poses, here = found
        values = {}
        for quantity, measured in self.values.items():
            order = OUTPUTS.index(quantity)
            value = poses if order == 0 else here.rates[:, order - 1] * self.speed**order
            value = value[:, self.output]
            if quantity == "angle":
                value = value + z[-1]
                if not self.slides:
                    value = value + math.tau * np.round((measured - value) / math.tau)
            values[quantity] = value
        return values

    def slopes(self, z: Floats) -> dict[str, Floats]:
        """The derivatives (n, parameters) of each measured quantity, by parameters in their scales."""
        found = self.response(z)
        if found is None:
            raise ArithmeticError("derivatives were asked for where the loop does not close")
        here = found[1]
        slopes = {}
        for quantity in self.values:
            order = OUTPUTS.index(quantity)
            aside = np.full(len(self.begin), float(quantity == "angle"))
            by_number = here.by_number[:, order, :, self.output] / self.units
            rates = [by_number, here.by_input[:, order, self.output, None]]
            matrix = np.column_stack([*(r * self.speed**order for r in rates), aside])
            slopes[quantity] = matrix * self.scales
        return slopes


class _Fit:
    """Least squares over the parameters that the data tell, and the choice of these."""

    def __init__(self, model: _Model, wanted: list[int]) -> None:
        self.model, self.wanted = model, wanted
        self.z = model.first.copy()
        self.noise = {q: float(np.ptp(v)) or 1.0 for q, v in model.values.items()}
        self.evaluations = 0
        self.held: list[int] = []

    @property
    def free(self) -> list[int]:
        return [k for k in self.wanted if k not in self.held]

    @property
    def count(self) -> int:
        return len(self.model.begin) * len(self.model.values)

    def residual(self, z: Floats) -> Floats:
        """Computed less measured relative to the noise; NaN where the loop does not close."""
        computed = self.model.computed(z)
        if computed is None:
            return np.full(self.count, np.nan)
        values = self.model.values
        return np.concatenate([(computed[q] - values[q]) / self.noise[q] for q in values])

    def jacobian(self, columns: Sequence[int]) -> Floats:
        """Derivatives (n, columns) of the residual at the present parameters."""
        slopes = self.model.slopes(self.z)
        return np.concatenate([slopes[q][:, columns] / self.noise[q] for q in slopes])

    def run(self) -> dict[int, tuple[int, ...]]:
        """Finds the parameters; gives what is held as the data do not tell it, and what undoes each."""
        untold = self._untold(0.0)
        for turn in range(MOST_ROUNDS):
            self.held = list(untold)
            self._weigh()
            again = self._untold(self._deviation())
            if turn >= MOST_ROUNDS // 2:
                # a choice that would come and go stays
                again = {k: again.get(k, untold.get(k, ())) for k in [*untold, *again]}
            if set(again) == set(untold):
                return again
            untold = again
        return untold

    def _weigh(self) -> None:
        """Least squares, the noise of each quantity being taken from its own differences."""
        self.z = self.model.first.copy()
        for _ in range(MOST_ROUNDS):
            self._least_squares()
            if len(self.noise) == 1:
                return
            parts = np.split(self.residual(self.z), len(self.noise))
            share = math.sqrt(1 - len(self.free) / self.count)
            floor = 1e-12
            factors = [max(math.sqrt(float(np.mean(part**2))) / share, floor) for part in parts]
            self.noise = {
                q: noise * factor for (q, noise), factor in zip(self.noise.items(), factors, strict=True)
            }
            if max(abs(math.log(factor)) for factor in factors) < 1e-3:
                return

    def _least_squares(self) -> None:
        from scipy.optimize import least_squares

        free, scales = self.free, self.model.scales
        if self.count <= len(free):
            raise RequestError(
                f"{self.model.before.source}: {self.count} measured values cannot tell {len(free)} "
                "dimensions; measure more rows, or free fewer with --free or --hold"
            )
        if not free:
            return

        def spread(part: Floats) -> Floats:
            z: Floats = self.z.copy()
            z[free] = part * scales[free]
            return z

        def errors(part: Floats) -> Floats:
            return self.residual(spread(part))

        def slopes(part: Floats) -> Floats:
            z = spread(part)
            found = self.model.slopes(z)
            return np.concatenate([found[q][:, free] / self.noise[q] for q in found])

        result: Any = least_squares(
            errors,
            self.z[free] / scales[free],
            jac=slopes,
            method="trf",
            ftol=1e-14,
            xtol=1e-14,
            gtol=1e-14,
            max_nfev=200,
        )
        self.evaluations += int(result.nfev)
        self.z = spread(result.x)

    def _deviation(self) -> float:
        """The standard deviation s of the residual, of parts of the noise."""
        residual = self.residual(self.z)
        return math.sqrt(float(residual @ residual) / max(self.count - len(self.free), 1))

    def _untold(self, deviation: float) -> dict[int, tuple[int, ...]]:
        """What the data cannot tell, given the residual's deviation, and what undoes a change of each."""
        triangle = np.linalg.qr(self.jacobian(self.wanted), mode="r")
        _, values, rows = np.linalg.svd(triangle, full_matrices=True)
        values = np.concatenate([values, np.zeros(len(self.wanted) - len(values))])
        blind = (values <= ROUNDING * values.max(initial=0.0)) | (deviation > UNTOLD * values)
        directions = rows[blind].T
        held: list[int] = []
        left = directions.copy()
        for _ in range(directions.shape[1]):
            shares = np.linalg.norm(left, axis=1)
            # zeros of the test bench are guesses, dimensions come from a drawing and stay
            worth = shares * np.array([0.1 if self.wanted[k] >= len(self.model.names) - 2 else 1.0
                                       for k in range(len(shares))])  # fmt: skip
            place = next(k for k, w in enumerate(worth) if w >= 0.5 * worth.max())
            held.append(place)
            along = left[place] / np.linalg.norm(left[place])
            left = left - np.outer(left @ along, along)
        if not held:
            return {}
        own = directions @ np.linalg.inv(directions[held])
        found = {}
        for column, place in enumerate(held):
            shares = np.abs(own[:, column])
            others = [k for k in range(len(shares)) if k != place and shares[k] > TAKES_PART * shares.max()]
            found[self.wanted[place]] = tuple(self.wanted[k] for k in others)
        return dict(sorted(found.items()))


def _told(
    linkage: Linkage,
    measured: Measured,
    before: Comparison,
    model: _Model,
    fit: _Fit,
    untold: Mapping[int, tuple[int, ...]],
    confidence: float,
) -> Calibration:
    """The calibration that a finished fit comes to."""
    from scipy.stats import t

    free, scales = fit.free, model.scales
    freedom = fit.count - len(free)
    deviation = fit._deviation()
    jacobian = fit.jacobian(free)
    _, values, rows = np.linalg.svd(jacobian, full_matrices=False)
    root = rows.T / values if len(free) else np.zeros((0, 0))
    covariance = deviation**2 * (root @ root.T) * np.outer(scales[free], scales[free])
    reach = float(t.ppf(0.5 + confidence / 2, freedom))
    parameters = []
    for k, (name, kind) in enumerate(zip(model.names, model.kinds, strict=True)):
        nominal, value = float(model.nominal[k]), float(fit.z[k])
        if k in free:
            error = math.sqrt(covariance[free.index(k), free.index(k)])
            ends = value - reach * error, value + reach * error
            parameters.append(Parameter(name, kind, "calibrated", nominal, value, error, *ends))
        elif k in untold:
            undone = tuple(model.names[other] for other in untold[k])
            parameters.append(Parameter(name, kind, "untold", nominal, value, undone_by=undone))
        elif name in model.opening:
            parameters.append(Parameter(name, kind, "opens the loop", nominal, value))
        elif k < len(model.names) - 2:
            parameters.append(Parameter(name, kind, "fixed", nominal, value))
    computed, at_nominal = model.computed(fit.z), model.computed(model.first)
    if computed is None or at_nominal is None:
        raise ArithmeticError("the poses of a finished calibration were lost")
    return Calibration(
        linkage=linkage,
        ends=before.ends,
        source=before.source,
        before=before,
        parameters=tuple(parameters),
        covariance=covariance,
        confidence=confidence,
        freedom=freedom,
        noise={q: noise * deviation for q, noise in fit.noise.items()},
        line=measured.line[model.rows],
        input=model.begin + fit.z[-2],
        measured=model.values,
        computed=computed,
        nominal=at_nominal,
        evaluations=fit.evaluations,
        notes=_notes(before, model, fit, computed),
    )


def _notes(before: Comparison, model: _Model, fit: _Fit, computed: Mapping[str, Floats]) -> tuple[str, ...]:
    notes = [note for note in before.notes if "left out" not in note]
    lost = len(before.line) - len(model.rows)
    if lost:
        notes.append(
            f"{lost} of {len(before.line)} rows have inputs at which the nominal linkage does not close, or "
            "stands at a dead centre; they are left out"
        )
    for quantity, measured in model.values.items():
        residual = measured - computed[quantity]
        residual = residual - residual.mean()
        power = float(residual @ residual)
        if power <= 0 or len(residual) < 20:
            continue
        follows = float(residual[1:] @ residual[:-1]) / power
        if follows > FOLLOWS / math.sqrt(len(residual)):
            notes.append(
                f"neighbouring differences of the {quantity} follow each other (correlation {follows:.2f}): "
                "what is left is not random, so something beside these dimensions is at work and the "
                "intervals are too narrow"
            )
    if len(model.values) > 1:
        notes.append(
            "the intervals take the noise of angle, velocity and acceleration for independent; where one was "
            "computed from another they are too narrow"
        )
    if not fit.free:
        notes.append("the data tell none of the dimensions that were to be found")
    return tuple(notes)
