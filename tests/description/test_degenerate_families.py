"""Families that come near a degenerate linkage, down to 1e-12 of it: continuous, or told.

Source: Grashof's rule for planar four-bars, stationary distances of the circles of an RSSR, Bennett's condition; and
continuity: what is `off` by so much lies within what `off` allows of the degenerate linkage's own answer.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import sevenbar as sb
from beside_change_points import critical
from evidence.fuzz.random_loops import SPECIAL, Rows, drawn, rows
from sevenbar.reporting.how_found import how_found
from strategies import wrapped

#: How far from degenerate, in parts of the size or radians.
OFF = [10.0**-k for k in range(1, 13)]

#: Inputs [rad] at which modes are counted.
AT = [0.0, 0.4, 2.0, -1.1]

#: Up to the first redundant constraints agree, from the second on they do not: between these it is told which do not. Misfits
#: up to the third [rad, or parts of the size] are told.
AGREE, DISAGREE, TOLD = 1e-10, 1e-7, 1e-6


def told(linkage: sb.Linkage, **options: object) -> sb.Motion:
    """The motion, each row of it with numbers as its status says."""
    motion = linkage.motion(36, **options)  # type: ignore[arg-type]
    for circuit in motion:
        good = circuit.status == "ok"
        assert np.isfinite(circuit.q[good]).all()
        assert np.isfinite(circuit.dddq[good]).all()
        low, high = circuit.input_range or (0.0, 2 * np.pi)
        # rows of a circuit that is hardly wider than rounding may be lost, with their status
        lost = ["no-solution"] if high - low < 1e-6 else []
        assert np.isin(circuit.status, ["ok", "dead-centre", "change-point", "turns-undefined", *lost]).all()
        # where two branches meet, the closure is known to the root of a rounding
        allowed = 1e-7 if circuit.motion_type == "change-point" else 2e-9 if motion.redundant else 1e-10
        assert np.nanmax(circuit.residual) < allowed * circuit.size
    return motion


# Grashof's boundary


def four_bar(ground: float, crank: float, coupler: float, rocker: float, angle: float = 1.0) -> sb.Linkage:
    """Four parallel axes, drawn at a crank angle."""
    a, d = crank * np.exp(1j * angle), complex(ground)
    along = (d - a) / abs(d - a)
    x = (abs(d - a) ** 2 + coupler**2 - rocker**2) / (2 * abs(d - a))
    b = a + along * (x + 1j * np.sqrt(coupler**2 - x**2))
    return sb.from_axes(
        [{"kind": "R", "at": (z.real, z.imag, 0.0), "axis": (0, 0, 1)} for z in (0j, a, b, d)]
    )


def grashof(ground: float, crank: float, coupler: float, rocker: float) -> tuple[str, int]:
    """The motion type and the number of circuits by Grashof's rule."""
    links = sorted([ground, crank, coupler, rocker])
    if links[0] + links[3] > links[1] + links[2]:
        return "double-rocker", 1
    shortest = {
        ground: "double-crank",
        crank: "crank-rocker",
        rocker: "rocker-crank",
        coupler: "double-rocker",
    }
    return shortest[links[0]], 2


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("changed", range(4))
@pytest.mark.parametrize(
    "lengths", [(3, 1, 2, 2), (2, 1, 2, 1), (1.5, 1, 2.25, 1.75), (1, 1.4, 2, 1.6), (2.5, 2, 1, 1.5)]
)
def test_a_planar_four_bar_beside_grashof_s_boundary_has_the_type_of_its_side(
    lengths: tuple[float, ...], changed: int, side: int
) -> None:
    told_as_change_point = []
    for off in OFF:
        links = [length + side * off * (k == changed) for k, length in enumerate(lengths)]
        motion = told(four_bar(*links, angle=0.7))
        if motion.motion_type == "change-point":
            told_as_change_point.append(off)
            continue
        assert (motion.motion_type, len(motion.circuits)) == grashof(*links), off
    # the boundary is told where it is reached, not far from it
    assert all(off < 1e-6 for off in told_as_change_point)


