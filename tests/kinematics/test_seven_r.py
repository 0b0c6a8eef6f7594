"""The 7R paper's linkage: eight modes, eight circuits, and its point's path, velocity and acceleration.

Source: the dimensions and the point (-100, -90, -80) on link 4 of the 7R paper; the modes and their derivatives at
two inputs in tests/references/seven_r_modes.json, computed with 40 digits from the closure.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from places import REFERENCES

REFERENCE = json.loads((REFERENCES / "seven_r_modes.json").read_text(encoding="utf-8"))

POINT = (-100.0, -90.0, -80.0)
SAMPLES = 360

#: Of joint rates, of the point's path, velocity, acceleration.
RELATIVE = 1e-9


@pytest.fixture(scope="module")
def linkage() -> sb.Linkage:
    return sb.from_dh(
        "RRRRRRR",
        length=REFERENCE["length"],
        twist=np.radians(REFERENCE["twist_deg"]),
        offset=REFERENCE["offset"],
    )


@pytest.fixture(scope="module")
def motion(linkage: sb.Linkage) -> sb.Motion:
    return linkage.motion(samples=SAMPLES)


def apart(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Differences of angles."""
    return np.abs((np.asarray(first) - second + np.pi) % (2 * np.pi) - np.pi)


def row_of(motion: sb.Motion, theta: np.ndarray) -> tuple[sb.Circuit, int]:
    """The circuit and its row at a pose."""
    distances = [apart(circuit.q, theta).max(axis=1) for circuit in motion]
    best = int(np.argmin([d.min() for d in distances]))
    return motion.circuits[best], int(distances[best].argmin())


def test_it_has_eight_modes_at_every_input(linkage: sb.Linkage) -> None:
    loop = Loop.of(linkage)
    for theta in np.radians(np.arange(0, 360, 10)):
        modes = linkage.assembly_modes(theta)
        assert len(modes) == 8
        assert loop.errors(modes.q).max() < 1e-12


def test_its_modes_are_those_of_forty_digits(linkage: sb.Linkage) -> None:
    for angle in sorted({mode["theta1_deg"] for mode in REFERENCE["modes"]}):
        want = np.array([m["theta"] for m in REFERENCE["modes"] if m["theta1_deg"] == angle])
        got = linkage.assembly_modes(np.radians(angle)).q
        distance = apart(got[:, None], want).max(axis=2)
        assert sorted(distance.argmin(axis=1)) == list(range(8))
        assert distance.min(axis=1).max() < 1e-12


def test_it_has_eight_closed_circuits_and_each_is_a_double_crank(motion: sb.Motion) -> None:
    assert len(motion.circuits) == 8
    assert motion.motion_type == "double-crank"
    assert len(motion.limits) == 0
    for circuit in motion:
        assert circuit.closed
        assert circuit.turns == 1
        assert circuit.motion_type == "double-crank"
        assert len(circuit.q) == SAMPLES
        assert not [d for d in circuit.dead_centres if d.kind == "input"]
        assert (circuit.status == "ok").all()
        assert circuit.input_range is None
        assert circuit.output_range is None


def test_every_row_closes_and_no_two_circuits_meet(linkage: sb.Linkage, motion: sb.Motion) -> None:
    loop = Loop.of(linkage)
    rows = np.array([circuit.q for circuit in motion])
    assert loop.errors(rows.reshape(-1, 7)).max() < 1e-12
    assert max(circuit.residual.max() for circuit in motion) < 1e-12 * loop.size
    for k in range(SAMPLES):
        here = [q[apart(q[:, 0], 2 * np.pi * k / SAMPLES).argmin()] for q in rows]
        between = apart(np.array(here)[:, None], np.array(here)).max(axis=2) + np.eye(8)
        assert between.min() > 1e-3


def test_the_last_row_of_each_circuit_leads_to_its_first(motion: sb.Motion) -> None:
    for circuit in motion:
        h = 2 * np.pi / SAMPLES
        following = np.roll(circuit.q, -1, axis=0)
        forward = circuit.q + h * (circuit.dq + h / 2 * (circuit.ddq + h / 3 * circuit.dddq))
        jumps = apart(forward, following).max(axis=1)
        assert jumps.max() < 1e-4
        assert jumps[-1] < 1e-6 + 10 * jumps[:-1].max()


