"""What is measured of a motion or of a circuit, by name: the columns of sweeps, the heights of maps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from sevenbar.errors import RequestError, no_joint, shown, suggestion
from sevenbar.forces.sizing import Bearing, CycleLoads
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.circuits.motion import Motion, Solvable, chosen_circuit
from sevenbar.kinematics.circuits.table import advantage_unit
from sevenbar.kinematics.dynamics.force_measures import force_slopes, mass_slopes, peak_shaking, sized
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.numbers.gradients import MeasureSlopes, advantage_slopes, measure_slopes
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.paths.circuit_path import NotFollowedError
from sevenbar.kinematics.ranges.extent_slopes import extent_slopes
from sevenbar.kinematics.solvers.batches import Motions
from sevenbar.kinematics.transmission.slopes import transmission_slopes

#: What a measure is a number of: of angles and lengths by the output.
Quantity = Literal[
    "word",
    "count",
    "ratio",
    "angle",
    "output",
    "velocity",
    "acceleration",
    "jerk",
    "torque",
    "force",
    "moment",
    "power",
    "energy",
    "joint",
    "length",
    "advantage",
]

#: What the derivatives of a measure come with: those of a family are worked out together.
Family = Literal["motion", "transmission", "advantage", "forces", "extents"]

#: Where a number may be that has no bounds, and one that is a size.
ANY, SIZE = (-math.inf, math.inf), (0.0, math.inf)


@dataclass(frozen=True)
class Measure:
    """A word or number of each linkage, or of each of its circuits.

    `value` takes the Motion, or the Circuit; angles come in degrees, as people read them, other numbers as
    the motion has them. It gives `None` where the measure has no meaning. No value is outside the `bounds`.
    `batch`, where the core measures many at once, takes their Motions and gives the column of linkages (n,)
    or circuits (c,); with `of_type` an RSSR's `Classified` has enough, which takes no circuits.
    """

    name: str
    per: Literal["linkage", "circuit"]
    quantity: Quantity
    value: Callable[[Any], float | int | str | None]
    title: str
    bounds: tuple[float, float] = ANY
    family: Family = "motion"
    batch: Callable[[Any], npt.NDArray[Any]] | None = None
    of_type: bool = False

    def __reduce__(self) -> tuple[Callable[..., Measure], tuple[Any, ...]]:
        """Pickled by its name, since the functions of `MEASURES` have none; a caller's with its function."""
        if NAMED.get(self.name) is self or self.name.partition(":")[0] in OF_JOINTS:
            return _measure, (self.name,)
        return Measure, (self.name, self.per, self.quantity, self.value, self.title, self.bounds, self.family)

    def unit(self, linkage: Loop, output: str) -> str:
        """The unit of its numbers, "" where there is none; `output` is the column of the output."""
        slides = not linkage.turns(output)
        length = linkage.length_unit
        rate = length if slides else "rad"
        return {
            "angle": "deg",
            "output": length if slides else "deg",
            "velocity": f"{rate}_s",
            "acceleration": f"{rate}_s2",
            "jerk": f"{rate}_s3",
            # of a sliding input the torque is a force
            "torque": "N_m",
            "force": "N",
            "moment": "N_m",
            "power": "W",
            "energy": "J",
            "length": length,
            "joint": length if self._slides(linkage) else "deg",
            "advantage": advantage_unit(linkage.turns(linkage.drive.joint), not slides, length),
        }.get(self.quantity, "")

    def _slides(self, linkage: Loop) -> bool:
        """Whether the joint of its name does."""
        joint = self.name.partition(":")[2]
        named = [c for c in linkage.columns if c in (joint, f"{joint}.1")]
        return bool(named) and linkage.unit_of(named[0]) != "rad"

    def column(self, linkage: Loop, output: str) -> str:
        """Its name in tables, with the unit."""
        unit = self.unit(linkage, output)
        return f"{self.name}_{unit}" if unit else self.name


