"""Motion types, limits and circuits against sampling: nothing here knows a quartic.

Source: `reference_rssr.Rssr`, from the description alone. Whether the loop closes at an input is decided by
the distances from the driving ball to the nearest and the farthest point of the other circle, at thousands
of inputs; limits are narrowed down between two of them; both poses are followed along the inputs and the
turns of the output counted. A linkage whose margin has an extreme within 1e-3 of zero could hide a gap
between two samples and is left to the tests of change points.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_rssr import Course, Rssr
from evidence.fuzz.random_linkages import Dimensions, Drawing, assembled_square, nearly_parallel, skew, square

TURN = 2 * np.pi

MIRRORED = {
    "crank-rocker": "rocker-crank",
    "rocker-crank": "crank-rocker",
    "double-crank": "double-crank",
    "double-rocker": "double-rocker",
    "cannot-assemble": "cannot-assemble",
    "change-point": "change-point",
}

#: Nearer to a change point than this share of the size, sampling is not trusted.
CLEAR = 1e-3


def random_linkages(seed: int, count: int) -> Iterator[Dimensions | Drawing]:
    """All kinds of axes, clear of change points."""
    rng = np.random.default_rng(seed)
    kinds: tuple[Callable[..., Dimensions | Drawing], ...] = (
        assembled_square,
        skew,
        nearly_parallel,
        square,
        lambda r: nearly_parallel(r, 0.05),
    )
    made = 0
    while made < count:
        description = kinds[made % len(kinds)](rng)
        if description.reference().clearance() > CLEAR:
            made += 1
            yield description


def apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The distances of angles, going round."""
    return np.abs((np.asarray(a) - np.asarray(b) + np.pi) % TURN - np.pi)


@dataclass(frozen=True)
class Case:
    """A linkage's motion for one input, and what the reference makes of it."""

    motion: sb.Motion
    reference: Rssr
    driver: str
    courses: list[Course]


@pytest.fixture(scope="module", params=[100, pytest.param(750, marks=pytest.mark.proof)])
def cases(request: pytest.FixtureRequest) -> list[Case]:
    count = request.param
    made = []
    for description in random_linkages(count, count):
        linkage, reference = description.linkage(), description.reference()
        for driver in ("crank", "rocker"):
            motion = linkage.motion(samples=90, input=driver)
            made.append(Case(motion, reference, driver, reference.circuits(driver)))
    return made


def test_motion_types_are_those_that_sampling_finds(cases: list[Case]) -> None:
    seen: Counter[str] = Counter()
    for case in cases:
        types = {course.motion_type for course in case.courses} or {"cannot-assemble"}
        assert types == {case.motion.motion_type}
        assert {circuit.motion_type for circuit in case.motion} <= types
        seen.update(types)
    assert set(seen) == set(MIRRORED) - {"change-point"}
    assert min(seen.values()) >= (100 if len(cases) > 1000 else 4)


def test_there_are_as_many_circuits_as_sampling_finds(cases: list[Case]) -> None:
    for case in cases:
        assert len(case.motion.circuits) == len(case.courses)
        assert [c.input_range is None for c in case.motion] == [c.input_turns for c in case.courses]


def test_limits_are_those_of_bisection(cases: list[Case]) -> None:
    compared = 0
    for case in cases:
        want = np.sort(case.reference.limits(case.driver) % TURN)
        got = case.motion.limits
        assert got.shape == want.shape
        assert (np.diff(got) > 0).all()
        assert ((got >= 0) & (got < TURN)).all()
        if want.size:
            assert apart(got, want).max() < 1e-9
            compared += want.size
    assert compared > 100


def test_each_circuit_covers_the_input_and_output_that_its_course_does(cases: list[Case]) -> None:
    for case in cases:
        left = list(case.motion.circuits)
        for course in case.courses:
            circuit = left.pop(nearest_circuit(course, left))
            if course.input_turns:
                assert circuit.input_range is None
                assert circuit.turns == 1
            else:
                ends = (course.input.min(), course.input.max())
                # the samples crowd at the ends: the last one stays 1e-6 of the range short of it
                assert circuit.input_range is not None
                assert apart(circuit.input_range, ends).max() < 1e-5
            if course.output_turns:
                assert circuit.output_range is None
                assert circuit.swing is None
                continue
            low, high = course.output.min(), course.output.max()
            assert circuit.output_range is not None
            assert apart(circuit.output_range, (low, high)).max() < 1e-4
            assert circuit.swing == pytest.approx(high - low, abs=1e-4)