@pytest.mark.parametrize(
    "reference", REFERENCE["modes"], ids=lambda m: f"{m['theta1_deg']} {m['theta'][1]:.2f}"
)
def test_joint_rates_and_the_path_velocity_and_acceleration_of_the_point(
    motion: sb.Motion, reference: dict[str, Any]
) -> None:
    circuit, row = row_of(motion, np.array(reference["theta"]))
    trace = circuit.point(link=4, at=POINT)
    assert apart(circuit.q[row], reference["theta"]).max() < 1e-12
    for got, name in (
        (circuit.dq[row], "dtheta"),
        (circuit.ddq[row], "ddtheta"),
        (trace.position[row], "r4"),
        (trace.velocity[row], "v4"),
        (trace.acceleration[row], "a4"),
    ):
        want = np.array(reference[name])
        assert np.abs(got - want).max() < RELATIVE * np.abs(want).max(), name


def test_rates_follow_the_speed_of_the_drive(linkage: sb.Linkage, motion: sb.Motion) -> None:
    fast = linkage.motion(samples=SAMPLES, speed=10.0)
    for reference in REFERENCE["modes"]:
        slow_circuit, slow_row = row_of(motion, np.array(reference["theta"]))
        circuit, row = row_of(fast, np.array(reference["theta"]))
        for power, name in ((1, "dq"), (2, "ddq"), (3, "dddq")):
            got, want = getattr(circuit, name)[row], 10.0**power * getattr(slow_circuit, name)[slow_row]
            np.testing.assert_allclose(got, want, rtol=1e-9, atol=1e-9 * np.abs(want).max())


@pytest.mark.parametrize("samples", [90, 720])
def test_the_number_of_samples_changes_no_circuit(
    linkage: sb.Linkage, motion: sb.Motion, samples: int
) -> None:
    other = linkage.motion(samples=samples)
    assert len(other.circuits) == 8
    step = 2 * np.pi / np.gcd(samples, SAMPLES)
    assigned = set()
    for circuit in motion:
        found = set()
        for q in circuit.q:
            if abs(q[0] / step - round(q[0] / step)) < 1e-9:
                same, row = row_of(other, q)
                assert apart(same.q[row], q).max() < 1e-9
                found.add(same.index)
        assert len(found) == 1
        assigned |= found
    assert assigned == set(range(8))


def test_forward_differences_of_the_path_approach_the_exact_velocity_in_first_order(
    linkage: sb.Linkage,
) -> None:
    """The paper's way: (r(k + 1) - r(k)) / dt, the last against the first."""
    errors = []
    for samples in (90, 360):
        worst = 0.0
        for circuit in linkage.motion(samples=samples):
            trace = circuit.point(link=4, at=POINT)
            differences = (np.roll(trace.position, -1, axis=0) - trace.position) * samples / (2 * np.pi)
            worst = max(worst, float(np.abs(differences - trace.velocity).max()))
        errors.append(worst)
    assert 3 < errors[0] / errors[1] < 5


@pytest.mark.parametrize("name", ["seven_r", "myard_5r", "rsur"])
def test_a_negative_speed_runs_a_circuit_that_goes_round_with_falling_input(name):
    """Row by row the same poses from the other end, rates of the other sign, times that rise."""
    forwards, backwards = (sb.load(name).motion(speed=speed) for speed in (2.0, -2.0))
    for there, back in zip(forwards, backwards, strict=True):
        count = len(there.time)
        assert there.turns
        order = np.append(0, np.arange(count - 1, 0, -1))
        np.testing.assert_allclose(back.input, -there.input, atol=1e-12)
        turned = (back.q - there.q[order] + np.pi) % (2 * np.pi) - np.pi
        np.testing.assert_allclose(turned, 0, atol=1e-9)
        np.testing.assert_allclose(back.dq, -there.dq[order], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(back.ddq, there.ddq[order], rtol=1e-9, atol=1e-7)
        assert (np.diff(back.time) > 0).all()
        # the rate is the slope over the time that goes by
        slope = np.gradient(back.output, back.time)[1:-1]
        np.testing.assert_allclose(slope, back.dq[1:-1, back.output_column], atol=2e-3)
        one, other = there.point(1, (1.0, 2.0, 3.0)), back.point(1, (1.0, 2.0, 3.0))
        np.testing.assert_allclose(other.position, one.position[order], atol=1e-9)
        np.testing.assert_allclose(other.velocity, -one.velocity[order], atol=1e-7)
