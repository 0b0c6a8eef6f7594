"""Batches of RSSRs against each linkage's own motion, dense samples of it, and themselves in another order.

Source: `Linkage.motion`, which the other tests hold against sampling; for the extremes of jerk dense sampling.
"""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from beside_change_points import critical
from evidence.fuzz.random_linkages import Dimensions, assembled_square, square
from sevenbar import _core

CLASSES = (
    "crank-rocker",
    "rocker-crank",
    "double-crank",
    "double-rocker",
    "change-point",
    "cannot-assemble",
    "invalid",
)
DRIVERS = ("crank", "rocker")

#: Error of a limit in parts of its condition [rad].
LIMIT_ERROR = 1e-12


def column(linkage: Dimensions) -> list[float]:
    return [linkage.M, linkage.N, linkage.L1, linkage.L2, linkage.L3, linkage.D]


def dimensions(linkages: list[Dimensions]) -> np.ndarray:
    return np.ascontiguousarray(np.transpose([column(linkage) for linkage in linkages]))


def of_all_kinds(seed: int, count: int) -> list[Dimensions]:
    """Square axes over one and four decades, tiny couplers, and linkages beside change points."""
    rng = np.random.default_rng(seed)
    made = []
    for index in range(count):
        kind = index % 6
        if kind < 2:
            made.append(assembled_square(rng))
        elif kind == 2:
            made.append(square(rng))
        elif kind == 3:
            made.append(assembled_square(rng, 4.0))
        elif kind == 4:
            made.append(critical(rng, rng.choice([-1, 1]) * 10 ** rng.uniform(-15, -3)))
        else:
            free = assembled_square(rng)
            size = 10 ** rng.uniform(-5, -2)
            # both circles pass near one point, a coupler apart
            made.append(Dimensions(free.M, free.L3, free.M, free.L3 * (1 + size / 3), size / 2, size))
    return [d for d in made if d.L1 > 0]


def apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)


@pytest.mark.parametrize("count", [1500, pytest.param(5000, marks=pytest.mark.proof)])
@pytest.mark.parametrize("driver", DRIVERS)
def test_types_and_limits_are_those_of_the_linkage_s_own_motion(driver: str, count: int) -> None:
    linkages = of_all_kinds(count, count)
    codes, limits = _core.classify_rssr(dimensions(linkages), driver, 1)
    seen = set()
    for description, code, row in zip(linkages, codes, limits, strict=True):
        linkage = description.linkage()
        if linkage._closed_form.has_free_side:
            # its motion takes the general way, which has the circuit with the input at rest, too
            assert CLASSES[code] == "change-point"
            continue
        motion = linkage.motion(samples=4, input=driver)
        seen.add(motion.motion_type)
        assert CLASSES[code] == motion.motion_type, description
        got = row[np.isfinite(row)]
        assert np.isnan(row[got.size :]).all()
        assert (np.diff(got) > 0).all()
        assert ((got >= 0) & (got < 2 * np.pi)).all()
        assert got.size == motion.limits.size, description
        conditions = {d.input: d.condition for c in motion for d in c.dead_centres if d.kind == "input"}
        for want in motion.limits:
            condition = [x for at, x in conditions.items() if apart(np.array(at), want) < 1e-15]
            error = apart(got, want).min()
            assert error <= LIMIT_ERROR * max([1.0, *condition]), (description, error, condition)
    assert seen == set(CLASSES) - {"double-crank", "invalid"}


def test_the_paper_s_linkage_is_a_crank_rocker_and_the_other_way_a_rocker_crank() -> None:
    linkage = sb.load("rssr")
    one = np.array([[linkage.dimensions[key]] for key in ("M", "N", "L1", "L2", "L3", "D")])
    assert [CLASSES[_core.classify_rssr(one, driver, 1)[0][0]] for driver in DRIVERS] == [
        "crank-rocker",
        "rocker-crank",
    ]
    _, limits = _core.classify_rssr(one, "rocker", 1)
    np.testing.assert_allclose(limits[0], linkage.motion(input="rocker").limits, rtol=0, atol=1e-14)


