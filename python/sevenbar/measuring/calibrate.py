"""The dimensions of a real linkage from its measured curve: least squares with exact sensitivities.

With r the differences of measured and computed values relative to their noise and J their exact derivatives
by the dimensions (`sevenbar.kinematics.numbers.sensitivity`), `|r|^2` is made least (`least_squares`); then

    s^2 = |r|^2 / (n - k),      covariance s^2 (J^T J)^-1,      value +- t(n - k) sqrt(covariance)         (1)

with Student's t, n being the places that were measured (`fit`). Where several quantities were measured, the
noise of each is taken from its differences.

What data cannot identify is held, not guessed. A direction v in the space of the dimensions (J v = 0 to
rounding, or so small that the standard error along v exceeds `fit.UNIDENTIFIED` of the linkage's size)
changes the curve by nothing that could be seen: of an RSSR measured by its angles, making all lengths twice
as long. For each such direction one dimension stays at its nominal value, and the report names it and those
that undo its change; intervals of the others then hold for that value. A dimension whose change alone would
open an overconstrained loop is held too.

Where no circuit explains the rows, or no minimum is found, there is a `RequestError` with the cause and no
calibration.

Source: docs/theory_design.md, (10) and (11).
"""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.description.draft import Draft
from sevenbar.description.held import HeldDimensions, held_of
from sevenbar.errors import RequestError, check_word, of_extra, shown, suggestion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.measuring.compare import Comparison, causes, compare, ends_of, inputs_of, name_of, per_cent
from sevenbar.measuring.doubtful import EXACT, far_off_notes, left_by_most
from sevenbar.measuring.fit import CurveFit
from sevenbar.measuring.measured import Ends, Measured
from sevenbar.measuring.model import OFFSETS, CurveModel
from sevenbar.measuring.passes import UNEXPLAINED
from sevenbar.text.printing import Printed
from sevenbar.text.progress import Progress, silent

#: Correlation of neighbouring residuals, in standard deviations of that of random ones, that is reported.
FOLLOWS = 4.0

#: `fixed` and `follows` as the caller wants it; `unidentified` is what the data do not identify.
Status = Literal["calibrated", "fixed", "follows", "unidentified", "opens the loop"]