def _by_name(*measures: Measure) -> dict[str, Measure]:
    return {measure.name: measure for measure in measures}


def _swing(circuit: Circuit) -> float | None:
    return (
        math.degrees(circuit.swing) if circuit.swing is not None and circuit.output_turns else circuit.swing
    )


def _ends(
    name: str,
    quantity: Quantity,
    lowest: str,
    highest: str,
    bounds: tuple[float, float] = ANY,
    family: Family = "motion",
    *,
    batched: bool = True,
) -> list[Measure]:
    """The lowest and the highest of what a circuit has under a name, with their titles.

    `batched`: the core's batches have them under that name, too.
    """

    def value(end: str, circuit: Circuit) -> float | None:
        extremes: Extremes | None = getattr(circuit, name)
        result = None if extremes is None else getattr(extremes, end)
        return math.degrees(result) if result is not None and quantity == "angle" else result

    def column(place: int, motions: Motions) -> npt.NDArray[Any]:
        result = getattr(motions.raw, name)[:, place]
        return np.degrees(result) if quantity == "angle" else np.asarray(result)

    return [
        Measure(
            *(f"{name}_{end}", "circuit", quantity, partial(value, end), title, bounds, family),
            partial(column, place) if batched else None,
        )
        for end, place, title in (("lowest", 0, lowest), ("highest", 2, highest))
    ]


def _of_rate(rate: Literal["velocity", "acceleration", "jerk"]) -> list[Measure]:
    lowest, highest = (
        f"{end} {rate} of the output; none where there is no bound" for end in ("lowest", "highest")
    )
    return _ends(rate, rate, lowest, highest)


def _of_sizing(name: str, quantity: Quantity, pick: Callable[[CycleLoads], float], title: str) -> Measure:
    """A number of a circuit's sizing; none where its torque has no bound."""

    def value(circuit: Circuit) -> float | None:
        result = sized(circuit)
        return None if result is None else pick(result)

    return Measure(name, "circuit", quantity, value, title, SIZE, "forces")


def _joint_extent(circuit: Circuit, joint: str) -> float | None:
    """High less low of a joint [deg, or length]; `None` where it is endless."""
    try:
        ranges = circuit.joint_ranges
    except NotFollowedError:
        return None
    result = ranges.get(joint) or ranges.get(f"{joint}.1")
    if result is None:
        if joint in {name.rpartition(".")[0] or name for name in circuit.columns}:
            raise RequestError(
                f"measure: joint {shown(joint)} is a ball, which has no range; give ball_angle:{joint}"
            )
        raise RequestError(f"measure: {no_joint(joint, list(ranges))}")
    extent = result.extent
    return math.degrees(extent) if extent is not None and result.turns else extent


def _greatest_bend(circuit: Circuit, joint: str) -> float | None:
    """The greatest angle of a ball or universal joint from its seat [deg]."""
    try:
        return math.degrees(circuit.ball_cone(joint).greatest.value)
    except NotFollowedError:
        return None
    except RequestError as error:
        raise RequestError(f"measure: {str(error).partition(': ')[2]}") from None


def _least_gap(circuit: Circuit) -> float | None:
    """The least distance of links less their radii [length], of those with a radius where there are any."""
    try:
        result = circuit.clearances
    except NotFollowedError:
        return None
    thick = [one for one in result if one.radii] or result
    return min((one.gap for one in thick), default=None)


def _usable_share(circuit: Circuit) -> float | None:
    """What part of the circuit is within the stops, by length."""
    try:
        return circuit.allowed.share
    except NotFollowedError:
        return None


