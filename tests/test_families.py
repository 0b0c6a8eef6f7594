"""Linkages of the textbooks: the gallery's files come out of their free dimensions, and the families' laws hold."""

import math

import mpmath
import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError

#: The gallery's files from their free dimensions.
OF_THE_GALLERY = {
    "bennett": lambda: sb.bennett(60, "40 deg", "75 deg"),
    "goldberg_5r": lambda: sb.goldberg(60, "40 deg", "75 deg", "25 deg"),
    "myard_5r": lambda: sb.myard("8 cm", "50 deg"),
    "bricard_line": lambda: sb.bricard_line((30, 80, 70), ("30 deg", "100 deg", "80 deg"), (10, -20, 35)),
    "bricard_plane": lambda: sb.bricard_plane((30, 80, 75), ("40 deg", "70 deg", "50 deg"), (10, -15)),
    "bricard_trihedral": lambda: sb.bricard_trihedral((50, 55, 70, 60, 75)),
    "planar_4r": lambda: sb.four_bar(40, 100, 80, 90),
    "spherical_4r": lambda: sb.spherical_four_bar("30 deg", "80 deg", "70 deg", "85 deg"),
    "universal_joint": lambda: sb.universal_joint("acos(4/5)"),
    "five_bar": lambda: sb.clemens("2*atan(5/12)", 65, 72),
    "sarrus": lambda: sb.sarrus([(50, 0), (50, 30), (70, 126)], [(50, 0), (104, 72), (65, 126)]),
}


def lines_of(linkage):
    """Place and unit direction of each drawn joint's axes."""
    found = []
    for joint in linkage.description["joint"]:
        axes = joint.get("axes", [joint["axis"]] if "axis" in joint else [])
        found.append((np.array(joint["at"], float), [np.array(a, float) / np.linalg.norm(a) for a in axes]))
    return found


@pytest.mark.parametrize("name", OF_THE_GALLERY)
def test_the_gallery_s_file_is_its_family_at_these_dimensions_to_the_last_digits(name):
    ours, file = OF_THE_GALLERY[name](), sb.load(name)
    assert (ours.name, ours.kind, ours.columns) == (file.name, file.kind, file.columns)
    if file.form == "rows":
        np.testing.assert_allclose(
            ours.transforms, file.transforms, rtol=0, atol=1e-14 * np.abs(file.transforms).max()
        )
        return
    for (at, axes), (wanted, directions) in zip(lines_of(ours), lines_of(file), strict=True):
        np.testing.assert_allclose(at, wanted, rtol=0, atol=1e-13)
        for axis, direction in zip(axes, directions, strict=True):
            np.testing.assert_allclose(axis, direction, rtol=0, atol=1e-15)
    assert [p.at for p in ours.points] == [pytest.approx(p.at) for p in file.points]


@pytest.mark.parametrize(
    ("a", "alpha", "beta"),
    [(50, 30, 100), (1, 45, 90), (0.1, 2.6, 179), (60, 40, 75), (1e-3, 90, 30), (7, 150, 30)],
)
def test_a_bennett_loop_moves_at_the_length_that_mpmath_finds(a, alpha, beta):
    linkage = sb.bennett(a, f"{alpha} deg", f"{beta}deg")
    with mpmath.workdps(40):
        b = (
            mpmath.mpf(str(a))
            * mpmath.sin(mpmath.radians(mpmath.mpf(str(beta))))
            / mpmath.sin(mpmath.radians(mpmath.mpf(str(alpha))))
        )
    assert linkage.dimensions["length_2"] == pytest.approx(float(b), rel=5e-16)
    assert linkage.motion(36).motion_type not in ("rigid", "cannot-assemble")


@pytest.mark.parametrize("gamma", [25, 30, 90, 0.1])
def test_a_goldberg_loop_moves(gamma):
    assert sb.goldberg(60, "40deg", "75deg", f"{gamma}deg").motion(36).motion_type not in (
        "rigid",
        "cannot-assemble",
    )