@dataclass(frozen=True)
class Parameter:
    """A dimension or an offset: nominal and calibrated value [length, rad], and how well it is known.

    `error` is its standard error, `low` and `high` the ends of its interval; NaN where it was not
    calibrated, and where the rows are exact.
    `undone_by` names the dimensions whose changes undo one of an `unidentified` dimension.
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
    """What a measured curve shows of a linkage's dimensions.

    Arrays (n,) hold the rows that were used: `input` [rad, or length] as calibrated, `measured` as in the
    file, `computed` with the calibrated and `nominal` with the nominal dimensions, both with the offset of
    the output. `noise` is the standard deviation of each quantity's differences, `covariance` (k, k) that of
    the calibrated parameters in their order. `places` counts the rows without those that repeat an input;
    `exact`: what is left is rounding, and no interval can be made of it. `follow` names what follows others;
    `stretch` counts how often the input has turned back at a limit before a row.
    """

    linkage: Linkage
    ends: Ends
    source: str
    before: Comparison
    parameters: tuple[Parameter, ...]
    covariance: Floats
    confidence: float
    freedom: int
    places: int
    exact: bool
    follow: tuple[str, ...]
    noise: Mapping[str, float]
    line: Integers
    stretch: Integers
    input: Floats
    measured: Mapping[str, Floats]
    computed: Mapping[str, Floats]
    nominal: Mapping[str, Floats]
    evaluations: int
    notes: tuple[str, ...]

    @cached_property
    def held(self) -> HeldDimensions:
        """The dimensions that stay as they were asked to, or follow."""
        moved = {p.name for p in self.parameters if p.status not in ("fixed", "follows")}
        return held_of(Draft.of_linkage(self.linkage).holding(self.follow), moved)

    @property
    def outputs(self) -> tuple[str, ...]:
        """The quantities that were measured."""
        return tuple(self.measured)

    def parameter(self, name: str) -> Parameter:
        """The parameter of a name; `KeyError` where there is none."""
        return {parameter.name: parameter for parameter in self.parameters}[name]

    @property
    def calibrated(self) -> tuple[Parameter, ...]:
        """The parameters that the data identify."""
        return tuple(p for p in self.parameters if p.status == "calibrated")


def calibrate(
    linkage: Linkage,
    measured: Measured,
    ends: Ends | None = None,
    *,
    free: Sequence[str] = ("*",),
    hold: Sequence[str] = (),
    follow: Sequence[str] = (),
    offsets: Sequence[str] = (),
    speed: float | str | None = None,
    start: float = 0.0,
    circuit: int | None = None,
    branch: int | None = None,
    confidence: float = 0.95,
    progress: Progress | None = None,
) -> Calibration:
    """The dimensions that explain measured rows best, with their intervals.

    `free` names the dimensions to be found and `hold` those to be kept, by names or patterns ("length_*"):
    M, N, L1, L2, L3, D of an RSSR, length_1, offset_1, twist_1 .. of Denavit-Hartenberg rows, coordinates of
    joints and axes as drawn. A coupler that the file leaves out is a rod with the length that closes its
    pose, and a dimension like the others; in `follow` it follows from them. `offsets` of "input" and "output"
    frees the zeros of the two measured joints. `progress(evaluations, 0, "residual 0.2 %")` is called on the
    way. The others are as for `compare`.

    Raises `RequestError` for a wrong argument, too few rows, rows that no circuit explains and a linkage made
    without a description, `NotCoveredError` for an output that spins idly, `MissingExtraError` without scipy.

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
    with of_extra("calibrate", "calibrate needs scipy and tomlkit"):
        # its parts take a while to load, and are not needed before the end
        import scipy  # noqa: F401
    if not 0 < confidence < 1:
        raise RequestError(f"confidence: {shown(confidence)} is not a probability; give one like 0.95")
    for word in offsets:
        check_word("offset", word, OFFSETS)
    ends = ends_of(linkage) if ends is None else ends
    linkage = Draft.of_linkage(linkage).giving(free).linkage
    numbers = Numbers(linkage)
    names = _named(numbers, free, hold, follow)
    if follow:
        Draft.of_linkage(linkage).holding(follow)
    _refuse_what_stays(measured, ends)
    seen, evaluations = progress or silent, count(1)
    seen(0, 0, "")
    align = [word for word, side in (("phase", "input"), ("offset", "output")) if side in offsets]
    before = compare(
        linkage, measured, ends, align=align, speed=speed, start=start, circuit=circuit, branch=branch
    )
    if circuit is not None or branch is not None:
        _refuse_wrong_circuit(before, compare(linkage, measured, ends, align=align, speed=speed, start=start))
    model = CurveModel(numbers, before, inputs_of(measured, before.speed, start), {*names, *follow}, follow)
    wanted = [model.names.index(name) for name in names if name not in model.opening]
    wanted += [model.names.index(f"{side}_offset") for side in OFFSETS if side in offsets]
    if not wanted:
        raise RequestError("free: nothing is left to be found; free a dimension or an offset")
    fit = CurveFit(model, wanted, lambda share: seen(next(evaluations), 0, f"residual {per_cent(share)}"))
    unidentified = fit.run()
    _refuse_unexplained(before, fit)
    if fit.unfinished is not None:
        raise fit.unfinished
    return _calibration(measured, fit, unidentified, confidence)