def test_limits_beside_grashof_s_boundary_close_as_the_square_root() -> None:
    gaps = []
    for off in OFF:
        limits = told(four_bar(3 + off, 1, 2, 2)).limits
        assert limits.size == 2
        gaps.append(limits[1] - limits[0])
        # by the law of cosines: coupler and rocker are stretched between crank and ground
        cosine = (1 + (3 + off) ** 2 - 16) / (2 * (3 + off))
        assert gaps[-1] == pytest.approx(2 * np.arccos(-cosine), rel=1e-3)
    ratios = np.array(gaps[:-1]) / np.array(gaps[1:])
    np.testing.assert_allclose(ratios[3:], np.sqrt(10), rtol=1e-3)


@pytest.mark.parametrize("driver", ["crank", "rocker"])
def test_an_rssr_beside_a_change_point_has_the_type_of_its_side_until_it_is_told_to_be_there(
    driver: str,
) -> None:
    rng = np.random.default_rng(21)
    for _ in range(12):
        at = critical(rng, 0.0)
        for side in (1, -1):
            types, counts = [], []
            for off in [*OFF[2:], 1e-13, 1e-14, 1e-15]:
                beside = type(at)(at.M, at.N, at.L1, at.L3, at.D, at.L2 * (1 + side * off))
                motion = told(beside.linkage(), input=driver)
                types.append(motion.motion_type)
                counts.append(len(motion.circuits))
            first_told = types.index("change-point") if "change-point" in types else len(types)
            # once it is told it stays told, and not sooner than at limits 1e-6 rad apart
            assert set(types[first_told:]) <= {"change-point"}
            assert first_told >= 4
            assert first_told < len(types)
            # one type all the way, from where no other change point lies between
            assert len(set(types[3:first_told])) == 1, types
            assert len(set(counts[3:first_told])) == 1, counts


# Redundant constraints that stop to agree

BENNETT = (0.3, float(np.arcsin(2 * np.sin(0.3))))


def bennett_off(what: str) -> Callable[[float], sb.Linkage]:
    def linkage(off: float) -> sb.Linkage:
        length, twist, offset = [1.0, 2.0, 1.0, 2.0], [*BENNETT, *BENNETT], [0.0] * 4
        {"length": length, "twist": twist, "offset": offset}[what][1] += off
        return sb.from_dh("RRRR", length=length, twist=twist, offset=offset)

    return linkage


def opened_four_bar(off: float) -> sb.Linkage:
    """One of four parallel axes leans."""
    places = [(0.0, 0.0), (0.6, 0.8), (2.4, 3.2), (3.5, 0.0)]
    axes = [(0, np.sin(off), np.cos(off)) if k == 2 else (0, 0, 1) for k in range(4)]
    return sb.from_axes(
        [{"kind": "R", "at": (*at, 0.0), "axis": axis} for at, axis in zip(places, axes, strict=True)]
    )


@pytest.mark.parametrize(
    "family", [bennett_off("length"), bennett_off("twist"), bennett_off("offset"), opened_four_bar],
    ids=["length", "twist", "offset", "axis that leans"],
)  # fmt: skip
def test_an_overconstrained_loop_moves_until_its_condition_is_broken_and_then_does_not(
    family: Callable[[float], sb.Linkage],
) -> None:
    whole = told(family(0.0))
    assert len(whole.circuits) >= 1
    modes = [len(family(0.0).assembly_modes(at)) for at in AT]
    for off in [*OFF, *(-off for off in OFF)]:
        linkage = family(off)
        motion = told(linkage)
        misses = motion.search.open_by.size > 0
        if abs(off) >= DISAGREE:
            assert motion.motion_type in {"rigid", "cannot-assemble"}, off
            assert not motion.circuits
            assert misses or abs(off) > TOLD, off
            continue
        if abs(off) <= AGREE:
            assert [len(linkage.assembly_modes(at)) for at in AT] == modes, off
            assert not misses
        # between, no circuit is lost without a word
        assert misses or len(motion.circuits) == len(whole.circuits), off
        if motion.circuits:
            assert motion.motion_type == whole.motion_type
        for circuit in motion:
            apart = [np.abs(wrapped(circuit.output - exact.output)).max() for exact in whole]
            assert min(apart) < 100 * abs(off) + 1e-12, off