def nearest_circuit(course: Course, circuits: list[sb.Circuit]) -> int:
    """The circuit with a row nearest to a pose of the course."""
    pose = course.input.size // 4
    distances = [
        np.min(np.hypot(apart(c.input, course.input[pose]), apart(c.output, course.output[pose])))
        for c in circuits
    ]
    return int(np.argmin(distances))


def test_output_dead_centres_are_the_limits_of_the_other_joint(cases: list[Case]) -> None:
    for case in cases:
        other = "rocker" if case.driver == "crank" else "crank"
        want = np.sort(case.reference.limits(other) % TURN)
        centres = [d for circuit in case.motion for d in circuit.dead_centres if d.kind == "output"]
        got = np.sort([d.output % TURN for d in centres])
        assert got.shape == want.shape
        assert all(len([d for d in c.dead_centres if d.kind == "output"]) in (0, 2) for c in case.motion)
        if want.size:
            assert apart(got, want).max() < 1e-9
        for centre in centres:
            pose = np.array([[centre.input], [centre.output]])
            crank, rocker = pose if case.driver == "crank" else pose[::-1]
            assert case.reference.closure_error(crank, rocker)[0] < 1e-12


def test_input_dead_centres_close_and_are_the_limits(cases: list[Case]) -> None:
    for case in cases:
        centres = [d for circuit in case.motion for d in circuit.dead_centres if d.kind == "input"]
        np.testing.assert_allclose(
            np.sort([d.input % TURN for d in centres]), case.motion.limits, rtol=0, atol=1e-14
        )
        for centre in centres:
            pose = np.array([[centre.input], [centre.output]])
            crank, rocker = pose if case.driver == "crank" else pose[::-1]
            assert case.reference.closure_error(crank, rocker)[0] < 1e-12


def test_the_other_input_gives_the_mirrored_type(cases: list[Case]) -> None:
    for forward, backward in zip(cases[::2], cases[1::2], strict=True):
        assert backward.motion.motion_type == MIRRORED[forward.motion.motion_type]
        assert len(backward.motion.circuits) == len(forward.motion.circuits)


def test_limits_are_exact_to_1e_12_times_their_condition() -> None:
    """By the secant method in 40 digits on the reach past the nearest or short of the farthest point."""
    rng = np.random.default_rng(4)
    compared = 0
    for index in range(60):
        description = (assembled_square, skew, nearly_parallel)[index % 3](
            rng, *((2.0,) if index % 3 < 2 else ())
        )
        precise = description.reference().precise()
        for circuit in description.linkage().motion(samples=4):
            for centre in circuit.dead_centres:
                if centre.kind == "input" and centre.condition < 1e6:
                    with mp.workdps(40):
                        past, short, _ = precise.reach(mp.mpf(centre.input))
                        which = 0 if abs(past) < abs(short) else 1
                        exact = mp.findroot(lambda a, p=precise, k=which: p.reach(a)[k], mp.mpf(centre.input))
                    assert abs(float(exact - mp.mpf(centre.input))) < 1e-12 * max(1.0, centre.condition)
                    compared += 1
    assert compared > 40


def test_square_axes_give_no_strict_double_crank() -> None:
    """A fact measured beforehand (design.md): none in 10^6; a single one here would be news, or a defect."""
    rng = np.random.default_rng(12)
    seen = Counter(
        (assembled_square, square)[index % 2](rng, 2.0).linkage().motion(samples=4).motion_type
        for index in range(3000)
    )
    assert seen["double-crank"] == 0
    assert (
        min(seen[kind] for kind in ("crank-rocker", "rocker-crank", "double-rocker", "cannot-assemble")) > 100
    )


# Change points: planar linkages with Grashof's sum in balance, and lengths tuned until two limits meet.


def planar(ground: float, crank: float, coupler: float, rocker: float, angle: float = 1.0) -> Drawing:
    """A planar four-bar with parallel axes, drawn at a crank angle, the rocker to the left of A D."""
    a, d = crank * np.exp(1j * angle), complex(ground)
    along = (d - a) / abs(d - a)
    x = (abs(d - a) ** 2 + coupler**2 - rocker**2) / (2 * abs(d - a))
    b = a + along * (x + 1j * np.sqrt(coupler**2 - x**2))
    axis = np.array([0.0, 0.0, 1.0])
    places = [np.array([z.real, z.imag, 0.0]) for z in (0j, a, b, d)]
    return Drawing(places[0], axis, places[1], places[2], places[3], axis)