#: Every measure of the motion that has a name.
MEASURES: dict[str, Measure] = _by_name(
    Measure(
        *("motion_type", "linkage", "word", lambda m: m.motion_type, "motion type"),
        batch=lambda many: many.types,
        of_type=True,
    ),
    Measure(
        *("circuits", "linkage", "count", lambda m: len(m.circuits), "number of circuits"),
        batch=lambda many: many.circuits.astype(np.float64),
    ),
    Measure(
        *("limits", "linkage", "count", lambda m: len(m.limits), "number of limits of the input"),
        batch=lambda many: np.isfinite(many.limits).sum(axis=1).astype(np.float64),
        of_type=True,
    ),
    Measure(
        *("circuit_type", "circuit", "word", lambda c: c.motion_type, "the circuit's own motion type"),
        batch=lambda many: many.circuit_types,
    ),
    Measure(
        *("turns", "circuit", "count", lambda c: c.turns, "turns of the input until the circuit closes"),
        batch=lambda many: many.raw.turns.astype(np.float64),
    ),
    Measure(
        *("swing", "circuit", "output", _swing, "range of a rocking output", SIZE),
        batch=lambda many: np.degrees(many.raw.swing) if many.output_turns else many.raw.swing,
    ),
    Measure(
        *("time_ratio", "circuit", "ratio", lambda c: c.time_ratio, "slower stroke over the quicker"),
        bounds=(1.0, math.inf),
        batch=lambda many: many.raw.time_ratio,
    ),
    *_ends(
        *("transmission", "angle", "least transmission angle", "greatest transmission angle"),
        bounds=(0.0, 180.0),
        family="transmission",
    ),
    *_of_rate("velocity"),
    *_of_rate("acceleration"),
    *_of_rate("jerk"),
)

#: Measures of what acts on the linkage; they come from the forces of each circuit.
FORCE_MEASURES: dict[str, Measure] = _by_name(
    _of_sizing("peak_torque", "torque", lambda s: abs(s.peak_torque.value), "greatest torque of the input"),
    _of_sizing("rms_torque", "torque", lambda s: s.rms_torque, "root mean square of the input's torque"),
    _of_sizing("peak_power", "power", lambda s: s.peak_power.value, "greatest power of the input"),
    _of_sizing(
        "energy_fluctuation", "energy", lambda s: s.fluctuation, "fluctuation of energy, for a flywheel"
    ),
    Measure("peak_shaking", "circuit", "force", peak_shaking, "greatest shaking force", SIZE, "forces"),
)

#: Measures of how far a circuit takes its joints and links, and of its stops.
EXTENT_MEASURES: dict[str, Measure] = _by_name(
    Measure(
        *("clearance", "circuit", "length", _least_gap, "least distance of links, less their radii"),
        family="extents",
    ),
    Measure(
        *("usable", "circuit", "ratio", _usable_share, "part of the circuit within all stops"),
        bounds=(0.0, 1.0),
        family="extents",
    ),
)

#: Measures that follow from others of a circuit.
DERIVED_MEASURES: dict[str, Measure] = _by_name(
    *_ends(
        *("advantage", "advantage", "least mechanical advantage", "greatest mechanical advantage"),
        family="advantage",
        batched=False,
    ),
)

#: All of these.
NAMED = MEASURES | FORCE_MEASURES | EXTENT_MEASURES | DERIVED_MEASURES

#: A measure of a joint, as in range:rocker: quantity, value, title.
OfJoint = tuple[Quantity, Callable[[Circuit, str], float | None], str]


def _of_bearing(pick: Callable[[Bearing], float]) -> Callable[[Circuit, str], float | None]:
    """A number of what a joint bears; none where it has no bound."""

    def value(circuit: Circuit, joint: str) -> float | None:
        result = sized(circuit, (joint,))
        number = math.nan if result is None else pick(result.bearing(joint))
        return number if math.isfinite(number) else None

    return value


#: Measures of how far a joint goes.
JOINT_EXTENTS: dict[str, OfJoint] = {
    "range": ("joint", _joint_extent, "range of joint {}; none where it is endless"),
    "ball_angle": ("angle", _greatest_bend, "greatest angle of joint {} from its seat"),
}