def _named(numbers: Numbers, free: Sequence[str], hold: Sequence[str], follow: Sequence[str]) -> list[str]:
    """The dimensions that are to be found, in the order of the file."""
    dimensions = [d.name for d in numbers.dimensions if d.place[0] != "point"]
    named: dict[str, set[str]] = {}
    for option, patterns in (("free", free), ("hold", hold)):
        matched = {pattern: fnmatch.filter(dimensions, pattern) for pattern in patterns}
        for pattern, result in matched.items():
            if not result:
                raise RequestError(
                    f"{option}: no dimension {shown(pattern)}; {suggestion(pattern, dimensions)}"
                    f"this linkage has {', '.join(dimensions)}"
                )
        named[option] = {name for result in matched.values() for name in result}
    for name in follow:
        for option, patterns in (("free", free), ("hold", hold)):
            if name in patterns:
                raise RequestError(f"follow: {name} is in --{option} too; give it in one of them")
    selected = named["free"] - named["hold"] - set(follow)
    return [name for name in dimensions if name in selected]


def _refuse_what_stays(measured: Measured, ends: Ends) -> None:
    for quantity in measured.outputs:
        values = measured.values[quantity]
        if np.ptp(values) <= EXACT * float(np.abs(values).max()):
            raise RequestError(
                f"{measured.source}: the {ends.word(quantity)} of {ends.output} is the same in all "
                f"{len(measured)} rows: an output that does not move identifies no dimension; check which "
                "joint and which column were measured"
            )


def _refuse_wrong_circuit(before: Comparison, freely: Comparison) -> None:
    """Refuses a circuit or branch that explains nothing where another one does."""
    given, other = before.chosen, freely.chosen
    if other.explains and not given.explains:
        raise RequestError(
            f"{before.source}: {name_of(given)}, which was given, does not explain these data (residual "
            f"{per_cent(given.residual)} of the measured range); {name_of(other)} does "
            f"({per_cent(other.residual)}): leave --circuit and --branch out"
        )


def _refuse_unexplained(before: Comparison, fit: CurveFit) -> None:
    computed = fit.model.computed(fit.z)
    share = math.inf if computed is None else fit.share(computed)
    if share > UNEXPLAINED:
        raise RequestError(
            f"{before.source}: no circuit explains these data; the best dimensions on "
            f"{name_of(before.chosen)} leave a residual of {per_cent(share)} of the measured range; "
            f"{causes(before, '--offset input,output')}"
        )


def _calibration(
    measured: Measured, fit: CurveFit, unidentified: Mapping[int, tuple[int, ...]], confidence: float
) -> Calibration:
    """The calibration of a finished fit."""
    from scipy.special import stdtrit

    model, before = fit.model, fit.model.before
    free, scales = fit.free, model.scales
    deviation, jacobian = fit.deviation(), fit.jacobian(free)
    computed = model.computed(fit.z)
    if computed is None:
        raise ArithmeticError("the poses of a finished calibration were lost")
    rms = {q: math.sqrt(float(np.mean((v - computed[q]) ** 2))) for q, v in model.values.items()}
    exact = all(rms[q] <= EXACT * extent for q, extent in model.extents.items())
    _, values, rows = np.linalg.svd(jacobian, full_matrices=False)
    root = rows.T / values if len(free) else np.zeros((0, 0))
    noise = math.nan if exact else deviation**2
    covariance = noise * (root @ root.T) * np.outer(scales[free], scales[free])
    reach = float(stdtrit(fit.freedom, 0.5 + confidence / 2))
    following = model.following(fit.z)
    parameters = []
    for k, (name, kind) in enumerate(zip(model.names, model.kinds, strict=True)):
        nominal, value = float(model.nominal[k]), float(fit.z[k])
        if k in free or k in following:
            way = following[k][free] if k in following else np.eye(len(model.names))[k][free]
            error = math.sqrt(float(way @ covariance @ way))
            status: Status = "calibrated" if k in free else "follows"
            ends = value - reach * error, value + reach * error
            parameters.append(Parameter(name, kind, status, nominal, value, error, *ends))
        elif k in unidentified:
            undone = tuple(model.names[other] for other in unidentified[k])
            parameters.append(Parameter(name, kind, "unidentified", nominal, value, undone_by=undone))
        elif k < len(model.names) - 2:
            why: Status = "opens the loop" if name in model.opening else "fixed"
            parameters.append(Parameter(name, kind, why, nominal, value))
    return Calibration(
        linkage=before.linkage,
        ends=before.ends,
        source=before.source,
        before=before,
        parameters=tuple(parameters),
        covariance=covariance,
        confidence=confidence,
        freedom=fit.freedom,
        places=fit.sites,
        exact=exact,
        follow=model.follows,
        noise={q: noise * deviation for q, noise in fit.noise.items()},
        line=measured.line[model.rows],
        stretch=before.stretch[model.rows],
        input=model.begin + fit.z[-2],
        measured=model.values,
        computed=computed,
        nominal=model.at_first,
        evaluations=fit.evaluations,
        notes=_notes(measured, fit, computed, exact=exact),
    )


