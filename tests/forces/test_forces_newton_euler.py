"""Torque, reactions and their flags beside Newton's and Euler's equations of the whole linkage, which share no formula."""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.precise_loops import DIGITS
from evidence.accuracy.reference_forces import Forces
from evidence.fuzz.loaded_loops import SAMPLES, Loaded, loaded_loop
from evidence.fuzz.loadings import random_loading
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.loop.rigid import half_turn

#: Torque, forces and moments agree to this part of the row's greatest while the condition of the whole system
#: of equations is below `WELL`; above, the tolerance grows with it.
CLOSE = 1e-11
WELL = 1e4

#: Rows judged of each loop.
ROWS = 3


@dataclass(frozen=True, eq=False)
class Judged:
    """One row beside the reference: the greatest error in parts of the greatest force, and where it may be."""

    error: float
    condition: float
    told: str

    @property
    def tolerable(self) -> float:
        """The tolerance."""
        return CLOSE * max(1.0, self.condition / WELL)


def forces(loaded: Loaded) -> sb.Forces:
    """As the product works them out."""
    loading = loaded.loading
    return loaded.circuit.forces(
        bodies=loading.bodies, gravity=loading.gravity, loads=loading.loads, springs=loading.springs
    )


def columns_of(got: sb.Forces, loaded: Loaded) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Moments and forces (n, joints, 3), flags (joints, 6)."""
    reactions = [got.reactions[joint.name] for joint in loaded.linkage.joints]
    return (
        np.stack([r.moment for r in reactions], axis=1),
        np.stack([r.force for r in reactions], axis=1),
        np.array([r.determinate for r in reactions]),
    )


def axes_of(got: sb.Forces, loaded: Loaded, row: int) -> np.ndarray:
    """The axes (joints, 3, 3) along which reactions are told, found right."""
    found = np.array([got.reactions[joint.name].axes[row] for joint in loaded.linkage.joints])
    motion, q = loaded.reference().motion, loaded.circuit.q[row]
    links, _, _ = motion.carried(q, 0 * q[None], 0 * q[None])
    for k, (joint, axes) in enumerate(zip(loaded.linkage.joints, found, strict=True)):
        last = loaded.linkage.form == "drawn" and k + 1 == len(found)
        # the last joint of a drawing counts backwards; its axes are those that are written
        turn = half_turn(joint.row.half_turn)[:3, :3] if last else np.eye(3)
        assert np.abs(axes - motion.joint_frame(links, k)[0] @ turn).max() < 1e-12, joint.name
    return found


def judged(loaded: Loaded, got: sb.Forces, row: int, want: Forces) -> Judged:
    """Everything of one row."""
    moment, force, flags = columns_of(got, loaded)
    mine = loaded.reference()
    length, loop = mine.length, mine.motion.loop
    places, moments, forces, shaking, dq = (
        np.array(array, dtype=np.float64)
        for array in (want.places, want.moment, want.force, want.shaking, want.dq)
    )
    # least-norm parts of what is open are no scale
    known = np.where(want.determinate, np.concatenate([moments / length, forces], axis=1), 0.0)
    unit = length if loaded.circuit.input_turns else 1.0
    scale = max(np.abs(known).max(), abs(float(want.torque)) / unit)
    told = np.concatenate([moment[row] / length, force[row]], axis=1)
    assert np.isnan(told[~flags]).all(), "an open component has a number"
    # the moment of shaking about the origin grows with how far away that is
    shaken = max(scale, np.abs(shaking[:3]).max() / length, np.abs(shaking[3:]).max())
    speed = float(np.abs(dq * np.where(loop.turns != 0, length, loaded.metre)).max())
    energy = abs(float(want.kinetic)) + abs(float(want.potential)) + scale * length
    at = np.array([got.reactions[joint.name].at[row] for joint in loaded.linkage.joints])
    errors = [
        np.abs(np.where(flags, told - known, 0.0)).max() / scale,
        abs(got.torque[row] - float(want.torque)) / unit / scale,
        np.abs(at * loaded.metre - places).max() / max(length, np.abs(places).max()),
        np.abs(got.shaking[row, :3] - shaking[:3]).max() / length / shaken,
        np.abs(got.shaking[row, 3:] - shaking[3:]).max() / shaken,
        abs(got.kinetic[row] - float(want.kinetic)) / energy,
        abs(got.potential[row] - float(want.potential)) / energy,
        abs(got.supplied[row] - float(want.loss)) / max(scale * speed + abs(float(want.loss)), 1e-300),
    ]
    kinds = "".join(joint.kind for joint in loaded.linkage.joints)
    worst = int(np.argmax(errors))
    return Judged(
        float(max(errors)), want.condition, f"{loaded.family}, {kinds}, row {row}, quantity {worst}"
    )


def in_sixty_digits(loaded: Loaded, got: sb.Forces, row: int) -> Forces:
    """The reference at a row's input, its pose found anew."""
    angle, *rates = (
        float(array[row, loaded.circuit.input_column])
        for array in (loaded.circuit.q, loaded.circuit.dq, loaded.circuit.ddq)
    )
    with mp.workdps(DIGITS):
        precise = loaded.reference(precise=True)
        q = precise.motion.pose(loaded.circuit.q[row], mp.mpf(angle))
        return precise.at(q, *map(mp.mpf, rates), axes_of(got, loaded, row))


