"""Laws of every linkage: the closed product, continuity, frame and unit, conventions of rows.

Source: the definition of a linkage (design.md: the product Z(q1) G1 S G2 S G3 Z(q8) G4 is the identity, S =
Rz Ry Rx), its conventions for grids, dead centres and rates, and dense sampling by `reference_rssr`, which
knows the description only.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import sevenbar as sb
from evidence.fuzz.random_linkages import (
    Dimensions,
    Drawing,
    random_rotation,
    short_coupler,
)
from strategies import DRIVERS, TURN, drawings, drivers, laws, linkages, seeds, square_of, wrapped


def turn_about(axis: int, angles: np.ndarray) -> np.ndarray:
    """Homogeneous matrices (n, 4, 4) of turns about x, y or z."""
    one, other = (axis + 1) % 3, (axis + 2) % 3
    matrices = np.tile(np.eye(4), (len(angles), 1, 1))
    matrices[:, one, one] = matrices[:, other, other] = np.cos(angles)
    matrices[:, other, one] = np.sin(angles)
    matrices[:, one, other] = -np.sin(angles)
    return matrices


def loop_errors(linkage: sb.Linkage, q: np.ndarray, size: float) -> np.ndarray:
    """How far Z(q1) G1 S G2 S G3 Z(q8) G4 is from the identity, lengths in parts of the size."""

    def ball(first: int) -> np.ndarray:
        return turn_about(2, q[:, first]) @ turn_about(1, q[:, first + 1]) @ turn_about(0, q[:, first + 2])

    g1, g2, g3, g4 = linkage.transforms
    product = turn_about(2, q[:, 0]) @ g1 @ ball(1) @ g2 @ ball(4) @ g3 @ turn_about(2, q[:, 7]) @ g4
    errors = np.abs(product - np.eye(4))
    errors[:, :3, 3] /= size
    return errors.max(axis=(1, 2))


@laws
@given(linkages, drivers)
def test_the_product_round_the_loop_is_the_identity_on_every_row(
    description: Dimensions | Drawing, driver: str
) -> None:
    linkage, size = description.linkage(), description.reference().size
    for circuit in linkage.motion(samples=90, input=driver):
        assert np.isin(circuit.status, ["ok", "dead-centre"]).all()
        assert loop_errors(linkage, circuit.q, size).max() < 1e-12
        assert circuit.residual.max() < 1e-12 * size


@laws
@given(linkages, st.floats(-10, 10), drivers)
def test_the_product_is_the_identity_in_every_assembly_mode(
    description: Dimensions | Drawing, theta: float, driver: str
) -> None:
    linkage, size = description.linkage(), description.reference().size
    modes = linkage.assembly_modes(theta, input=driver)
    margin = description.reference().margin(np.array([theta]), driver)[0]
    if abs(margin) > 1e-12:
        assert len(modes) == (2 if margin > 0 else 0)
    assert modes.completeness == "closed-form"
    if len(modes):
        assert loop_errors(linkage, modes.q, size).max() < 1e-12
        assert (modes.residual < 1e-12 * size).all()
        assert ((modes.q > -np.pi - 1e-15) & (modes.q <= np.pi + 1e-15)).all()
        column = 0 if driver == "crank" else 7
        assert np.abs(wrapped(modes.q[:, column] - theta)).max() < 1e-12


def test_a_loop_whose_balls_nearly_touch_closes_too() -> None:
    rng = np.random.default_rng(3)
    for share in 10.0 ** -np.arange(1, 9):
        drawing = short_coupler(rng, share)
        linkage, size = drawing.linkage(), drawing.reference().size
        for circuit in linkage.motion(samples=720):
            assert loop_errors(linkage, circuit.q, size).max() < 1e-12 / share


# Continuity


@laws
@given(linkages, drivers, st.sampled_from([1.0, -1.0]))
def test_a_coarse_walk_finds_the_same_unwrapped_output_as_a_fine_one(
    description: Dimensions | Drawing, driver: str, speed: float
) -> None:
    """Only an output that is followed, not guessed from the row before, is the same at any step."""
    assume(description.reference().clearance() > 1e-3)
    linkage = description.linkage()
    walks = [linkage.motion(samples=samples, input=driver, speed=speed) for samples in (8, 4096)]
    for coarse, fine in zip(*walks, strict=True):
        assert np.abs(np.diff(fine.output)).max() < 1.5
        for passing in (0, 1):
            rows = (coarse.status == "ok") & (coarse.branch == passing)
            same = [
                np.argmin(np.abs(fine.input - x) + 100.0 * (fine.branch != passing))
                for x in coarse.input[rows]
            ]
            np.testing.assert_allclose(coarse.output[rows], fine.output[same], rtol=0, atol=1e-9)


@laws
@given(linkages, drivers, st.sampled_from([1.0, -1.0]))
def test_columns_are_continuous_and_come_back_to_the_first_row(
    description: Dimensions | Drawing, driver: str, speed: float
) -> None:
    assume(description.reference().clearance() > 1e-3)
    for circuit in description.linkage().motion(samples=2880, input=driver, speed=speed):
        assert circuit.closed
        if len(circuit.q) < 1000:  # a circuit that rocks a little has few rows, far apart
            continue
        steps = np.diff(circuit.q, axis=0)
        assert np.abs(steps).max() < np.pi
        # from the last row on to the first: a step like the others, whole turns left out
        closing = wrapped(circuit.q[0] - circuit.q[-1])
        assert np.abs(closing).max() <= 3 * np.abs(steps[[0, -1]]).max() + 1e-9


# Change of frame, of unit, of input


@laws
@given(drawings, seeds, st.floats(-3, 3), drivers)
def test_a_linkage_carried_to_another_frame_moves_the_same(
    drawing: Drawing, seed: int, decade: float, driver: str
) -> None:
    reference = drawing.reference()
    assume(reference.clearance() > 1e-2)
    rng = np.random.default_rng(seed)
    rotation, shift, scale = random_rotation(rng), rng.normal(size=3), 10**decade
    moved = drawing.moved(rotation, shift, scale)
    here, there = (
        drawing.linkage().motion(samples=24, input=driver),
        moved.linkage().motion(samples=24, input=driver),
    )

    assert there.motion_type == here.motion_type
    np.testing.assert_allclose(there.limits, here.limits, rtol=0, atol=1e-10)
    place = rng.normal(size=3)
    for a, b in zip(here, there, strict=True):
        assert a.status.tolist() == b.status.tolist()
        calm = (a.condition < 1e4) & (a.status == "ok")
        ends = [0, 7]  # the turns of a ball are told about the axes of the drawing
        np.testing.assert_allclose(b.q[:, ends], a.q[:, ends], rtol=0, atol=1e-6)
        np.testing.assert_allclose(b.q[calm][:, ends], a.q[calm][:, ends], rtol=0, atol=1e-10)
        np.testing.assert_allclose(b.dq[calm][:, ends], a.dq[calm][:, ends], rtol=1e-9, atol=1e-9)
        for link in (1, 2, 3):
            one = a.point(link, tuple(place))
            other = b.point(link, tuple(scale * (rotation @ place + shift)))
            span = np.abs(one.position).max() + 1
            moved_position = scale * (one.position @ rotation.T + shift)
            np.testing.assert_allclose(
                other.position[calm], moved_position[calm], rtol=0, atol=1e-8 * scale * span
            )
            velocity = scale * one.velocity @ rotation.T
            size = 1 + np.abs(one.velocity[calm]).max(initial=0)
            np.testing.assert_allclose(other.velocity[calm], velocity[calm], rtol=0, atol=1e-7 * scale * size)


@laws
@given(st.builds(square_of, seeds), st.floats(-90, 90), drivers)
def test_the_unit_of_length_changes_no_angle(dims: Dimensions, decade: float, driver: str) -> None:
    factor = 10.0**decade
    scaled = Dimensions(*(factor * value for value in vars(dims).values()))
    inputs = np.linspace(0, 6, 40)
    clear = np.abs(dims.reference().margin(inputs, driver)) > 1e-6
    here, there = (x.linkage().output(inputs[clear], 3, input=driver) for x in (dims, scaled))
    np.testing.assert_allclose(there.position, here.position, rtol=0, atol=1e-9)
    np.testing.assert_allclose(there.velocity, here.velocity, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(there.jerk, here.jerk, rtol=1e-6, atol=1e-9)


@laws
@given(linkages, drivers)
def test_the_way_back_leads_to_the_input(description: Dimensions | Drawing, driver: str) -> None:
    """alpha(beta(alpha)) = alpha on one of the branches of alpha."""
    reference, linkage = description.reference(), description.linkage()
    inputs = np.linspace(-3, 3, 50)
    inputs = inputs[reference.margin(inputs, driver) > 1e-6]
    other = DRIVERS[driver == "crank"]
    for outputs in linkage.output(inputs, input=driver).position:
        back = linkage.output(outputs, input=other).position
        apart = np.abs(wrapped(back - inputs))
        near_a_dead_centre = np.abs(reference.margin(outputs, other)) < 1e-6
        nearest = np.where(np.isnan(apart), np.inf, apart).min(axis=0)
        assert (nearest[~near_a_dead_centre] < 1e-8).all()


@laws
@given(linkages, drivers)
def test_velocity_there_and_back_multiply_to_one(description: Dimensions | Drawing, driver: str) -> None:
    reference, linkage = description.reference(), description.linkage()
    other = DRIVERS[driver == "crank"]
    inputs = np.linspace(-3, 3, 40)
    inputs = inputs[reference.margin(inputs, driver) > 1e-2]
    there = linkage.output(inputs, 1, input=driver)
    for outputs, velocity in zip(there.position, there.velocity, strict=True):
        back = linkage.output(outputs, 1, input=other)
        same = np.abs(wrapped(back.position - inputs)) < 1e-6
        calm = reference.margin(outputs, other) > 1e-2
        for branch in (0, 1):
            rows = same[branch] & calm
            np.testing.assert_allclose(back.velocity[branch][rows] * velocity[rows], 1.0, rtol=1e-9)


@laws
@given(linkages, drivers, st.lists(st.floats(-3, 3), min_size=3, max_size=3))
def test_a_law_obeys_the_chain_rule(
    description: Dimensions | Drawing, driver: str, rates: list[float]
) -> None:
    """With b, b', b'' by the input: b' u, b'' u^2 + b' u', b''' u^3 + 3 b'' u u' + b' u''."""
    reference, linkage = description.reference(), description.linkage()
    inputs = np.linspace(-3, 3, 40)
    inputs = inputs[reference.margin(inputs, driver) > 1e-3]
    u, du, ddu = rates
    plain = linkage.output(inputs, 3, 1.0, input=driver)
    law = linkage.output(inputs, 3, np.full(inputs.size, u), acceleration=du, jerk=ddu, input=driver)
    want_velocity = plain.velocity * u
    want_acceleration = plain.acceleration * u**2 + plain.velocity * du
    want_jerk = plain.jerk * u**3 + 3 * plain.acceleration * u * du + plain.velocity * ddu
    scale = 1 + np.abs(plain.velocity) + np.abs(plain.acceleration) + np.abs(plain.jerk)
    for got, want in (
        (law.velocity, want_velocity),
        (law.acceleration, want_acceleration),
        (law.jerk, want_jerk),
    ):
        assert (np.abs(got - want) < 1e-11 * scale).all()


# Rows


@laws
@given(linkages, drivers, st.integers(4, 400), st.sampled_from([1.0, -3.0, 0.25]))
def test_rows_stand_on_the_grid_and_at_the_dead_centres(
    description: Dimensions | Drawing, driver: str, samples: int, speed: float
) -> None:
    assume(description.reference().clearance() > 1e-3)
    step = TURN / samples
    motion = description.linkage().motion(samples=samples, input=driver, speed=speed)
    for circuit in motion:
        inputs, at_limit = circuit.input, circuit.status == "dead-centre"
        numbers = inputs[~at_limit] / step
        np.testing.assert_allclose(numbers, np.round(numbers), rtol=0, atol=1e-9)
        if circuit.input_range is None:
            np.testing.assert_array_equal(
                np.round(numbers), np.sign(speed) * np.arange(samples * circuit.turns)
            )
            assert not at_limit.any()
            continue
        start, end = circuit.input_range
        inside = np.arange(np.ceil(start / step), np.floor(end / step) + 1)
        # up on pass 0 from the lower limit, back on pass 1 from the upper one
        np.testing.assert_array_equal(np.round(numbers), np.concatenate([inside, inside[::-1]]))
        assert np.flatnonzero(at_limit).tolist() == [0, inside.size + 1]
        assert inputs[at_limit].tolist() == [start, end]
        assert circuit.branch.tolist() == [0] * (inside.size + 1) + [1] * (inside.size + 1)
        assert (circuit.mode[circuit.branch == 0] != circuit.mode[-1]).all()


@laws
@given(linkages, drivers, st.sampled_from([1.0, -3.0, 0.25]))
def test_every_row_has_the_input_s_rates_but_a_dead_centre_has_none(
    description: Dimensions | Drawing, driver: str, speed: float
) -> None:
    motion = description.linkage().motion(samples=60, input=driver, speed=speed)
    for circuit in motion:
        dead = circuit.status == "dead-centre"
        column = circuit.input_column
        assert (circuit.dq[~dead, column] == speed).all()
        assert (circuit.ddq[~dead, column] == 0).all()
        outputs = np.stack([circuit.dq, circuit.ddq, circuit.dddq])[:, :, circuit.output_column]
        assert np.isfinite(outputs[:, ~dead]).all()
        assert np.isnan(outputs[:, dead]).all()
        assert np.isfinite(circuit.q[dead]).all()
        assert np.isinf(circuit.condition[dead]).all()
        elapsed = np.diff(circuit.time)
        np.testing.assert_allclose(
            elapsed, np.abs(np.diff(circuit.input)) / abs(speed), rtol=1e-9, atol=1e-12
        )


@laws
@given(linkages, drivers)
def test_a_dead_centre_of_the_output_lies_on_the_pass_that_it_names(
    description: Dimensions | Drawing, driver: str
) -> None:
    assume(description.reference().clearance() > 1e-3)
    linkage = description.linkage()
    for circuit in linkage.motion(samples=720, input=driver):
        for centre in circuit.dead_centres:
            rows = (circuit.branch == centre.branch) & (circuit.status == "ok")
            if circuit.input_range is not None:
                assert circuit.input_range[0] <= centre.input <= circuit.input_range[1]
            if centre.kind == "input" or not rows.any():
                continue
            pose = linkage.output([centre.input], 1, input=driver)
            mode = circuit.mode[rows][0]
            # so near a limit of the input that both poses are one
            if np.abs(wrapped(pose.position[0] - pose.position[1])) < 1e-3:
                continue
            assert np.abs(wrapped(pose.position[mode, 0] - centre.output)) < 1e-9
            assert np.abs(pose.velocity[mode, 0]) < 1e-7


@laws
@given(linkages, drivers)
def test_rows_are_the_closed_form_on_their_branch(description: Dimensions | Drawing, driver: str) -> None:
    linkage = description.linkage()
    for circuit in linkage.motion(samples=60, input=driver, speed=1.5):
        rows = np.flatnonzero((circuit.condition < 1e4) & (circuit.status == "ok"))
        output = linkage.output(circuit.input[rows], 3, 1.5, input=driver)
        mode = circuit.mode[rows], np.arange(rows.size)
        column = circuit.output_column
        assert np.abs(wrapped(output.position[mode] - circuit.q[rows, column])).max(initial=0) < 1e-11
        for got, want in (
            (circuit.dq, output.velocity),
            (circuit.ddq, output.acceleration),
            (circuit.dddq, output.jerk),
        ):
            np.testing.assert_allclose(got[rows, column], want[mode], rtol=1e-9, atol=1e-9)


@laws
@given(linkages, drivers)
def test_a_law_s_rows_close_or_are_missing_where_the_loop_cannot(
    description: Dimensions | Drawing, driver: str
) -> None:
    reference, linkage = description.reference(), description.linkage()
    t, q, law = to_and_fro()
    for circuit in linkage.motion(input=driver, law=law):
        passes = 1 if circuit.input_range is None else 2
        np.testing.assert_array_equal(circuit.input, np.tile(q, passes))
        np.testing.assert_array_equal(circuit.time, np.tile(t, passes))
        missing = circuit.status == "no-solution"
        assert np.isnan(circuit.output[missing]).all()
        crank, rocker = circuit.q[~missing, 0], circuit.q[~missing, 7]
        assert reference.closure_error(crank, rocker).max(initial=0) < 1e-12
        assert missing[reference.margin(circuit.input, driver) < -1e-12].all()


@laws
@given(linkages, drivers)
def test_a_law_s_sample_has_its_two_poses_on_one_circuit_each(
    description: Dimensions | Drawing, driver: str
) -> None:
    """Two passes of the circuit that holds the input, or one of each of two; no other was there."""
    reference, linkage = description.reference(), description.linkage()
    _, q, law = to_and_fro()
    circuits = linkage.motion(input=driver, law=law).circuits
    found = np.zeros(q.size, dtype=int)
    for circuit in circuits:
        found += np.sum(circuit.status.reshape(-1, q.size) != "no-solution", axis=0)
    margin = reference.margin(q, driver)
    clear = np.abs(margin) > 1e-9
    np.testing.assert_array_equal(found[clear], 2 * (margin[clear] > 0))


def to_and_fro() -> tuple[np.ndarray, np.ndarray, sb.Law]:
    """The input 1.5 sin 2t: times, inputs, and the law."""
    t = np.linspace(0.0, 2.0, 30)
    q = 1.5 * np.sin(2 * t)
    return t, q, sb.Law.of(t, q, 3 * np.cos(2 * t), -6 * np.sin(2 * t), -12 * np.cos(2 * t))


# Extremes and measures


@laws
@given(linkages, drivers)
def test_assembly_modes_are_the_rows_of_the_circuits_there(
    description: Dimensions | Drawing, driver: str
) -> None:
    linkage = description.linkage()
    motion = linkage.motion(samples=12, input=driver)
    for k in range(12):
        theta = TURN * k / 12
        rows = [
            circuit.q[row]
            for circuit in motion
            for row in np.flatnonzero(
                (np.abs(wrapped(circuit.input - theta)) < 1e-9) & (circuit.status == "ok")
            )
        ]
        modes = linkage.assembly_modes(theta, input=driver)
        if abs(description.reference().margin(np.array([theta]), driver)[0]) < 1e-9:
            continue
        assert len(modes) == len(rows)
        if rows:
            apart = np.abs(wrapped(modes.q[:, None] - np.array(rows)[None])).max(axis=2)
            assert apart.min(axis=0).max() < 1e-9
            assert apart.min(axis=1).max() < 1e-9


# Poses that leave the coupler's spin or a ball's turns undefined


def test_a_coupler_parallel_to_the_crank_s_axis_leaves_its_spin_undefined_and_nothing_else() -> None:
    """M = L1 and D = -L3: at zero B lies straight under A, along the crank's axis."""
    dims = Dimensions(250.0, 700.0, 250.0, 550.0, -550.0, 700.0)
    linkage, reference = dims.linkage(), dims.reference()
    for circuit in linkage.motion(samples=72):
        undefined = circuit.status == "turns-undefined"
        upright = np.abs(wrapped(circuit.output)) + np.abs(wrapped(circuit.input)) < 1e-9
        assert undefined[upright].all()
        assert np.isfinite(circuit.q[:, [0, 7]]).all()
        assert np.isfinite(circuit.dddq[:, [0, 7]]).all()
        assert (np.isnan(circuit.q[:, 1:7]).any(axis=1) == undefined).all()
        assert reference.closure_error(circuit.q[:, 0], circuit.q[:, 7]).max() < 1e-14
        trace = circuit.point(2, (10.0, 20.0, 30.0))
        assert (np.isnan(trace.position[:, 0]) == upright).all()
        assert ((trace.status == "spin-undefined") == upright).all()
        assert (circuit.point(1, (10.0, 20.0, 30.0)).status == "ok").all()
        assert (circuit.point(3, (10.0, 20.0, 30.0)).status == "ok").all()
    assert sum(np.sum(c.status == "turns-undefined") for c in linkage.motion(samples=72)) >= 1


# Change points


def folding(ground: float, crank: float, coupler: float, rocker: float) -> Drawing:
    """A planar four-bar drawn with its crank at 1 rad."""
    a, d = crank * np.exp(1j), complex(ground)
    x = (abs(d - a) ** 2 + coupler**2 - rocker**2) / (2 * abs(d - a))
    b = a + (d - a) / abs(d - a) * (x + 1j * np.sqrt(coupler**2 - x**2))
    places = [np.array([z.real, z.imag, 0.0]) for z in (0j, a, b, d)]
    axis = np.array([0.0, 0.0, 1.0])
    return Drawing(places[0], axis, places[1], places[2], places[3], axis)


@pytest.mark.parametrize("driver", DRIVERS)
@pytest.mark.parametrize("lengths", [(2, 1, 2, 1), (1, 1, 2, 2), (2, 1, 1, 2), (2, 2, 1, 1), (3, 1, 2, 2)])
def test_a_circuit_goes_smoothly_through_its_change_points(lengths: tuple[float, ...], driver: str) -> None:
    """Two branches cross there; on the smooth way also the velocity is continuous."""
    drawing = folding(*lengths)
    reference = drawing.reference()
    motion = drawing.linkage().motion(samples=7200, input=driver)
    assert motion.motion_type == "change-point"
    for circuit in motion:
        assert circuit.residual.max() < 1e-12 * reference.size
        assert reference.closure_error(circuit.q[:, 0], circuit.q[:, 7]).max() < 1e-12
        moving = np.flatnonzero(circuit.status == "ok")
        next_to = [
            (i, k)
            for i, k in itertools.pairwise(moving)
            if k - i <= 2 and circuit.branch[i] == circuit.branch[k]
        ]
        calm = [(i, k) for i, k in next_to if np.abs(circuit.ddq[[i, k], circuit.output_column]).max() < 50]
        assert len(calm) > 1000
        before, after = np.array(calm).T
        for values in (circuit.output, circuit.dq[:, circuit.output_column]):
            assert np.abs(values[after] - values[before]).max() < 0.1


def test_the_parallelogram_s_two_circuits_are_the_parallel_and_the_crossed_one() -> None:
    """On the parallel one the rocker turns as the crank does, on the crossed one the other way."""
    motion = folding(2, 1, 2, 1).linkage().motion(samples=360)
    assert [c.turns for c in motion] == [1, 1]
    turns = sorted(np.sign(c.output[-1] - c.output[0]) for c in motion)
    assert turns == [-1, 1]
    parallel = next(c for c in motion if c.output[-1] > c.output[0])
    np.testing.assert_allclose(parallel.output - parallel.input, parallel.output[0], atol=1e-12)
