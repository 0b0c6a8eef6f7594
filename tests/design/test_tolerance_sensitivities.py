"""Sensitivities against differences of the ordinary analysis, closed forms, and many digits."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from compared_slopes import changed, compare_all, same_circuit
from evidence.accuracy import reference_rssr
from evidence.fuzz.random_linkages import Dimensions
from evidence.fuzz.random_loops import general, prismatic
from sevenbar.description.gallery import loops
from sevenbar.design.tolerance.sensitivities import sensitivities
from sevenbar.errors import RequestError

QUICK = ("rssr", "planar_4r", "universal_joint", "rscr")

#: Loops whose every dimension opens them are told of by name instead.
RIGID = ("bennett", "bricard_line", "bricard_plane", "bricard_trihedral", "goldberg_5r", "myard_5r")


@pytest.mark.parametrize("name", QUICK)
def test_all_derivatives_are_those_of_differences_of_the_analysis(name):
    _, compared = compare_all(sb.load(name))
    assert compared > 400


@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.proof)])
@pytest.mark.parametrize("name", [name for name in loops() if name not in (*QUICK, *RIGID)])
def test_all_derivatives_are_those_of_differences_in_the_whole_gallery(name, every):
    # a drawn joint that lies on the axis before it has a frame with rounding of 1e-10 when it is moved a little
    _, compared = compare_all(sb.load(name), 1e-3 if name == "five_bar" else 3e-5, every)
    assert compared > 400 / every


@pytest.mark.parametrize("output", ["theta_2", "theta_6"])
def test_another_output_and_a_sliding_joint_have_derivatives_too(output):
    linkage = prismatic(2)(np.random.default_rng(3)).linkage()
    _, compared = compare_all(linkage, input=linkage.drive.joint, output=output)
    assert compared > 1000


def test_rows_in_radians_have_derivatives_by_radians():
    linkage = general(np.random.default_rng(4)).linkage()
    found, _ = compare_all(linkage)
    assert {d.unit for d in found.dimensions if d.kind == "angle"} == {"rad"}


def test_a_rocker_that_drives_has_derivatives_between_its_limits():
    found, compared = compare_all(sb.load("rssr"), input="rocker")
    assert compared > 100
    assert set(found.status) == {"ok", "dead-centre"}
    assert np.isnan(found.of()[found.status == "dead-centre"]).all()


@pytest.mark.parametrize(
    "dims",
    [Dimensions(700, 700, 250, 550, 0, 997.4968671630002), Dimensions(640, -710, 210, 500, 130, 900)],
)
def test_an_rssr_s_derivatives_are_those_in_40_digits(dims):
    found = sensitivities(dims.linkage(), samples=8, speed=1.0)
    with mp.workdps(reference_rssr.DIGITS):
        for k, dimension in enumerate(found.dimensions):
            value = getattr(dims, dimension.name)
            # both are numbers of double precision, their difference is exact
            high, low = (value + sign * 2.0**-20 for sign in (1, -1))
            sides = [replace(dims, **{dimension.name: v}).reference().precise() for v in (high, low)]
            for order, quantity in enumerate(("position", "velocity", "acceleration")):
                size = np.nanmax(np.abs(found.of(quantity=quantity)))
                for row, x in enumerate(found.input):
                    beta = found.values[row, found.place()]
                    rates = [side.output((x, 1, 0, 0), beta, "crank")[order] for side in sides]
                    slope = float((rates[0] - rates[1]) / mp.mpf(high - low))
                    assert found.of(quantity=quantity)[row, k] == pytest.approx(slope, abs=1e-9 * size)


def planar(shift):
    """A planar four-bar as drawn with its crank drawn along x: A0 (0,0), A (40,0), B and B0 (120, 0)."""
    b = (100.0 + shift, 70.0)
    joints = [
        {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1), "name": "crank"},
        {"kind": "R", "at": (40, 0, 0), "axis": (0, 0, 1), "name": "a"},
        {"kind": "R", "at": (*b, 0), "axis": (0, 0, 1), "name": "b"},
        {"kind": "R", "at": (120, 0, 0), "axis": (0, 0, 1), "name": "rocker"},
    ]
    return sb.from_axes(joints)


def freudenstein(b, x):
    """The rocker's angle less that of the drawn pose, of a four-bar drawn with its crank along x."""

    def angle(x, b):
        a = np.array([40 * np.cos(x), 40 * np.sin(x)])
        coupler, rocker = np.hypot(b[0] - 40, b[1]), np.hypot(b[0] - 120, b[1])
        to_a = a - np.array([120.0, 0.0])
        far = np.hypot(*to_a)
        between = np.arccos((far**2 + rocker**2 - coupler**2) / (2 * far * rocker))
        return np.arctan2(to_a[1], to_a[0]) % math.tau - between

    return angle(x, b) - angle(0.0, b)