FOLDING = {
    "parallelogram": planar(2, 1, 2, 1),
    "rhombus": planar(1, 1, 1, 1),
    "kite, crank as long as the ground": planar(1, 1, 2, 2),
    "kite, crank longer than the coupler": planar(2, 2, 1, 1),
    "kite, rocker as long as the ground": planar(2, 1, 1, 2),
    "shortest and longest as long as the others": planar(3, 1, 2, 2, 0.5),
}


@pytest.mark.parametrize("driver", ["crank", "rocker"])
@pytest.mark.parametrize("name", FOLDING)
def test_a_planar_linkage_that_folds_flat_is_at_a_change_point(name: str, driver: str) -> None:
    motion = FOLDING[name].linkage().motion(input=driver)
    assert motion.motion_type == "change-point"
    assert motion.change_points
    assert motion.circuits


@dataclass(frozen=True)
class Meeting:
    """A coupler length at which two limits meet, where, and how that length bends with the input."""

    coupler: float
    input: float
    bend: float


def meetings(reference: Rssr, driver: str) -> list[Meeting]:
    """The extremes of the distances to the nearest and the farthest point, by golden section."""
    one, other = reference.sides(driver)
    step = TURN / 2048
    grid = step * np.arange(2048)
    found = []
    for which in (0, 1):

        def distance(x: np.ndarray, which: int = which) -> np.ndarray:
            return other.distances(one.turned(x))[which]

        sampled = distance(grid)
        for sign in (1.0, -1.0):
            peak = (sign * sampled >= sign * np.roll(sampled, 1)) & (
                sign * sampled > sign * np.roll(sampled, -1)
            )
            low, high = grid[peak] - step, grid[peak] + step
            for _ in range(40):
                left, right = low + 0.382 * (high - low), high - 0.382 * (high - low)
                rising = sign * distance(left) < sign * distance(right)
                low, high = np.where(rising, left, low), np.where(rising, high, right)
            middle, h = (low + high) / 2, 1e-3
            bend = (distance(middle - h) - 2 * distance(middle) + distance(middle + h)) / h**2
            found += [Meeting(*map(float, m)) for m in zip(distance(middle), middle, bend, strict=True)]
    return found


@pytest.fixture(scope="module")
def tuned() -> list[tuple[Dimensions, str, Meeting]]:
    """Square linkages and a coupler length at which two limits meet, alone and at a plain angle."""
    rng = np.random.default_rng(20)
    found: list[tuple[Dimensions, str, Meeting]] = []
    while len(found) < 60:
        dims = assembled_square(rng)
        reference = dims.reference()
        forward, backward = meetings(reference, "crank"), meetings(reference, "rocker")
        for one in forward:
            lengths = [m.coupler for m in forward if m is not one]
            twin = min(backward, key=lambda m, length=one.coupler: abs(m.coupler - length))
            alone = min(abs(length - one.coupler) for length in lengths) > 0.02 * reference.size
            plain = all(0.3 < abs(m.bend) / one.coupler < 3 for m in (one, twin))
            if alone and plain and abs(twin.coupler - one.coupler) < 1e-12 * reference.size:
                found += [(dims, "crank", one), (dims, "rocker", twin)]
    return found


def motion_with_coupler(dims: Dimensions, coupler: float, driver: str) -> sb.Motion:
    return replace(dims, L2=float(coupler)).linkage().motion(samples=36, input=driver)


def places(motion: sb.Motion) -> np.ndarray:
    """The inputs at change points, isolated poses among them."""
    return np.array([point.input for point in motion.change_points])


def test_a_linkage_tuned_to_a_change_point_is_said_to_be_there(
    tuned: list[tuple[Dimensions, str, Meeting]],
) -> None:
    for dims, driver, meeting in tuned:
        for off in (0.0, 1e-15, -1e-15, 1e-14, -1e-14):
            motion = motion_with_coupler(dims, meeting.coupler * (1 + off), driver)
            assert motion.motion_type == "change-point"
            assert apart(places(motion), meeting.input).min() < 1e-6


