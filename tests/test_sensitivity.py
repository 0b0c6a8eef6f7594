"""Derivatives by dimensions against those of poses and rates in many digits at changed dimensions."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy import precise_loops, reference_rssr
from evidence.accuracy.precise_loops import PreciseLoop
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.random_linkages import Dimensions
from evidence.fuzz.random_loops import general, prismatic
from sevenbar.errors import NotCoveredError
from sevenbar.measuring.sensitivity import RowsClosure, closure_of, followed, response

#: Change of a dimension in the differences in many digits; their error is its square.
STEP = mp.mpf(10) ** -9


def poses(linkage, input, output, count=5, circuit=0):
    """Closed poses spread over a circuit: the closure, its dimensions, inputs, passive joints, all joints."""
    closure = closure_of(linkage, input, output)
    found = linkage.motion(40, input=input, output=output, method="general").circuits[circuit]
    well = np.flatnonzero((found.status == "ok") & (found.condition < 1e3))
    rows = well[np.linspace(0, len(well) - 1, count).astype(int)]
    p = np.array([dimension.nominal for dimension in closure.dimensions])
    u = followed(closure, p, found.input[rows], closure.passive(found.q[rows]))
    return closure, p, found.input[rows], u, found.q[rows]


@pytest.mark.parametrize(
    ("driver", "other", "dims"),
    [
        ("crank", "rocker", Dimensions(700, 700, 250, 550, 0, 997.4968671630002)),
        ("crank", "rocker", Dimensions(640, -710, 210, 500, 130, 900)),
        ("rocker", "crank", Dimensions(640, -710, 210, 500, 130, 900)),
    ],
)
def test_an_rssr_s_derivatives_by_its_dimensions_are_those_in_80_digits(driver, other, dims):
    closure, p, x, u, _ = poses(dims.linkage(), driver, other)
    found = response(closure, p, x, u, 2)
    with mp.workdps(reference_rssr.DIGITS):
        for k, dimension in enumerate(closure.dimensions):
            value = getattr(dims, dimension.name)
            # both are numbers of double precision, their difference is exact
            high, low = (value + sign * 2.0**-14 for sign in (1, -1))
            sides = [replace(dims, **{dimension.name: v}).reference().precise() for v in (high, low)]
            for row in range(len(x)):
                rates = [side.output((x[row], 1, 0, 0), u[row, 0], driver) for side in sides]
                for order in range(3):
                    slope = float((rates[0][order] - rates[1][order]) / mp.mpf(high - low))
                    size = np.abs(found.by_dimension[order]).max()
                    assert found.by_dimension[order][row, k] == pytest.approx(slope, abs=1e-9 * size)


def precise_rows(loop, values):
    """The fixed transforms of rows R of these numbers in many digits: Tz(offset) Tx(length) Rx(twist)."""
    precise = PreciseLoop(loop)
    precise.fixed = [
        [
            [mp.mpf(1), mp.mpf(0), mp.mpf(0), values[f"length_{i}"]],
            [mp.mpf(0), mp.cos(values[f"twist_{i}"]), -mp.sin(values[f"twist_{i}"]), mp.mpf(0)],
            [mp.mpf(0), mp.sin(values[f"twist_{i}"]), mp.cos(values[f"twist_{i}"]), values[f"offset_{i}"]],
        ]
        for i in range(1, 8)
    ]
    return precise


@pytest.mark.slow
@pytest.mark.parametrize("name", ["seven_r", "random"])
def test_a_7r_s_derivatives_by_its_dimensions_are_those_in_60_digits(name):
    linkage = sb.load("seven_r") if name == "seven_r" else general(np.random.default_rng(4)).linkage()
    closure, p, x, u, q = poses(linkage, "theta_1", "theta_7", count=2)
    found = response(closure, p, x, u, 2)
    loop = Loop.of(linkage)
    with mp.workdps(precise_loops.DIGITS):
        exact = {d.name: mp.mpf(float(v)) for d, v in zip(closure.dimensions, p, strict=True)}
        for k, dimension in enumerate(closure.dimensions):
            sides = [
                precise_rows(loop, exact | {dimension.name: exact[dimension.name] + s * STEP})
                for s in (1, -1)
            ]
            for row in range(len(x)):
                rates = [side.along((x[row], 1, 0, 0), loop.polished(q[row], 0)[0])[6] for side in sides]
                for order in range(3):
                    slope = float((rates[0][order] - rates[1][order]) / (2 * STEP))
                    size = np.abs(found.by_dimension[order]).max()
                    assert found.by_dimension[order][row, k] == pytest.approx(slope, abs=1e-10 * size)


@pytest.mark.parametrize(
    ("name", "input", "output"), [("rssr", "crank", "rocker"), ("seven_r", "theta_1", "theta_7")]
)
def test_rates_by_the_input_are_the_next_rates_of_the_motion(name, input, output):
    linkage = sb.load(name)
    circuit = linkage.motion(24, speed=1.0).circuits[0]
    closure = closure_of(linkage, input, output)
    p = np.array([dimension.nominal for dimension in closure.dimensions])
    found = response(closure, p, circuit.input, closure.passive(circuit.q), 2)
    orders = (circuit.dq, circuit.ddq, circuit.dddq)
    for order, rates in enumerate(orders):
        size = np.abs(rates[:, circuit.output_column]).max()
        np.testing.assert_allclose(
            found.by_input[order], rates[:, circuit.output_column], rtol=0, atol=1e-12 * size
        )


@pytest.mark.slow
def test_slides_and_screws_have_derivatives_too():
    for linkage in (prismatic(2)(np.random.default_rng(3)).linkage(), sb.load("rccc")):
        first, last = linkage.drive.joint, linkage.drive.output
        closure, p, x, u, _ = poses(linkage, first, last)
        found = response(closure, p, x, u, 2)
        for k, dimension in enumerate(closure.dimensions):
            step = 1e-6 * (1.0 if dimension.kind == "angle" else closure.size)
            sides = []
            for sign in (1, -1):
                moved = p.copy()
                moved[k] += sign * step
                sides.append(response(closure, moved, x, followed(closure, moved, x, u), 2).rates)
            for order in range(3):
                slope = (sides[0][order] - sides[1][order]) / (2 * step)
                size = np.abs(found.by_dimension[order]).max()
                np.testing.assert_allclose(found.by_dimension[order][:, k], slope, rtol=0, atol=1e-7 * size)


def test_a_changed_dimension_is_followed_to_a_closed_pose():
    linkage = sb.load("seven_r")
    closure, p, x, u, _ = poses(linkage, "theta_1", "theta_7", count=12)
    moved = p * 1.01
    there = followed(closure, moved, x, u)
    rows = {d.name: v for d, v in zip(closure.dimensions, moved, strict=True)}
    other = sb.from_dh(
        "RRRRRRR",
        **{word: [rows[f"{word}_{i}"] for i in range(1, 8)] for word in ("length", "twist", "offset")},
    )
    joints = np.column_stack([x, there])
    assert Loop.of(other).errors(joints).max() < 1e-12


def test_a_pose_beyond_a_dead_centre_is_no_pose_of_the_same_pass():
    linkage = sb.load("rssr")
    closure = closure_of(linkage, "rocker", "crank")
    p = np.array([dimension.nominal for dimension in closure.dimensions])
    circuit = linkage.motion(720, input="rocker").circuits[0]
    row = int(np.flatnonzero(circuit.status == "ok")[3])
    x, u = circuit.input[row : row + 1], closure.passive(circuit.q[row : row + 1])
    limit = min(circuit.input_range, key=lambda end: abs(end - x[0]))
    beyond = np.array([limit + 0.01 * np.sign(limit - x[0])])
    assert np.isnan(followed(closure, p, beyond, u)).all()


def test_a_planar_loop_keeps_its_offsets_and_twists_and_tells_its_lengths():
    linkage = sb.load("planar_4r")
    closure, p, x, u, _ = poses(linkage, linkage.drive.joint, linkage.drive.output)
    assert isinstance(closure, RowsClosure)
    opening = set(closure.opening(p, x, u))
    assert opening == {f"{word}_{i}" for word in ("offset", "twist") for i in range(1, 5)}


def test_a_drawn_loop_has_no_dimensions_to_tell():
    with pytest.raises(
        NotCoveredError, match=r"drawn as \[\[joint\]\] has places and directions, not dimensions"
    ):
        closure_of(sb.load("rsur"), "crank", "rocker")


def test_the_derivative_by_all_lengths_together_is_nothing():
    for name in ("rssr", "seven_r"):
        linkage = sb.load(name)
        closure, p, x, u, _ = poses(linkage, linkage.drive.joint, linkage.drive.output)
        lengths = np.array([0.0 if d.kind == "angle" else 1.0 for d in closure.dimensions]) * p
        found = response(closure, p, x, u, 2)
        for order in range(3):
            assert np.abs(found.by_dimension[order] @ lengths).max() < 1e-12 * math.pi