def test_a_drawn_planar_four_bar_follows_its_closed_form():
    linkage = planar(0.0)
    found = sensitivities(linkage, samples=24)
    name = found.loop.numbers.names.index("b.x")
    h = 1e-5
    for row, x in enumerate(found.input):
        b, along = np.array([100.0, 70.0]), np.array([h, 0.0])
        assert math.remainder(
            found.values[row, found.place()] - freudenstein(b, x), math.tau
        ) == pytest.approx(0, abs=1e-12)
        slope = (freudenstein(b + along, x) - freudenstein(b - along, x)) / (2 * h)
        assert found.of()[row, name] == pytest.approx(slope, abs=1e-9)


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rsur"])
def test_the_size_of_a_linkage_changes_no_angle(name):
    found = sensitivities(sb.load(name), samples=16)
    lengths = np.array([d.value if d.kind == "length" else 0.0 for d in found.dimensions])
    for quantity in ("position", "velocity", "acceleration"):
        assert np.abs(found.of(quantity=quantity) @ lengths).max() < 1e-9


def measures(circuit):
    """The measures of a circuit that also have derivatives."""
    extremes = {"angle": circuit.angle, "velocity": circuit.velocity, "acceleration": circuit.acceleration}
    told = {
        f"{name}_{end}": getattr(e, end) for name, e in extremes.items() if e for end in ("lowest", "highest")
    }
    told |= {"swing": circuit.swing, "time_ratio": circuit.time_ratio}
    if circuit.transmission is not None:
        told |= {f"transmission_{end}": getattr(circuit.transmission, end) for end in ("lowest", "highest")}
    centres = sorted(d.input for d in circuit.dead_centres if d.kind == "input")
    return told | {f"limit_{i}": x for i, x in enumerate(centres, 1)}


@pytest.mark.parametrize(
    ("linkage", "options", "least"),
    [
        (sb.rssr(M=640, N=-710, L1=210, L3=500, D=130, L2=900), {}, 10),
        (sb.rssr(M=640, N=-710, L1=210, L3=500, D=130, L2=900), {"input": "rocker"}, 3),
        (sb.load("planar_4r"), {}, 8),
        (sb.load("six_bar"), {}, 8),
        (sb.load("rssp"), {}, 8),
        (sb.load("seven_r"), {}, 4),
    ],
)
def test_measures_change_as_their_derivatives_say(linkage, options, least):
    found = sensitivities(linkage, samples=36, **options)
    assert len(found.measures) >= least
    for k, dimension in enumerate(found.dimensions):
        if dimension.name in found.opening:
            continue
        sides = []
        for sign in (1, -1):
            other, step = changed(found, k, sign * 1e-5)
            sides.append((measures(same_circuit(found, other)), step))
        for one in found.measures:
            if one.name == "transmission_lowest" and options:
                assert not one.slopes.any()
                continue
            if one.name == "transmission_highest" and np.isnan(one.slopes).all():
                # a right angle is the highest whatever the dimensions
                assert sides[0][0][one.name] == pytest.approx(math.pi / 2, abs=1e-9)
                continue
            slope = (sides[0][0][one.name] - sides[1][0][one.name]) / (sides[0][1] - sides[1][1])
            size = np.nanmax(np.abs(one.slopes)) * one.scale
            assert one.slopes[k] * one.scale == pytest.approx(slope, abs=1e-5 * size), (
                one.name,
                dimension.name,
            )


def test_equal_strokes_leave_the_time_ratio_without_a_derivative():
    assert np.isnan(sensitivities(sb.load("screw_drill")).measure("time_ratio").slopes).all()


def test_what_spins_idly_is_not_told_and_the_rest_is():
    found = sensitivities(sb.load("rssr"), samples=8)
    told = {one.name: np.isfinite(found.slopes[:, j]).all() for j, one in enumerate(found.outputs)}
    assert not told["ball_b.1"]
    assert told["rocker"]
    assert told["B.x"]


def test_dimensions_that_open_an_overconstrained_loop_are_named():
    assert set(sensitivities(sb.load("planar_4r"), samples=8).opening) == {
        f"{word}_{i}" for word in ("offset", "twist") for i in range(1, 5)
    }
    found = sensitivities(sb.load("bennett"), samples=8)
    assert set(found.opening) == set(found.loop.numbers.names)


def test_the_greatest_effect_comes_first():
    ranking = sensitivities(sb.load("rssr")).ranking()
    assert [dimension.name for dimension, _, _ in ranking] == ["L2", "L1", "M", "N", "D", "L3"]
    assert [effect for _, effect, _ in ranking] == sorted((e for _, e, _ in ranking), reverse=True)


def test_wrong_requests_say_what_to_do():
    found = sensitivities(sb.load("rssr"), samples=8)
    with pytest.raises(RequestError, match=r"output: no 'roker' with a position; did you mean 'rocker'\?"):
        found.of("roker")
    with pytest.raises(RequestError, match="quantity: 'jerk' is not offered; give position, velocity"):
        found.of(quantity="jerk")
    with pytest.raises(RequestError, match=r"measure: no 'swng' of this circuit; did you mean 'swing'\?"):
        found.measure("swng")
    bare = replace(sb.load("rssr"), description={})
    with pytest.raises(RequestError, match="was made without a description"):
        sensitivities(bare)