def test_a_leaning_four_bar_that_agrees_in_one_circuit_only_says_by_how_much_the_other_misses() -> None:
    motion = told(opened_four_bar(1e-9))
    assert len(motion.circuits) == 1
    # crossed over, coupler and rocker lean to different sides: by twice the angle at most, and the gap comes to it
    open_by = motion.search.open_by
    assert 1e-9 < open_by[0] < open_by[-1] < np.hypot(2e-9, 2e-9)
    assert f"miss by {open_by[0]:.1e} to {open_by[-1]:.1e} (rad" in how_found(motion)
    # at one input, too
    modes = motion.linkage.assembly_modes(0.3)
    assert len(modes) == 1
    assert open_by[0] <= modes.open_by[0] <= open_by[-1]


@pytest.mark.parametrize("beyond", [1e-4, 1e-6, 1e-8, 1e-9])
def test_a_planar_four_bar_has_no_mode_beyond_a_dead_centre_by_however_little(beyond: float) -> None:
    # by the law of cosines: coupler and rocker are stretched between crank and ground
    limit = np.arccos((1 + 3.5**2 - 16) / (2 * 3.5))
    linkage = four_bar(3.5, 1, 2, 2, angle=0.5)
    drawn = 0.5
    assert len(linkage.assembly_modes(limit - beyond - drawn)) == 2
    assert len(linkage.assembly_modes(limit + beyond - drawn)) == 0


# Special geometry of loops that move with and without it


def perturbed(case: Rows, off: float, rng: np.random.Generator) -> sb.Linkage:
    """Rows whose zeros and right angles are off; the known pose is closed again by the lengths at its end."""
    inner = len(case.kinds) - 2
    return rows(
        rng,
        case.kinds,
        case.length[:inner] + off * (case.length[:inner] == 0),
        case.twist[:inner] + off,
        case.offset[1:-2] + off * (case.offset[1:-2] == 0),
        case.pose[1:-2],
    ).linkage()


@pytest.mark.parametrize(
    "name",
    [
        "three parallel axes",
        "intersecting neighbours",
        "spherical wrist",
        "zero lengths",
        "right twists",
        "coaxial",
    ],
)
def test_special_geometry_that_is_off_a_little_has_the_circuits_of_the_special_one(name: str) -> None:
    compared = 0
    for seed in range(6):
        case = SPECIAL[name](np.random.default_rng([51, seed]))
        assert isinstance(case, Rows)
        whole = told(perturbed(case, 0.0, np.random.default_rng(seed)))
        firm = whole.limits.size < 2 or np.diff(whole.limits).min() > 1e-3
        for off in OFF[5:]:
            motion = told(perturbed(case, off, np.random.default_rng(seed)))
            if whole.motion_type in {"change-point", "mixed"} or not firm:
                continue
            # a circuit less than 1e-3 rad wide may open or close on the way
            assert motion.motion_type == whole.motion_type, (seed, off)
            assert len(motion.circuits) == len(whole.circuits), (seed, off)
            assert (motion.limits.size > 0) == (whole.limits.size > 0)
            if whole.limits.size:
                # circuits may have had a limit in common; one moves by the square root where it is near another
                apart = np.abs(wrapped(motion.limits[:, None] - whole.limits))
                assert apart.min(axis=0).max() < 30 * np.sqrt(off), (seed, off)
                assert apart.min(axis=1).max() < 30 * np.sqrt(off), (seed, off)
            compared += 1
    assert compared > 6


# Joints that come near each other


