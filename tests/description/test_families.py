"""Linkages of the textbooks: the gallery's files come out of their free dimensions, and the families' laws hold."""

import math
import re

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
        x = circuit.point("pin").position[:, 0]
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


FOUR_BARS = [
    (40, 100, 80, 90),
    (60, 30, 50, 40),
    (90, 80, 70, 40),
    (3, 1.5, 2, 2.5),
    (40, 90, 40, 90),
    (50, 50, 50, 50),
]


@pytest.mark.parametrize("lengths", FOUR_BARS)
def test_the_planar_four_bar_is_freudenstein_s_in_the_xy_plane_with_angles_from_the_ground_line(lengths):
    """d/a cos(psi) - d/c cos(theta) + (a^2 - b^2 + c^2 + d^2) / (2 a c) = cos(theta - psi), a crank to d ground."""
    a, b, c, d = lengths
    linkage = sb.four_bar(*lengths)
    np.testing.assert_array_equal([linkage.plane.x, linkage.plane.y, linkage.plane.normal], np.eye(3))
    circuits = linkage.motion(36).circuits
    assert circuits
    for circuit in circuits:
        good = np.isfinite(circuit.q).all(axis=1)
        theta, psi = circuit.q[good, 0], circuit.q[good, 3]
        constant = (a * a - b * b + c * c + d * d) / (2 * a * c)
        left = d / a * np.cos(psi) - d / c * np.cos(theta) + constant - np.cos(theta - psi)
        assert np.abs(left).max() < 1e-12
        nothing = np.zeros(len(theta))
        pins = {
            (1, (0, 0, 0)): (nothing, nothing),
            (1, (0, a, 0)): (a * np.cos(theta), a * np.sin(theta)),
            (2, (0, b, 0)): (d + c * np.cos(psi), d + c * np.sin(psi) - d),
            (3, (0, c, 0)): (nothing + d, nothing),
            (4, (0, d, 0)): (nothing, nothing),
        }
        for (link, at), place in pins.items():
            found = circuit.point(link, at).position[good]
            np.testing.assert_allclose(found, np.stack([*place, nothing], axis=1), atol=1e-11 * sum(lengths))
        # w is to the left of v, seen against z
        tip, side = (circuit.point(1, (0, 1, w)).position[good] for w in (0, 1))
        np.testing.assert_allclose(
            side - tip, np.stack([-np.sin(theta), np.cos(theta), nothing], axis=1), atol=1e-12
        )


def test_the_planar_layout_is_the_linkage_of_the_rows_with_other_zeros():
    ours, rows = sb.four_bar(40, 100, 80, 90), sb.load("planar_4r")
    assert ours.dimensions == rows.dimensions
    one, other = ours.motion(36).circuits[0], rows.motion(36).circuits
    twin = min(other, key=lambda c: np.abs(np.sin((c.q[0, 0] - math.pi) - one.q[0, 0])).max())
    turned = np.argsort(np.mod(twin.q[:, 0] - math.pi, math.tau))
    like = [c for c in other if np.abs(np.cos(c.q[turned, 3]) - np.cos(one.q[:, 3])).max() < 1e-12]
    assert like
    assert np.abs(np.sin(like[0].q[turned, 3] + one.q[:, 3])).max() < 1e-12
    assert one.transmission.lowest == pytest.approx(twin.transmission.lowest, abs=1e-12)
    assert one.motion_type == "crank-rocker"


def test_the_planar_layout_is_kept_in_files_tables_and_changed_numbers(tmp_path):
    from sevenbar.description.draft import Draft
    from sevenbar.export.workbook import linkage_table

    linkage = sb.four_bar(40, 100, 80, 90)
    draft = Draft.of_linkage(linkage)
    for again in (draft.linkage, sb.loads(draft.toml()), draft.with_values({"length_1": 41.0}).linkage):
        assert again.form == "planar"
        np.testing.assert_array_equal(again.plane.y, [0, 1, 0])
    head, rows = linkage_table(linkage)
    lines = [",".join("" if cell is None else str(cell) for cell in line) for line in (head, *rows)]
    (tmp_path / "bar.csv").write_text("\n".join(lines), encoding="utf-8")
    table = sb.load(tmp_path / "bar.csv")
    np.testing.assert_array_equal(table.motion(24).circuits[0].q, linkage.motion(24).circuits[0].q)


@pytest.mark.parametrize(
    ("rows", "place"),
    [
        (
            "length = 1\ntwist = 10\n[[link]]\nlength = 1\n[[link]]\nlength = 1\n[[link]]\nlength = 1",
            "link[1].twist",
        ),
        ('joint = "P"\n[[link]]\nlength = 1\n[[link]]\nlength = 1\n[[link]]\nlength = 1', "link[1].joint"),
    ],
)
def test_rows_that_do_not_fit_the_planar_layout_are_refused(rows, place):
    with pytest.raises(
        sb.errors.DescriptionError, match=re.escape(place) + ': does not fit layout = "planar"'
    ):
        sb.loads(f'format = 1\nlayout = "planar"\n[[link]]\n{rows}\n')