def wrong_of(seed: int, numbers: range) -> tuple[list[str], int, int]:
    """What is wrong in loops of a seed, how many were judged, and how many of their rows were well conditioned."""
    wrong, count, well = [], 0, 0
    for number in numbers:
        loaded = loaded_loop(seed, number)
        if loaded is None:
            continue
        count += 1
        rng = np.random.default_rng((seed, number, 1))
        reference, got = loaded.reference(), forces(loaded)
        rows = rng.choice(loaded.rows, min(ROWS, loaded.rows.size), replace=False)
        flags = np.ones((len(loaded.linkage.joints), 6), bool)
        for row in rows:
            rates = (
                array[row, loaded.circuit.input_column] for array in (loaded.circuit.dq, loaded.circuit.ddq)
            )
            want = reference.at(loaded.circuit.q[row], *rates, axes_of(got, loaded, int(row)))
            flags &= want.determinate
            one = judged(loaded, got, int(row), want)
            well += one.condition < WELL
            if one.error >= one.tolerable and one.condition >= WELL and not want.open:
                # the reference loses digits, too: more of them decide
                one = judged(loaded, got, int(row), in_sixty_digits(loaded, got, int(row)))
            if not one.error < one.tolerable:
                wrong.append(f"{number}: {one.error:.1e} at condition {one.condition:.0f}: {one.told}")
        _, _, told = columns_of(got, loaded)
        if not np.array_equal(flags, told):
            wrong.append(f"{number}: flags {loaded.family}: {np.argwhere(flags != told).tolist()}")
    return wrong, count, well


@pytest.mark.parametrize("part", [0, *(pytest.param(k, marks=pytest.mark.proof) for k in range(1, 8))])
def test_random_loops_are_those_of_newton_and_euler(part: int) -> None:
    wrong, count, well = wrong_of(21, range(150 * part, 150 * part + 150))
    assert not wrong, "\n".join(wrong)
    assert count >= 125
    assert well > 2 * count