#: Measures of what a joint bears.
JOINT_MEASURES: dict[str, OfJoint] = {
    "peak_force": ("force", _of_bearing(lambda b: b.force.peak.value), "greatest force in joint {}"),
    "mean_cube_force": (
        "force",
        _of_bearing(lambda b: b.force.mean_cube),
        "cubic mean of the force in joint {}",
    ),
    # of planar loops, whose forces along the axes are open
    "peak_force_in_plane": (
        "force",
        _of_bearing(lambda b: b.in_plane.peak.value),
        "greatest force in joint {} in the plane of motion",
    ),
    "mean_cube_force_in_plane": (
        "force",
        _of_bearing(lambda b: b.in_plane.mean_cube),
        "cubic mean of the force in joint {} in the plane of motion",
    ),
    "peak_tilting": (
        "moment",
        _of_bearing(lambda b: b.tilting.peak.value),
        "greatest tilting moment in joint {}",
    ),
}

#: All that are of a joint, by its name.
OF_JOINTS = JOINT_MEASURES | JOINT_EXTENTS


def family_of(name: str) -> Family:
    """What the derivatives of the measure of a name come with."""
    kind = name.partition(":")[0]
    if kind in OF_JOINTS:
        return "forces" if kind in JOINT_MEASURES else "extents"
    return NAMED[name].family if name in NAMED else "motion"


def is_of_forces(name: str) -> bool:
    """Whether a measure is of what acts on the linkage."""
    return family_of(name) == "forces"


def _of_joint(name: str) -> Measure | None:
    """The measure of a joint by its name; `None` where the name is of none."""
    kind, _, joint = name.partition(":")
    if kind not in OF_JOINTS or not joint:
        return None
    quantity, value, title = OF_JOINTS[kind]
    own = family_of(name)
    return Measure(
        name, "circuit", quantity, lambda circuit: value(circuit, joint), title.format(joint), SIZE, own
    )


def measures_named(given: Iterable[str | Measure | Callable[[Motion], float]]) -> tuple[Measure, ...]:
    """The measures of names, or of functions of the Motion, which are measures of a linkage.

    Raises `RequestError` for an unknown name, for none, and for two of one name.
    """
    result = [_measure(one) for one in given]
    names = [measure.name for measure in result]
    if not result:
        raise RequestError(f"measure: none given; give some of {', '.join(MEASURES)}")
    for name in names:
        if names.count(name) > 1:
            raise RequestError(f"measure: {shown(name)} is given twice; leave one out")
    return tuple(result)


def _measure(given: object) -> Measure:
    if isinstance(given, Measure):
        return given
    if isinstance(given, str) and given in NAMED:
        return NAMED[given]
    of_joint = _of_joint(given) if isinstance(given, str) else None
    if of_joint is not None:
        return of_joint
    if callable(given):
        name = getattr(given, "__name__", "measure").strip("<>")
        about = (getattr(given, "__doc__", None) or name).splitlines()[0]
        return Measure(name, "linkage", "ratio", given, about)
    known = [*NAMED, *(f"{kind}:JOINT" for kind in OF_JOINTS)]
    raise RequestError(
        f"measure: {shown(given)} is not a measure; {suggestion(given, known)}"
        f"give some of {', '.join(known)}, or a function of the Motion"
    )


def rows_of(motion: Motion, measures: Sequence[Measure]) -> list[dict[str, float | int | str | None]]:
    """The measures of a motion: one row, or where one of them is of circuits a row for each circuit.

    A motion without circuits keeps one row, whose `circuit` is `None`.

        >>> import sevenbar as sb
        >>> rows_of(sb.load("seven_r").motion(), measures_named(["motion_type", "circuits"]))
        [{'motion_type': 'double-crank', 'circuits': 8}]
    """
    shared = {m.name: m.value(motion) for m in measures if m.per == "linkage"}
    own = [m for m in measures if m.per == "circuit"]
    if not own:
        return [shared]
    if not motion.circuits:
        return [{"circuit": None} | shared | {m.name: None for m in own}]
    return [{"circuit": c.index} | shared | {m.name: m.value(c) for m in own} for c in motion.circuits]


