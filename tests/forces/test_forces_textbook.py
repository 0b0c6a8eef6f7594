"""Forces, sizing and free motion of textbook loops: equal lengths, right angles, change points, and next to these."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from sevenbar.curves.cycle_series import filled
from sevenbar.kinematics.dynamics.free import course_of

G = 9.81
ROD = sb.Body(1.0, solid="rod")
BLOCK = sb.Body(1.0, (0.3, 0.2, 0.5), np.eye(3) * 0.1)


def planar(*places: tuple[float, float]) -> sb.Linkage:
    joints = [{"kind": "R", "at": [x, y, 0.0], "axis": [0, 0, 1]} for x, y in places]
    linkage = sb.from_axes(joints, length_unit="m")
    return linkage.loaded(bodies=dict.fromkeys((1, 2, 3), ROD), gravity=(0, -G, 0))


def parallelogram(width: float = 2.0, off: float = 0.0) -> sb.Linkage:
    return planar((0, 0), (0, 1), (width + off, 1), (width, 0))


def equal_slider_crank() -> sb.Linkage:
    bodies = {1: ROD, 2: ROD, 3: sb.Body(1.0, (1.0, 0.0, 0.0), solid="point")}
    places = [[0.0, 0, 0], [0.5, math.sqrt(0.75), 0], [1.0, 0, 0]]
    joints: list[dict[str, Any]] = [{"kind": "R", "at": at, "axis": [0, 0, 1]} for at in places]
    joints.append({"kind": "P", "at": [1.0, 0, 0], "axis": [1, 0, 0]})
    return sb.from_axes(joints, length_unit="m").loaded(bodies=bodies, gravity=(0, -G, 0))


def spherical(*axes: list[float]) -> sb.Linkage:
    joints = [{"kind": "R", "at": [0, 0, 0], "axis": axis} for axis in axes]
    linkage = sb.from_axes(joints, length_unit="m")
    return linkage.loaded(bodies=dict.fromkeys((1, 2, 3), BLOCK), gravity=(0, 0, -G))


LOOPS = {
    "rhombus": lambda: parallelogram(1.0),
    "parallelogram": parallelogram,
    "kite": lambda: planar((0, 0), (0, 1), (2, 2), (1, 0)),
    "antiparallelogram": lambda: planar((0, 0), (0.6, 0.8), (1.4, 0.8), (2, 0)),
    "slider-crank, crank = rod": equal_slider_crank,
    "spherical right angles": lambda: spherical([1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, 1]),
    "bennett": lambda: sb.bennett(1.0, 2.0, math.radians(30)).loaded(
        bodies=dict.fromkeys((1, 2, 3), BLOCK), gravity=(0, 0, -G)
    ),
}


@pytest.mark.parametrize("name", LOOPS)
def test_a_textbook_loop_keeps_its_energy_through_dead_centres_and_change_points(name: str) -> None:
    for circuit in LOOPS[name]().motion().circuits:
        fall = circuit.free_motion(10.0, energy=1.0)
        assert fall.period is not None
        assert fall.energy_error < 1e-12
        assert len(circuit.equilibria()) >= 2


@pytest.mark.parametrize("samples", [359, 360])
@pytest.mark.parametrize("width", [1.0, 2.0])
def test_a_parallelogram_at_even_speed_takes_the_torque_of_its_weights(width: float, samples: int) -> None:
    # all that moves has constant energy of motion, so torque = dV/dq, V = 2 g cos q for 1 m and 1 kg
    (circuit,) = (
        c for c in parallelogram(width).motion(samples).circuits if np.ptp(c.output - c.input) < 1e-6
    )
    found = circuit.forces().sizing()
    assert found is not None
    assert abs(abs(found.peak_torque.value) - 2 * G) < 1e-8
    assert abs(found.rms_torque - math.sqrt(2) * G) < 1e-8
    # the coupler in line with the links cannot hold the rocker
    assert all(math.isnan(bearing.in_plane.peak.value) for bearing in found.bearings.values())


@pytest.mark.parametrize("samples", [359, 360])
def test_a_slider_crank_that_folds_flat_has_forces_across_its_change_points(samples: int) -> None:
    # circuit with the slide at rest: crank and rod turn as one about the pivot, 2 kg with the centre 0.5 m off
    for circuit in equal_slider_crank().motion(samples).circuits:
        found = circuit.forces().sizing()
        assert found is not None
        at_rest = np.ptp(circuit.output) < 1e-6
        sizes = [bearing.in_plane.peak.value for bearing in found.bearings.values()]
        assert np.isfinite(sizes).all()
        if at_rest:
            assert abs(abs(found.peak_torque.value) - G) < 1e-7


def exact_torque(width: float, off: float, q: float, side: int) -> mp.mpf:
    """`M'(q) / 2 + V'(q)` of that four-bar at 1 rad/s, with B on one side of the line from A to the pivot."""
    width, out = mp.mpf(width), mp.mpf(width + off)
    coupler, rocker = out, mp.hypot(out - width, 1)

    def state(q: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        ax, ay = -mp.sin(q), mp.cos(q)
        dx, dy = ax - width, ay
        d = mp.hypot(dx, dy)
        along = (rocker**2 - coupler**2 + d * d) / (2 * d)
        up = side * mp.sqrt(rocker**2 - along**2)
        rx, ry = (along * dx - up * dy) / d, (along * dy + up * dx) / d
        cx, cy = rx + width - ax, ry - ay
        rate = (-ay * cx + ax * cy) / (-ry * cx + rx * cy)
        vx, vy = -rate * ry, rate * rx
        turn = (cx * (vy - ax) - cy * (vx + ay)) / coupler**2
        middle = ((vx - ay) / 2) ** 2 + ((vy + ax) / 2) ** 2
        inertia = mp.mpf(1) / 3 + rocker**2 * rate**2 / 3 + middle + coupler**2 * turn**2 / 12
        return inertia, mp.mpf(G) * (ay + ry)

    step = mp.mpf(10) ** -15
    (m1, v1), (m0, v0) = state(mp.mpf(q) + step), state(mp.mpf(q) - step)
    return ((m1 - m0) / 2 + v1 - v0) / (2 * step)


@pytest.mark.parametrize("off", [1e-6, -1e-6, 1e-12])
def test_next_to_a_change_point_the_torque_is_as_large_as_forty_digits_say(off: float) -> None:
    (circuit,) = parallelogram(2.0, off).motion().circuits
    forces = circuit.forces()
    sizes = np.abs(np.nan_to_num(forces.torque))
    rows = np.argsort(-sizes)[:6]
    assert sizes[rows[0]] > 100  # beside 2 g
    with mp.workdps(40):
        for k in rows:
            both = [exact_torque(2.0, off, float(forces.input[k]), side) for side in (-1, 1)]
            error = min(abs(float(one - forces.torque[k])) for one in both) / sizes[k]
            # lengths are known to 1e-16, and what the corner's size follows from is their difference
            assert error < 2e-17 * circuit.condition[k] ** 2 + 1e-10


def test_rows_that_are_missing_of_a_smooth_cycle_are_found() -> None:
    x = np.arange(60) * math.tau / 60
    rows = np.stack([np.exp(np.sin(x)), np.cos(3 * x)], axis=1)
    missing = np.isin(np.arange(60), [0, 30, 31])
    known = np.where(missing[:, None], np.nan, rows)
    assert np.abs(filled(known, missing) - rows).max() < 1e-12


def test_the_force_in_the_plane_is_that_of_its_determined_components() -> None:
    forces = sb.load("engine").motion().circuits[0].forces()
    found = forces.sizing()
    assert found is not None
    for name, bearing in found.bearings.items():
        own = forces.reactions[name].force
        rows = np.linalg.norm(own[:, np.isfinite(own).all(axis=0)], axis=1)
        assert math.isnan(bearing.force.peak.value)
        assert rows.max() <= bearing.in_plane.peak.value * (1 + 1e-12) < rows.max() * 1.01
        assert abs(bearing.in_plane.mean_cube - np.mean(rows**3) ** (1 / 3)) < 1e-3 * rows.max()


def test_a_load_that_sets_in_where_the_path_begins_leaves_no_piece_of_rounding() -> None:
    linkage = sb.load("engine")
    circuit = linkage.motion().circuits[0]
    course = course_of(linkage, circuit, linkage.loading).energy
    assert np.diff(course.quantities.edges).min() > 1e-6 * course.length
    assert np.isin(course.breaks, course.quantities.edges).all()
    assert circuit.free_motion(0.5, speed=5.0).energy_error < 1e-9