@pytest.mark.parametrize("alpha", [50, 30, 45, 60, 89])
def test_a_myard_loop_moves(alpha):
    assert sb.myard(80, math.radians(alpha)).motion(36).motion_type not in ("rigid", "cannot-assemble")


def test_radians_and_degrees_in_text_are_the_same_linkage():
    ours, text = sb.bennett(50, math.pi / 6, math.pi / 2), sb.bennett("5 cm", "30 deg", "pi/2")
    np.testing.assert_array_equal(ours.transforms, text.transforms)
    assert ours.description["link"][0]["twist"] == 30


@pytest.mark.parametrize("offset", [0, 10, -10, 0.1, 40])
def test_the_slider_crank_is_the_textbook_s(offset):
    crank, rod = 40.0, 140.0
    linkage = sb.slider_crank(crank, rod, offset)
    motion = linkage.motion(36)
    assert motion.motion_type == "crank-slider"
    found = []
    for circuit in motion.circuits:
        theta = circuit.input
        side = np.sqrt(rod**2 - (offset - crank * np.sin(theta)) ** 2)
        x = circuit.point(3, linkage.points[0].at).position[:, 0]
        signs = [sign for sign in (1, -1) if np.abs(crank * np.cos(theta) + sign * side - x).max() < 1e-10]
        found += signs
        assert signs, "a circuit off the closed form"
        # the value is the place of the slider, counted from the drawn pose
        start = crank + math.sqrt(rod**2 - offset**2)
        np.testing.assert_allclose(circuit.output, x - start, atol=1e-10)
    assert sorted(found) == [-1, 1]


@pytest.mark.parametrize("angle", [10, 30, 45, 60, 80])
def test_the_universal_joint_follows_the_tangent_law(angle):
    circuit = sb.universal_joint(f"{angle} deg").motion(72).circuits[0]
    wanted = np.arctan2(np.cos(math.radians(angle)) * np.sin(circuit.input), np.cos(circuit.input))
    apart = np.minimum.reduce([np.abs(np.sin(circuit.output - sign * wanted)) for sign in (1, -1)])
    assert apart.max() < 1e-12


def test_squares_and_parallelograms_are_change_points():
    assert sb.four_bar(50, 50, 50, 50).motion(36).motion_type == "change-point"
    assert sb.four_bar(40, 90, 40, 90).motion(36).motion_type == "change-point"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sb.bennett(50, 30, 100), "alpha: 30 rad is more than a turn; give radians, or a text, as in '30 deg'"),
        (lambda: sb.bennett(50, "180 deg", 1), "alpha: 180 deg: its sine is 0, so no other length follows; give another angle"),
        (lambda: sb.bennett(50, "30", 1), "alpha: '30' has no unit; give one as in '30 deg', or a number in radians"),
        (lambda: sb.bennett(-50, 1, 1), "a: -50 is not a length; give a number > 0"),
        (lambda: sb.bennett("50 kg", 1, 1), "a: '50 kg': 'kg' is not a unit known here; allowed: um"),
        (lambda: sb.bennett(50, "50 mm", 1), "alpha: '50 mm': is a length where an angle belongs"),
        (lambda: sb.slider_crank(40, 30, 35), "rod: 30 does not reach the guide at 35; give a rod longer than the offset"),
        (lambda: sb.bricard_trihedral((1, 9, 1, 9, 1)), "length: the squares of the second and fourth add up to more"),
        (lambda: sb.bricard_line((1, 2), (1, 2, 3)), "length: (1, 2) does not fit; give 3 numbers"),
        (lambda: sb.sarrus([(1, 2)], [(1, 2)] * 3), "first: [(1, 2)] is no leg; give three places"),
    ],
)  # fmt: skip
def test_each_mistake_has_its_message(make, message):
    with pytest.raises(RequestError) as refused:
        make()
    assert str(refused.value).startswith(message)