@pytest.mark.parametrize("driver", DRIVERS)
def test_no_bit_depends_on_order_neighbours_or_threads(driver: str) -> None:
    linkages = of_all_kinds(2, 600)
    # past the share of a thread, and no whole number of blocks
    many = np.tile(dimensions(linkages), 17)[:, :9001].copy()
    codes, limits = _core.classify_rssr(many, driver, 1)

    def same(places: np.ndarray, threads: int) -> None:
        again = _core.classify_rssr(np.ascontiguousarray(many[:, places]), driver, threads)
        assert (again[0] == codes[places]).all()
        assert again[1].tobytes() == limits[places].tobytes()

    everything = np.arange(many.shape[1])
    for threads in (0, 2, 5):
        same(everything, threads)
    same(everything[::-1], 1)
    same(np.random.default_rng(0).permutation(everything), 2)
    for place in range(0, 600, 7):
        same(everything[place : place + 1], 1)
    for start in (1, 31, 63):
        same(everything[start : start + 100], 1)


def test_dimensions_that_make_no_linkage_are_invalid_and_their_neighbours_are_not() -> None:
    good = [700.0, 700.0, 250.0, 900.0, 550.0, 0.0]
    wrong = [(k, x) for k in range(6) for x in (np.nan, np.inf, -np.inf)]
    wrong += [(k, x) for k in (2, 3, 4) for x in (0.0, -1.0, 1e-14, 5e-324)]
    many = np.repeat(np.array(good)[:, None], 2 * len(wrong) + 1, axis=1)
    for place, (k, x) in enumerate(wrong):
        many[k, 2 * place + 1] = x
    for driver in DRIVERS:
        codes, limits = _core.classify_rssr(many, driver, 1)
        assert {CLASSES[code] for code in codes[1::2]} == {"invalid"}
        assert np.isnan(limits[1::2]).all()
        assert len(set(codes[::2])) == 1
        assert CLASSES[codes[0]] != "invalid"
        assert len({row.tobytes() for row in limits[::2]}) == 1
        measured = measure(many, driver, 1)
        assert (measured.codes == codes).all()
        assert (measured.circuits[1::2] == 0).all()
        assert np.isnan(measured.limits[1::2]).all()


@pytest.mark.parametrize("unit", [1e-300, 1e-30, 1e3, 1e300, 1e307])
def test_the_unit_of_length_does_not_matter(unit: float) -> None:
    linkages = dimensions(
        [d for d in of_all_kinds(3, 300) if d.reference().clearance() > 1e-3 and d.L2 > 0.01]
    )
    # of one size, so that the largest unit overflows for none
    linkages = np.ascontiguousarray(linkages / np.abs(linkages).max(axis=0))
    codes, limits = _core.classify_rssr(linkages, "crank", 1)
    again, moved = _core.classify_rssr(linkages * unit, "crank", 1)
    assert (again == codes).all()
    np.testing.assert_allclose(moved, limits, rtol=0, atol=1e-9)


def test_no_linkages_give_no_rows() -> None:
    codes, limits = _core.classify_rssr(np.empty((6, 0)), "crank", 1)
    assert (codes.shape, limits.shape) == ((0,), (0, 4))
    measured = measure(np.empty((6, 0)), "crank", 2)
    assert measured.measures.jerk.shape == (0, 4)
    assert measured.circuits.shape == (0,)


def test_a_wrong_request_is_told() -> None:
    with pytest.raises(_core.CoreError, match=r"shape \[5, 3\]; give one of shape \(6, n\)"):
        _core.classify_rssr(np.ones((5, 3)), "crank", 1)
    with pytest.raises(_core.CoreError, match="'coupler' is not a side link; give crank or rocker"):
        measure(np.ones((6, 3)), "coupler", 1)


def measure(many: np.ndarray, driver: str, threads: int) -> _core.RssrBatch:
    """At unit speed of the input."""
    return _core.measure_rssr(many, driver, np.ones(many.shape[1]), threads)


@pytest.mark.parametrize("driver", DRIVERS)
def test_what_is_measured_is_what_the_linkage_s_own_motion_says(driver: str) -> None:
    linkages = of_all_kinds(4, 240)
    measured = measure(dimensions(linkages), driver, 2)
    codes, _ = _core.classify_rssr(dimensions(linkages), driver, 1)
    assert (measured.codes == codes).all()
    row = 0
    for index, description in enumerate(linkages):
        linkage = description.linkage()
        if linkage._closed_form.has_free_side:
            assert CLASSES[codes[index]] == "change-point"
            row += int(measured.circuits[index])
            continue
        motion = linkage.motion(samples=4, input=driver)
        assert measured.circuits[index] == len(motion.circuits)
        assert (measured.limits[index, : motion.limits.size] == motion.limits).all()
        for circuit in motion:
            assert measured.measures.turns[row] == circuit.turns
            if motion.motion_type != "change-point":  # there the output is followed instead
                same(measured.measures.swing[row : row + 1], circuit.swing)
                same(measured.measures.time_ratio[row : row + 1], circuit.time_ratio)
            same(measured.measures.transmission[row], ends(circuit.transmission))
            same(measured.measures.velocity[row], ends(circuit.velocity))
            same(measured.measures.acceleration[row], ends(circuit.acceleration))
            row += 1
    assert all(len(values) == row for values in arrays_of(measured.measures).values())