def test_ten_random_loops_are_those_of_sixty_digits() -> None:
    count = number = 0
    while count < 10:
        # every other family, so that ten come from all over
        number += 2
        loaded = loaded_loop(22, number)
        if loaded is None or loaded.linkage.mobility().redundant:
            # an overconstrained loop whose numbers have sixteen digits closes to sixteen
            continue
        count += 1
        got, row = forces(loaded), int(loaded.rows[loaded.rows.size // 2])
        one = judged(loaded, got, row, in_sixty_digits(loaded, got, row))
        assert one.error < one.tolerable, one


#: Which of moment x, y, z and force x, y, z equilibrium determines in every joint.
KNOWN = {
    "planar_4r": "001110",
    "bennett": "001000",
    "goldberg_5r": "001000",
    "spherical_4r": "111000",
    "seven_r": "111111",
    "rssr": "111111",
    "rscr": "111111",
    "rsur": "111111",
    "rccc": "111111",
    "rssp": "111111",
}


def gallery(name: str, seed: int = 3) -> Loaded:
    """A linkage of the gallery with random bodies."""
    linkage = sb.load(name)
    circuit = linkage.motion(SAMPLES).circuits[0]
    return Loaded(name, linkage, circuit, random_loading(np.random.default_rng(seed), linkage))


@pytest.mark.parametrize("name", [*KNOWN, "sarrus", "bricard_line", "bricard_plane", "bricard_trihedral", "myard_5r",
                                  "screw_drill", "universal_joint", "swash_plate", "five_bar", "six_bar"])  # fmt: skip
def test_gallery_linkages_are_those_of_newton_and_euler(name: str) -> None:
    loaded = gallery(name)
    got, reference = forces(loaded), loaded.reference()
    everywhere = np.ones((len(loaded.linkage.joints), 6), bool)
    for row in loaded.rows:
        rates = (array[row, loaded.circuit.input_column] for array in (loaded.circuit.dq, loaded.circuit.ddq))
        want = reference.at(loaded.circuit.q[row], *rates, axes_of(got, loaded, int(row)))
        one = judged(loaded, got, int(row), want)
        assert one.error < one.tolerable, one
        everywhere &= want.determinate
    _, _, flags = columns_of(got, loaded)
    assert np.array_equal(flags, everywhere)
    if name in KNOWN:
        assert ["".join("01"[flag] for flag in row) for row in flags.astype(int)] == [KNOWN[name]] * len(
            flags
        )


def test_what_is_open_in_sarrus_are_moments_about_one_direction() -> None:
    loaded = gallery("sarrus")
    moment, force, flags = columns_of(forces(loaded), loaded)
    assert flags[:, 2:].all()
    assert (~flags[:, :2]).any(axis=1).all()
    assert np.isfinite(force[loaded.rows]).all()
    assert np.isnan(moment[..., :2][:, ~flags[:, :2]]).all()


@pytest.mark.parametrize("name", ["seven_r", "rssr", "rscr", "rssp", "planar_4r", "bennett", "spherical_4r"])
def test_statics_is_the_derivative_of_potential_energy(name: str) -> None:
    loaded = gallery(name)
    conservative = random_loading(np.random.default_rng(7), loaded.linkage, losses=False)
    slow = loaded.linkage.motion(SAMPLES, speed=1e-30).circuits[0]
    loaded = Loaded(
        name,
        loaded.linkage,
        slow,
        Loading(conservative.gravity, conservative.bodies, (), conservative.springs),
    )
    got = forces(loaded)
    unit = 1.0 if slow.input_turns else loaded.metre
    want = []
    rows = loaded.rows[::4]
    with mp.workdps(DIGITS):
        precise, step = loaded.reference(precise=True), mp.mpf(10) ** -14
        for row in rows:
            angle = mp.mpf(float(slow.q[row, slow.input_column]))
            before, after = (
                precise.potential(precise.motion.pose(slow.q[row], angle + side * step)) for side in (-1, 1)
            )
            want.append(float((after - before) / (2 * step)) / unit)
    assert got.torque[rows] == pytest.approx(want, rel=0, abs=1e-12 * np.abs(want).max())


def test_a_coupler_that_no_spin_concerns_is_held_by_nothing() -> None:
    """A rod between two balls, or a body symmetric about their line, which frictionless balls never begin to spin."""
    linkage = sb.load("rssr")
    circuit = linkage.motion(SAMPLES).circuits[0]
    length = linkage.lengths[1]
    along, axial = np.diag([0.0, 1.0, 1.0]), np.diag([1.0, 0.0, 0.0])
    rod = sb.Body(1.3, (0.3 * length, 0, 0), 4e-2 * along)
    thick = sb.Body(1.3, (0.3 * length, 0, 0), 4e-2 * along + 3e-3 * axial)
    gravity = (1.0, 2.0, -9.0)
    loaded = Loaded("rod", linkage, circuit, Loading(gravity, {2: (rod,)}))
    reference = loaded.reference()
    for body in (rod, thick):
        got = circuit.forces(bodies={2: body}, gravity=gravity)
        for row in loaded.rows:
            rates = (array[row, circuit.input_column] for array in (circuit.dq, circuit.ddq))
            want = reference.at(circuit.q[row], *rates, axes_of(got, loaded, int(row)))
            one = judged(loaded, got, int(row), want)
            assert one.error < one.tolerable, one
            held = np.linalg.norm(got.reactions["ball_a"].moment[row]) / reference.length
            assert max(held, abs(want.spin[0]) / reference.length) < CLOSE * np.abs(want.force).max()


def test_an_error_that_is_put_in_is_found() -> None:
    loaded = gallery("rscr")
    got = forces(loaded)
    row = int(loaded.rows[1])
    rates = [
        float(array[row, loaded.circuit.input_column]) for array in (loaded.circuit.dq, loaded.circuit.ddq)
    ]
    want = loaded.reference().at(loaded.circuit.q[row], *rates, axes_of(got, loaded, row))
    assert judged(loaded, got, row, want).error < CLOSE
    greatest = float(np.abs(want.force).max())
    for quantity, array in enumerate(
        [got.reactions["cylinder"].force, got.torque, got.reactions["cylinder"].at]
    ):
        kept = array.copy()
        array.setflags(write=True)
        array[row] += 1e-9 * (
            greatest if quantity == 0 else np.abs(array[row]).max() + greatest * loaded.metre
        )
        worse = judged(loaded, got, row, want)
        assert worse.error > CLOSE, quantity
        array[:] = kept