#: The derivatives of the measures of each family, or of those that are named; without names the usual ones.
_SLOPES: dict[Family, Callable[[Numbers, Circuit, float, Sequence[str] | None], Iterable[MeasureSlopes]]] = {
    "motion": measure_slopes,
    "transmission": lambda numbers, circuit, _speed, _names: transmission_slopes(numbers, circuit),
    "advantage": advantage_slopes,
    "forces": force_slopes,
    "extents": lambda numbers, circuit, _speed, names: extent_slopes(numbers, circuit, names),
}


def gradient(
    motion: Motion, circuit: int = 0, *, only: Sequence[str] | None = None
) -> dict[str, MeasureSlopes]:
    """The measures of a circuit that are numbers, by name, with derivatives by the description's numbers.

    Those of `MEASURES` that vary smoothly, and angle_lowest, angle_highest of the output and limit_1 .. of
    the input besides; those of forces where anything acts; those of ranges, balls and distances that the
    linkage's stops are about. With `only` measures of these names, of any joint and ball, and nothing else is
    worked out. Angles are in degrees. Derivatives (k,) are exact, in the order of the names that
    `Circuit.sensitivity` has, by their units; NaN where a measure has none, as at a kink. Raises
    `RequestError` for a circuit or a measure that does not exist and a linkage made without a description.

        >>> import sevenbar as sb
        >>> found = gradient(sb.load("rssr").motion())["transmission_lowest"]
        >>> found.unit, found.slopes.shape
        ('deg', (6,))

    Source: docs/theory_design.md, (6); docs/theory_measures.md, (16).
    """
    return circuit_gradient(motion.linkage, chosen_circuit(motion, circuit), only=only)


def circuit_gradient(
    linkage: Solvable, chosen: Circuit, *, only: Sequence[str] | None = None
) -> dict[str, MeasureSlopes]:
    """`gradient` of a circuit of a linkage that need not be one of a motion."""
    numbers, speed = Numbers(linkage), chosen.speed
    names = None if only is None else [one.name for one in measures_named(only)]
    result: list[MeasureSlopes] = []
    for family, slopes in _SLOPES.items():
        own = None if names is None else [name for name in names if family_of(name) == family]
        if own is None or own:
            result += slopes(numbers, chosen, speed, own)
    return {one.name: one for one in result if names is None or one.name in names}


def mass_gradient(
    motion: Motion, circuit: int = 0, *, only: Sequence[str] | None = None
) -> dict[str, MeasureSlopes]:
    """Peaks of torque, power, shaking and joint forces, RMS torque, with derivatives by each mass [1/kg].

    In the order of the links that have a body; a body's inertia grows along with its mass. Nothing where no
    link has a body, or the circuit does not go round at constant speed. `only` is as for `gradient`.

        >>> import sevenbar as sb
        >>> rod = sb.load("rssr").loaded(bodies={2: sb.Body(1.3, solid="rod")})
        >>> found = mass_gradient(rod.motion())["peak_torque"]
        >>> bool(abs(found.slopes[0] * 1.3 - found.value) < 1e-9 * found.value)  # it is linear in the mass
        True

    Source: docs/theory_forces.md, (9).
    """
    return circuit_mass_gradient(motion.linkage, chosen_circuit(motion, circuit), only=only)


def circuit_mass_gradient(
    linkage: Solvable, chosen: Circuit, *, only: Sequence[str] | None = None
) -> dict[str, MeasureSlopes]:
    """`mass_gradient` of a circuit of a linkage that need not be one of a motion."""
    names = None if only is None else [one.name for one in measures_named(only)]
    result = mass_slopes(Numbers(linkage), chosen, chosen.speed, names)
    return {one.name: one for one in result}