def arrays_of(measures: _core.RawMeasures) -> dict[str, np.ndarray]:
    names = ("turns", "swing", "time_ratio", "transmission", "velocity", "acceleration", "jerk")
    return {name: getattr(measures, name) for name in names}


def ends(extremes: sb.motion.Extremes | None) -> tuple[float, ...] | None:
    if extremes is None:
        return None
    return extremes.lowest, extremes.lowest_at, extremes.highest, extremes.highest_at


def same(got: np.ndarray, want: tuple[float, ...] | float | None) -> None:
    """Equal to the last bit; NaN where there is nothing."""
    np.testing.assert_array_equal(got, np.full(got.size, np.nan) if want is None else want)


def test_measures_do_not_depend_on_the_number_of_threads() -> None:
    many = dimensions(of_all_kinds(5, 90))
    one = arrays_of(measure(many, "crank", 1).measures)
    for threads in (2, 5):
        again = arrays_of(measure(many, "crank", threads).measures)
        assert {key: again[key].tobytes() for key in one} == {key: one[key].tobytes() for key in one}


@pytest.mark.parametrize("driver", DRIVERS)
def test_no_sampled_jerk_exceeds_its_extremes_and_the_output_has_them_where_they_are_said_to_be(
    driver: str,
) -> None:
    rng = np.random.default_rng(6)
    linkages = [d for d in (assembled_square(rng) for _ in range(300)) if d.reference().clearance() > 1e-3]
    measured = measure(dimensions(linkages), driver, 1)
    owners = np.repeat(np.arange(len(linkages)), measured.circuits)
    turning = np.flatnonzero(np.isfinite(measured.measures.jerk).all(axis=1))
    assert turning.size > 60
    assert (measured.measures.turns[turning] > 0).all()
    inputs = np.linspace(0, 2 * np.pi, 2881)
    for row in turning:
        linkage = linkages[owners[row]].linkage()
        branch = int(np.count_nonzero(owners[:row] == owners[row]))
        sampled = linkage.output(inputs, 3, 1.0, input=driver).jerk[branch]
        lowest, lowest_at, highest, highest_at = measured.measures.jerk[row]
        span = highest - lowest
        assert lowest - 1e-10 * span <= sampled.min() <= lowest + 0.1 * span
        assert highest - 0.1 * span <= sampled.max() <= highest + 1e-10 * span
        there = linkage.output(np.array([lowest_at, highest_at]), 3, 1.0, input=driver).jerk[branch]
        np.testing.assert_allclose(there, [lowest, highest], rtol=1e-8, atol=1e-9 * span)


@pytest.mark.parametrize("off", [1e-4, 1e-6, 1e-8, 1e-10])
def test_the_extremes_of_jerk_hold_the_narrow_peak_beside_a_change_point(off: float) -> None:
    """A crank that just turns past where it would stick: the rates rise within sqrt(off) of a radian."""
    rng = np.random.default_rng(7)
    checked = 0
    while checked < 12:
        description = critical(rng, rng.choice([-off, off]))
        measured = measure(dimensions([description]), "crank", 1)
        if CLASSES[measured.codes[0]] not in {"crank-rocker", "double-crank"}:
            continue
        checked += 1
        linkage = description.linkage()
        for branch in range(2):
            lowest, lowest_at, highest, highest_at = measured.measures.jerk[branch]
            near = np.concatenate(
                [at + np.sqrt(off) * np.linspace(-20, 20, 4001) for at in (lowest_at, highest_at)]
            )
            sampled = linkage.output(near, 3, 1.0).jerk[branch]
            span = highest - lowest
            assert lowest - 1e-3 * span <= sampled.min() <= lowest + 0.02 * span
            assert highest - 0.02 * span <= sampled.max() <= highest + 1e-3 * span