def test_a_thousandth_from_a_change_point_it_is_not_said_to_be_there(
    tuned: list[tuple[Dimensions, str, Meeting]],
) -> None:
    either_side = Counter()
    for dims, driver, meeting in tuned:
        types = [
            motion_with_coupler(dims, meeting.coupler * (1 + off), driver).motion_type
            for off in (1e-3, -1e-3)
        ]
        assert "change-point" not in types
        either_side[tuple(types)] += 1
        # and there the type changes, or two circuits become one
        counts = [
            len(motion_with_coupler(dims, meeting.coupler * (1 + off), driver).circuits)
            for off in (1e-3, -1e-3)
        ]
        assert types[0] != types[1] or counts[0] != counts[1]
    assert len(either_side) > 2


@pytest.mark.parametrize(("width", "is_one"), [(1e-8, True), (3e-7, True), (5e-6, False), (1e-4, False)])
def test_two_limits_nearer_than_1e_6_are_a_change_point(
    tuned: list[tuple[Dimensions, str, Meeting]], width: float, is_one: bool
) -> None:
    """Near a meeting L2 = l + bend/2 (x - x0)^2: moved by bend/8 width^2 it parts two limits by width."""
    for dims, driver, meeting in tuned:
        for side in (1, -1):  # two limits apart, or just missing each other
            coupler = meeting.coupler + side * meeting.bend / 8 * width**2
            motion = motion_with_coupler(dims, coupler, driver)
            assert (motion.motion_type == "change-point") == is_one
            if is_one:
                assert apart(places(motion), meeting.input).min() < 1e-6
            else:
                near = motion.limits[apart(motion.limits, meeting.input) < 1e-3] if motion.limits.size else []
                assert len(near) in (0, 2)
                assert len(near) == 0 or apart(near[0], near[1]) == pytest.approx(width, rel=0.05)


def test_change_points_are_told_for_either_input(tuned: list[tuple[Dimensions, str, Meeting]]) -> None:
    """The same linkage is at its change point whichever joint drives."""
    for dims, _, meeting in tuned:
        for driver in ("crank", "rocker"):
            motion = motion_with_coupler(dims, meeting.coupler, driver)
            assert motion.motion_type == "change-point"
            assert len(motion.change_points) == 1


def test_a_change_point_is_never_without_its_place() -> None:
    """L2 is 5e-13 off a meeting: one joint's limits are 2e-6 rad apart, the other's less than 1e-6."""
    for M, N, L1, L3, D, L2, driver in (
        (
            -0.5775799838356194,
            0.0,
            0.3907652557062132,
            1.2592168484711055,
            -2.0617012801780015,
            1.3794916591461217,
            "crank",
        ),
        (
            -1.5920235083494556,
            -0.9045459237864312,
            2.1636310468686313,
            0.767529602327351,
            2.4988152463102145,
            1.934256051692037,
            "rocker",
        ),
        (
            -0.40985747021826513,
            0.33106307824875614,
            0.3975677225248954,
            0.8924513186000709,
            2.1527666863708967,
            1.7433695978164019,
            "crank",
        ),
    ):
        motion = sb.rssr(M=M, N=N, L1=L1, L3=L3, D=D, L2=L2).motion(input=driver)
        assert motion.motion_type == "change-point"
        assert motion.change_points


def drawn_rssr(crank, a, b, rocker):
    """An RSSR by the places of its joints and the axes of its ends, (place, axis) each."""
    ends = [{"kind": "R", "at": at, "axis": axis} for at, axis in (crank, rocker)]
    return sb.from_axes([ends[0], {"kind": "S", "at": a}, {"kind": "S", "at": b}, ends[1]])


def test_the_swing_of_a_circuit_through_a_change_point_is_that_between_its_dead_centres_whatever_the_rows():
    linkage = drawn_rssr(((-2, -1, 2), (0, -1, -1)), (0, 2, 0), (0, 0, -2), ((0, -1, 2), (0, 1, 0)))
    for samples in (24, 360):
        motion = linkage.motion(samples)
        assert motion.motion_type == "change-point"
        (circuit,) = motion.circuits
        # as the solver of any loop has it, which follows the circuit
        assert circuit.swing == pytest.approx(5.03768324158, abs=1e-10)
        assert circuit.angle.highest - circuit.angle.lowest == pytest.approx(circuit.swing, abs=1e-12)