def near_joints(kind: str, off: float) -> list[dict[str, object]]:
    joints: dict[str, list[dict[str, object]]] = {
        # the ball comes onto the crank's axis, the coupler to nothing, the axes of U onto one line
        "ball on an axis": [
            {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
            {"kind": "S", "at": (off, 0, 1)},
            {"kind": "S", "at": (3, 1, 0)},
            {"kind": "R", "at": (3, 0, 0), "axis": (1, 0, 0)},
        ],
        "two balls": [
            {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
            {"kind": "S", "at": (1, 0, 1)},
            {"kind": "S", "at": (1, off, 1)},
            {"kind": "P", "at": (3, 0, 0), "axis": (1, 1, 0)},
        ],
        "axes of a U": [
            {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
            {"kind": "S", "at": (1, 0, 1)},
            {"kind": "U", "at": (2, 2, 0), "axes": [(1, 0, 0), (np.cos(off), np.sin(off), 0)]},
            {"kind": "R", "at": (3, 0, 0), "axis": (0, 1, 0.5)},
        ],
        "C beside R": [
            {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
            {"kind": "C", "at": (off, 0, 1), "axis": (0, off, 1)},
            {"kind": "C", "at": (2, 2, 0), "axis": (0, 1, 0)},
            {"kind": "C", "at": (3, 0, 0), "axis": (1, 0, 0.3)},
        ],
        "U and S in one place": [
            {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
            {"kind": "U", "at": (1, 0, 1), "axes": [(1, 0, 0), (0, 1, 0)]},
            {"kind": "S", "at": (1 + off, 2 * off, 1 - off)},
            {"kind": "R", "at": (3, 0, 0), "axis": (0, 1, 0.5)},
        ],
    }  # fmt: skip
    return joints[kind]


@pytest.mark.parametrize(
    "kind",
    [
        *("ball on an axis", "axes of a U", "C beside R"),
        *(kind for kind in ("two balls", "U and S in one place")),
    ],
)
def test_joints_that_nearly_fall_together_are_analysed_or_refused_in_words(kind: str) -> None:
    answered = 0
    for off in [*OFF, 0.0]:
        try:
            linkage = sb.from_axes(near_joints(kind, off))
            mobility = linkage.mobility()
            motion = told(linkage)
        except sb.errors.SevenbarError as error:
            assert "; " in str(error)
            continue
        assert mobility.gruebler == mobility.freedoms - 6
        if motion.circuits:
            answered += 1
            # a crank near nothing is followed by its closed form where the count has it spin about itself
            assert mobility.finite == 1 or (kind == "ball on an axis" and off < 1e-6)
    assert answered >= 4


@pytest.mark.parametrize("off", OFF)
def test_screws_of_vanishing_pitch_turn_as_hinges(off: float) -> None:
    joints = [dict(joint) for joint in drawn(np.random.default_rng(53), "RCCC").joints]
    hinge = sb.from_axes(joints).assembly_modes(0.0)
    joints[0] |= {"kind": "H", "pitch": off}
    screw = sb.from_axes(joints).assembly_modes(0.0)
    # at the drawn pose the screw has not advanced: the drawn mode is among those that a search finds
    assert len(hinge) >= 1
    assert np.abs(screw.q).max(axis=1).min() < 1e-9


def test_seven_axes_at_right_angles_whose_circuits_run_into_a_surface_are_found_within_bounds():
    """Links of lengths 1 and 0 in turn: circuits near the folded pose as the cube of what is left to it."""
    rows = {"length": [1, 0] * 3 + [1], "twist": ["90 deg", "-90 deg"] * 3 + [0], "offset": [0] * 7}
    motion = sb.from_dh("R" * 7, **rows).motion(36)
    assert motion.motion_type == "change-point"
    assert len(motion) >= 16
    assert sum(circuit.closed for circuit in motion) == 4
    assert max(float(np.nanmax(circuit.residual)) for circuit in motion) < 1e-12
    # both freedoms of the surface, and the ends of the circuits that run into it
    assert max(point.freedoms for point in motion.change_points) == 2
    assert 0 < motion.search.unfollowed < 100