def _notes(
    measured: Measured, fit: CurveFit, computed: Mapping[str, Floats], *, exact: bool
) -> tuple[str, ...]:
    model, before = fit.model, fit.model.before
    notes = list(before.about_rows)
    if measured.left_out:
        notes.append(f"{measured.left_out} rows without a number were left out")
    lost = len(before.line) - len(model.rows) - len(fit.left_out)
    if lost:
        notes.append(
            f"{lost} of {len(before.line)} rows have inputs at which the nominal linkage does not close, or "
            "is at a dead centre; they are left out"
        )
    if fit.left_out:
        notes.append(
            f"lines {', '.join(map(str, sorted(fit.left_out)))} lie beyond a limit of the input of the "
            "linkage as calibrated; they are left out"
        )
    if exact:
        notes.append("the rows are exact: what is left is rounding, and no intervals can be made of it")
    else:
        notes += _far_off(fit, computed)
        for quantity, values in model.values.items():
            apart = _at_places(values - computed[quantity], model.sites)
            notes += _following(quantity, apart, EXACT * model.extents[quantity])
        if len(model.values) > 1:
            notes.append(
                "the intervals take the noise of angle, velocity and acceleration for independent; where one "
                "was computed from another they are too narrow"
            )
    if not fit.free:
        notes.append("the data identify none of the dimensions that were to be found")
    return tuple(notes)


def _far_off(fit: CurveFit, computed: Mapping[str, Floats]) -> list[str]:
    """Rows that are far from where most of the others put the curve."""
    model, before = fit.model, fit.model.before
    left = left_by_most(fit.found(), fit.jacobian(fit.free))
    lines, slopes = before.line[model.rows], model.slopes(fit.z)
    notes = []
    for part, quantity in zip(np.split(left, len(computed)), computed, strict=True):
        apart, steep, extent = -part * fit.noise[quantity], slopes[quantity][:, -2], model.extents[quantity]
        notes += far_off_notes(before.ends, quantity, lines, before.source, apart, steep, extent)
    return notes


def _at_places(residual: Floats, sites: Integers) -> Floats:
    """The mean at each place of the curve (places,), ordered by its first row: a repeat is no neighbour."""
    _, first, of = np.unique(sites, return_index=True, return_inverse=True)
    means = np.bincount(of, residual) / np.bincount(of)
    return np.asarray(means[np.argsort(first)])


def _following(quantity: str, residual: Floats, rounding: float) -> list[str]:
    """Whether neighbouring differences follow each other."""
    residual = residual - residual.mean()
    power = float(residual @ residual)
    if len(residual) < 20 or power <= len(residual) * rounding**2:
        return []
    follows = float(residual[1:] @ residual[:-1]) / power
    if follows <= FOLLOWS / math.sqrt(len(residual)):
        return []
    return [
        f"neighbouring differences of the {quantity} follow each other (correlation {follows:.2f}): "
        "what is left is not random, so something besides these dimensions is at work and the "
        "intervals are too narrow"
    ]
