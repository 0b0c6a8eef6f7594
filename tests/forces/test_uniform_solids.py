"""Cylinders and boxes on links: mass, centre and inertia are those of the textbooks, however they are turned."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.forces.bodies import Body, shaped
from sevenbar.kinematics.dynamics.link_bodies import resolved

FILE = """
format = 1
length_unit = "{unit}"
[[joint]]
name = "crank"
kind = "R"
at = [0, 0, 0]
axis = [0, 0, 1]
[[joint]]
kind = "S"
at = [30, 0, 0]
[[joint]]
kind = "S"
at = [100, 90, 50]
[[joint]]
name = "slider"
kind = "P"
at = [100, 90, 50]
axis = [1, 0, 0]
[[body]]
link = 2
{body}
"""


def in_file(body, unit="mm"):
    linkage = sb.loads(FILE.format(body=body, unit=unit))
    return resolved(linkage.loading, linkage)[2]


def whole(body, metre=1e-3):
    return shaped(body, metre, (np.zeros(3), np.array([0.0, 0.0, 1.0])))


def by_points(inside, box, mass):
    """Centre and inertia of a solid by the middles of small cubes, which know no formula of it."""
    edges = [np.linspace(low, high, 61) for low, high in box]
    grid = np.stack(np.meshgrid(*[(e[1:] + e[:-1]) / 2 for e in edges], indexing="ij"), axis=-1).reshape(
        -1, 3
    )
    points = grid[inside(grid)]
    centre = points.mean(axis=0)
    arms = points - centre
    inertia = mass * (np.mean((arms**2).sum(axis=1)) * np.eye(3) - arms.T @ arms / len(arms))
    return centre, inertia


def test_a_cylinder_and_a_tube_have_the_mass_and_the_moments_of_textbooks():
    full = whole(Body(solid="cylinder", diameter=20, ends=((0, 0, 0), (0, 0, 60)), density="steel"))
    assert full.mass == pytest.approx(7850 * math.pi * 0.01**2 * 0.06, rel=1e-14)
    assert full.centre == (0, 0, 30)
    m = full.mass
    across = m * (3 * 0.01**2 + 0.06**2) / 12
    assert np.allclose(full.tensor, np.diag([across, across, m * 0.01**2 / 2]), rtol=1e-14)
    tube = whole(Body(2.0, solid="cylinder", diameter=20, bore=16, ends=((0, 0, 0), (60, 0, 0))))
    across = 2 * (3 * (0.01**2 + 0.008**2) + 0.06**2) / 12
    assert np.allclose(tube.tensor, np.diag([2 * (0.01**2 + 0.008**2) / 2, across, across]), rtol=1e-14)


def test_a_thin_cylinder_between_the_joints_is_the_rod():
    rod, thin = (
        in_file('mass = 1.3\nsolid = "rod"'),
        in_file('mass = 1.3\nsolid = "cylinder"\ndiameter = 1e-6'),
    )
    assert thin.centre == pytest.approx(rod.centre)
    assert np.allclose(thin.tensor, rod.tensor, atol=1e-15)


def test_a_box_has_the_moments_of_textbooks_along_its_edges():
    found = whole(Body(solid="box", size=(120, 20, 8), centre=(60, 0, 0), density=2700))
    a, b, c = 0.12, 0.02, 0.008
    assert found.mass == pytest.approx(2700 * a * b * c, rel=1e-14)
    assert np.allclose(
        found.tensor, found.mass / 12 * np.diag([b**2 + c**2, a**2 + c**2, a**2 + b**2]), rtol=1e-13
    )


@pytest.mark.parametrize("scale", [1.0, -1.0])
def test_solids_that_are_turned_or_mirrored_have_the_tensor_of_their_cubes(scale):
    start, end = np.array([1.0, 2.0, 3.0]), np.array([4.0, -2.0, 5.0]) * scale
    axis = (end - start) / np.linalg.norm(end - start)

    def in_cylinder(p):
        along = (p - start) @ axis
        off = np.linalg.norm(p - start - along[:, None] * axis, axis=1)
        return (along > 0) & (along < np.linalg.norm(end - start)) & (off < 1.5)

    found = whole(Body(3.0, solid="cylinder", diameter=3, ends=(start, end)), metre=1.0)
    box = [(min(a, b) - 1.6, max(a, b) + 1.6) for a, b in zip(start, end, strict=True)]
    centre, inertia = by_points(in_cylinder, box, 3.0)
    assert np.allclose(found.centre, centre, atol=0.02)
    assert np.allclose(found.tensor, inertia, atol=0.01 * np.trace(inertia))
    u, w = np.array([1.0, 1.0, 0.2]) * scale, np.array([0.0, 1.0, 1.0])
    x = u / np.linalg.norm(u)
    y = w - (w @ x) * x
    y /= np.linalg.norm(y)
    axes = np.stack([x, y, np.cross(x, y)])
    middle, size = np.array([0.5, -0.2, 0.3]), np.array([4.0, 2.0, 1.0])
    found = whole(Body(3.0, middle, solid="box", size=size, along=u, side=w), metre=1.0)
    inside = lambda p: (np.abs((p - middle) @ axes.T) < size / 2).all(axis=1)  # noqa: E731
    centre, inertia = by_points(inside, [(m - 2.6, m + 2.6) for m in middle], 3.0)
    assert np.allclose(found.centre, centre, atol=0.02)
    assert np.allclose(found.tensor, inertia, atol=0.01 * np.trace(inertia))


def test_one_solid_in_two_units_and_two_notations_is_one_body():
    plain = in_file('solid = "cylinder"\ndiameter = 20\nends = [[30, 0, 0], [30, 0, 60]]\ndensity = "steel"')
    inches = in_file(
        'solid = "cylinder"\ndiameter = "20 mm"\nends = [["30 mm", 0, 0], ["30 mm", 0, "6 cm"]]\n'
        'density = "7.85 g/cm^3"',
        unit="in",
    )
    assert inches.mass == pytest.approx(plain.mass, rel=1e-12)
    assert np.allclose(inches.tensor, plain.tensor, rtol=1e-12)
    assert np.allclose(np.array(inches.centre) * 25.4, plain.centre)


def test_python_files_and_what_is_written_of_a_linkage_agree():
    given = {
        2: sb.Body(solid="cylinder", diameter=20, bore=4, density="brass"),
        1: [sb.Body(0.2, (15, 0, 0), solid="box", size=(30, 8, 5), along=(1, 0.1, 0), side=(0, 0, 1))],
    }
    linkage = sb.loads(FILE.format(unit="mm", body='mass = 1\nsolid = "rod"')).loaded(bodies=given)
    again = Draft.of_linkage(linkage).linkage
    for link, body in resolved(linkage.loading, linkage).items():
        other = resolved(again.loading, again)[link]
        assert body.mass == other.mass
        assert np.array_equal(body.tensor, other.tensor)
        assert body.centre == other.centre
    assert sum(body.mass for body in linkage.motion(12)[0].forces().bodies.values()) > 0.2


@pytest.mark.parametrize("size", [5e-324, 1e-200, 1.0, 1e200])
def test_a_direction_of_a_box_may_be_of_any_size(size):
    given = sb.Body(1.0, (0, 0, 0), solid="box", size=(1, 2, 3), along=(0, size, size), side=(size, size, 0))
    tensor = shaped(given, 1.0, (np.zeros(3), np.zeros(3))).tensor
    along, across = np.array([0, 1, 1]) / np.sqrt(2), np.array([1, 0.5, -0.5]) / np.sqrt(1.5)
    # moments of a box: m (b^2 + c^2) / 12 about the edge a
    assert along @ tensor @ along == pytest.approx((4 + 9) / 12, rel=1e-12)
    assert across @ tensor @ across == pytest.approx((1 + 9) / 12, rel=1e-12)


def test_a_cube_of_water_weighs_a_kilogram_whatever_the_unit():
    for unit, edge in (("mm", 100.0), ("cm", 10.0), ("m", 0.1), ("in", 100 / 25.4)):
        body = in_file(
            f'solid = "box"\nsize = [{edge}, {edge}, {edge}]\ncentre = [0, 0, 0]\ndensity = 1000', unit
        )
        assert body.mass == pytest.approx(1.0, rel=1e-12)
        assert np.allclose(body.tensor, np.eye(3) * 0.01 / 6, rtol=1e-12)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"diameter": 3}, "mass: 0.0 is not a mass; give kilograms > 0, or a density"),
        ({"mass": 1}, "diameter: is missing; give that of the cylinder"),
        (
            {"mass": 1, "diameter": 3, "bore": 3},
            "bore: 3.0 is not below the diameter 3; give less, or leave it out",
        ),
        ({"mass": 1, "diameter": -3}, "diameter: -3 is not a length; give a number > 0"),
        ({"mass": 1, "diameter": 3, "density": 2}, "density: mass is given; leave one of them out"),
        (
            {"mass": 1, "diameter": 3, "size": (1, 2, 3)},
            "size: belongs to solid = 'box'; leave it out, or give",
        ),
        ({"mass": 1, "diameter": 3, "ends": ((1, 2, 3), (1, 2, 3))}, "ends: both are one place; give two"),
        ({"mass": 1, "diameter": 3, "ends": 5}, "ends: give two places, the middles of the cylinder's ends"),
        ({"mass": 1, "diameter": 3, "centre": (0, 0, 0)}, "solid: cylinder has its own centre and inertia"),
        (
            {"diameter": 3, "density": "stel"},
            "density: 'stel' is no density; did you mean 'steel'? give kg/m^3",
        ),
        ({"diameter": 3, "density": "3 kg"}, "density: '3 kg' is no density; "),
        ({"diameter": 3, "density": -3}, "density: -3 is not a density; give kg/m^3 > 0"),
        (
            {"solid": "rod", "mass": 1, "density": 3},
            "density: belongs to solid = 'cylinder' or 'box'; leave it",
        ),
        (
            {"solid": "box", "mass": 1, "centre": (0, 0, 0)},
            "size: is missing; give the three edges of the box",
        ),
        ({"solid": "box", "mass": 1, "size": (1, 2, 3)}, "centre: is missing; give three lengths, or solid"),
        (
            {"solid": "box", "mass": 1, "size": (1, 0, 3), "centre": (0, 0, 0)},
            "size[1]: 0 is not a length; give",
        ),
        (
            {
                "solid": "box",
                "mass": 1,
                "size": (1, 2, 3),
                "centre": (0, 0, 0),
                "along": (1, 0, 0),
                "side": (2, 0, 0),
            },
            "side: lies along the first edge; give a direction across it",
        ),
        (
            {"solid": "box", "mass": 1, "size": (1, 2, 3), "centre": (0, 0, 0), "side": (0, 0, 0)},
            "side: (0, 0, 0) has no direction; give three numbers, not all 0",
        ),
    ],
)
def test_a_shape_that_is_none_is_refused(given, says):
    with pytest.raises(RequestError) as caught:
        sb.Body(**{"solid": "cylinder", **given})
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (
            'solid = "cylinder"\ndiameter = 20',
            "body[1].mass: is missing; give one, or a density, as in density = 'steel'",
        ),
        ('solid = "cylinder"\nmass = 1', "body[1].diameter: is missing; give that of the cylinder"),
        (
            'solid = "cylinder"\ndensity = "stel"\ndiameter = 1',
            "body[1].density: 'stel' is no density; did you mean 'steel'?",
        ),
        (
            'solid = "box"\nmass = 1\nsize = [1, 2]\ncentre = [0, 0, 0]',
            "body[1].size: [1, 2] is no size of a box; give its three",
        ),
        (
            'solid = "cylinder"\nmass = 1\ndiameter = 1\nends = [1, 2, 3]',
            "body[1].ends: [1, 2, 3] are not two ends; give two",
        ),
        ("mass = 1\ncentre = [0, 0, 0]\ndiameter = 3", "body[1].diameter: belongs to solid = 'cylinder'"),
    ],
)
def test_a_shape_that_is_none_is_refused_in_a_file(body, says):
    with pytest.raises(DescriptionError) as caught:
        in_file(body)
    assert says in str(caught.value)


def test_a_cylinder_without_ends_needs_joints_apart():
    linkage = sb.slider_crank(40, 140)
    with pytest.raises(
        RequestError, match="ends: is missing; both joints of the link are at one place, so give two"
    ):
        resolved(linkage.loaded(bodies={3: sb.Body(1.0, solid="cylinder", diameter=3)}).loading, linkage)
