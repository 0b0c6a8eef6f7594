"""The bodies of a link as one: rods lie between its joints, drawn solids are the export's, several add up."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError
from sevenbar.export.layout import arrange
from sevenbar.export.mass import masses
from sevenbar.export.pose import take
from sevenbar.kinematics.dynamics.link_bodies import joint_places, resolved

LOOPS = ("rssr", "seven_r", "rscr", "rsur", "bennett", "planar_4r")


def of(linkage, bodies, **options):
    return resolved(sb.Loading(bodies=bodies), linkage, **options)


@pytest.mark.parametrize("name", LOOPS)
def test_the_place_of_a_joint_is_one_place_on_both_of_its_links_where_it_does_not_slide(name):
    linkage = sb.load(name)
    circuit = linkage.motion(24).circuits[0]
    size = max(np.abs(linkage.links[:, :3, 3]).max(), 1e-9)
    met = 0
    for link in range(1, len(linkage.links)):
        if "slide" in linkage.joints[link].row.freedoms:
            continue
        after, before = joint_places(linkage, link)[1], joint_places(linkage, link + 1)[0]
        one = circuit.point(link, tuple(after)).position
        other = circuit.point(link + 1, tuple(before)).position
        met += 1
        assert np.nanmax(np.abs(one - other)) < 1e-9 * size
    assert met


def test_the_rods_of_an_rssr_go_from_axis_to_ball_to_ball_to_axis():
    linkage = sb.load("rssr")
    found = of(linkage, {link: sb.Body(3, solid="rod") for link in (1, 2, 3)})
    circuit = linkage.motion(12).circuits[0]
    a, b = (circuit.point(name).position for name in "AB")
    for link, ends in ((1, (a, (0, 0, 700))), (2, (a, b)), (3, (b, (700, 0, 0)))):
        middle = circuit.point(link, found[link].centre).position
        np.testing.assert_allclose(middle, (np.array(ends[0]) + ends[1]) / 2, atol=1e-9)
        length = np.linalg.norm(np.array(ends[0]) - ends[1], axis=-1)[0] / 1000
        moments = np.linalg.eigvalsh(found[link].tensor)
        np.testing.assert_allclose(moments, [0, length**2 / 4, length**2 / 4], atol=1e-15)


def test_a_rod_of_rows_goes_along_the_offset_and_the_length():
    linkage = sb.load("seven_r")
    body = of(linkage, {1: sb.Body(12, solid="rod")})[1]
    offset, length = linkage.dimensions["offset_1"], linkage.dimensions["length_1"]
    assert body.centre == pytest.approx((offset / 2, length / 2, 0))
    u, v = offset / 1000, length / 1000
    expected = [[v * v, -u * v, 0], [-u * v, u * u, 0], [0, 0, u * u + v * v]]
    np.testing.assert_allclose(body.tensor, expected, atol=1e-15)


def test_a_rod_is_its_halves():
    """Half the mass at the middle of each half, each half a rod of its own: the same mass, centre and inertia."""
    linkage = sb.load("rscr")
    whole = of(linkage, {2: sb.Body(2, solid="rod")})[2]
    start, end = joint_places(linkage, 2)
    half = (end - start) / 2000
    own = (half @ half * np.eye(3) - np.outer(half, half)) / 12
    parts = [sb.Body(1, tuple(start + share * (end - start)), own) for share in (0.25, 0.75)]
    summed = of(linkage, {2: parts})[2]
    assert summed.mass == whole.mass
    assert summed.centre == pytest.approx(whole.centre)
    np.testing.assert_allclose(summed.tensor, whole.tensor, atol=1e-15)


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rscr", "rsur"])
def test_what_is_drawn_has_the_mass_of_the_export_and_its_place(name):
    linkage = sb.load(name)
    motion = linkage.motion()
    pose = take(motion)
    steel = masses(arrange(pose))
    links = range(1, len(linkage.links) + 1)
    found = of(linkage, {link: sb.Body(solid="drawn") for link in links})
    for link in links:
        one, frame = steel[link - 1], pose.frames[link - 1]
        assert found[link].mass == pytest.approx(one.mass, rel=1e-14)
        written = linkage.point_frames[link - 1] @ (*found[link].centre, 1.0)
        np.testing.assert_allclose(
            (frame @ written)[:3], frame[:3, :3] @ one.centre + frame[:3, 3], atol=1e-9
        )
        turn = linkage.point_frames[link - 1][:3, :3]
        np.testing.assert_allclose(
            turn @ found[link].tensor @ turn.T, 1e-6 * one.inertia, rtol=1e-12, atol=1e-12 * found[link].mass
        )


def test_a_mass_scales_what_is_drawn_and_the_circuit_may_be_another():
    linkage = sb.load("seven_r")
    steel, scaled = (
        of(linkage, {1: sb.Body(solid="drawn")})[1],
        of(linkage, {1: sb.Body(5, solid="drawn")})[1],
    )
    assert scaled.mass == pytest.approx(5)
    assert scaled.centre == steel.centre
    np.testing.assert_allclose(scaled.tensor, steel.tensor * 5 / steel.mass)
    other = of(linkage, {1: sb.Body(solid="drawn")}, circuit=1)[1]
    assert other.mass > 0
    assert other.mass != steel.mass


def test_a_point_has_no_inertia_and_a_link_without_bodies_none():
    found = of(sb.load("rssr"), {2: sb.Body(1, (1, 2, 3), solid="point"), 1: ()})
    assert list(found) == [2]
    assert found[2].solid is None
    assert not found[2].tensor.any()


@pytest.mark.parametrize("link", [4, 5])
def test_the_ground_and_links_that_do_not_exist_carry_no_body(link):
    with pytest.raises(RequestError, match=rf"bodies: link {link} is .*; give 1 to 3"):
        of(sb.load("rssr"), {link: sb.Body(1, solid="rod")})
