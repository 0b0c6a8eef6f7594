"""The idle spin between two balls makes no singular pose that the linkage has not: rods along slides and along axes."""

import numpy as np
import pytest

import sevenbar as sb

#: What an exact coincidence is off by.
GAPS = [0.0, 1e-16, 1e-12, 1e-9, 1e-6, 1e-3]


def slider_crank(crank, rod, off=0.0, offset=0.0, *, from_slide):
    """A crank about z at the origin and a slide along x, `off` aside of it and `offset` above."""
    reach = np.sqrt(rod**2 - off**2 - offset**2)
    joints = [
        {"name": "crank", "kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
        {"name": "ball_a", "kind": "S", "at": (crank, 0, 0)},
        {"name": "ball_b", "kind": "S", "at": (crank + reach, off, offset)},
        {"name": "slide", "kind": "P", "at": (crank + reach, off, offset), "axis": (1, 0, 0)},
    ]
    drive = {"input": "crank", "output": "slide"}
    return sb.from_axes(joints[::-1] if from_slide else joints), drive


def column(circuit, name):
    return circuit.q[:, circuit.columns.index(name)]


def assert_whole(linkage, motion, crank=1.0):
    """Two circuits on which every mode lies, none of them through a change point."""
    assert [c.closed for c in motion] == [True, True]
    assert motion.change_points == ()
    for value in np.linspace(-3.0, 3.0, 7):
        modes = linkage.assembly_modes(value, input=motion.input)
        assert len(modes) == 2
        ends = modes.q[:, linkage.columns.index(motion.output)]
        apart = [
            min(abs(np.interp(value % (2 * np.pi), *in_order(c, motion)) - end) for c in motion)
            for end in ends
        ]
        assert max(apart) < 1e-3 * crank


def in_order(circuit, motion):
    """Input, rising in a turn, and output."""
    turn = np.mod(circuit.input, 2 * np.pi)
    order = np.argsort(turn)
    return turn[order], column(circuit, motion.output)[order]


@pytest.mark.parametrize("from_slide", [True, False])
@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize(("crank", "rod"), [(1, 3), (0.1, 0.3), (2, 2.6), (30, 100)])
def test_an_in_line_slider_crank_is_the_same_from_either_end(crank, rod, gap, from_slide):
    linkage, drive = slider_crank(crank, rod, gap * crank, from_slide=from_slide)
    motion = linkage.motion(360, **drive)
    assert motion.motion_type == "crank-slider"
    assert_whole(linkage, motion, crank)


def test_its_slide_follows_the_closed_form():
    linkage, drive = slider_crank(1.0, 3.0, from_slide=True)
    for circuit in linkage.motion(72, **drive):
        phi, slide = column(circuit, "crank"), column(circuit, "slide")
        places = np.cos(phi), np.sqrt(9.0 - np.sin(phi) ** 2)
        # the slide counts from the pose as drawn, at 4
        expected = [side * (places[0] + sign * places[1] - 4.0) for side in (1, -1) for sign in (1, -1)]
        assert min(np.abs(slide - e).max() for e in expected) < 1e-12
        assert np.isfinite(circuit.q).all()


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("gap", GAPS)
def test_a_rod_that_comes_to_lie_along_the_cranks_axis_is_no_change_point(gap, reverse):
    joints = [
        {"name": "crank", "kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
        {"name": "ball_a", "kind": "S", "at": (1, 0, 0)},
        {"name": "ball_b", "kind": "S", "at": (1 + gap, 0, 3)},
        {"name": "slide", "kind": "P", "at": (1 + gap, 0, 3), "axis": (0, 0, 1)},
    ]
    linkage = sb.from_axes(joints[::-1] if reverse else joints)
    motion = linkage.motion(360, input="crank", output="slide")
    assert motion.motion_type == "crank-slider"
    assert_whole(linkage, motion)


def test_the_general_way_agrees_with_the_closed_form_where_the_coupler_passes_along_the_axis():
    linkage = sb.from_axes(
        [
            {"name": "crank", "kind": "R", "at": (0, 0, 0), "axis": (1, 0, 0)},
            {"name": "ball_a", "kind": "S", "at": (0, 1, 0)},
            {"name": "ball_b", "kind": "S", "at": (3, 1, 0)},
            {"name": "rocker", "kind": "R", "at": (3, 0, 0), "axis": (0, 0, 1)},
        ]
    )
    closed, general = linkage.motion(36), linkage.motion(36, method="general")
    assert closed.motion_type == general.motion_type == "crank-rocker"
    assert (general.completeness, len(general.change_points)) == ("counted", 0)
    ends = [sorted(float(np.sort(column(c, "rocker"))[0]) for c in motion) for motion in (closed, general)]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)
    # a row of the closed form, whose spin is held by the crank's axis, is a pose for the general way
    row = closed.circuits[0].q[5]
    assert linkage.circuit(row, 36).motion_type == "crank-rocker"


def test_a_rod_between_two_crossed_slides_is_one_circle():
    """The trammel: the balls keep 10 apart while two slides at right angles move one of them."""
    linkage = sb.from_axes(
        [
            {"kind": "S", "at": (0, 10, 2)},
            {"name": "x", "kind": "P", "at": (0, 10, 2), "axis": (1, 0, 0)},
            {"name": "y", "kind": "P", "at": (0, 0, 2), "axis": (0, 1, 0)},
            {"kind": "S", "at": (0, 0, 2)},
        ]
    )
    motion = linkage.motion(36)
    assert [c.motion_type for c in motion] == ["double-slider"]
    assert motion.change_points == ()
    x, y = column(motion.circuits[0], "x"), column(motion.circuits[0], "y")
    np.testing.assert_allclose(np.hypot(x, y - 10.0), 10.0, atol=1e-9)


def test_axes_that_the_line_keeps_away_from_stay_as_they_were():
    assert sb.load("rssr").spin_axes.keys() == {"ball_a"}
    linkage, _ = slider_crank(1.0, 3.0, from_slide=False)
    np.testing.assert_allclose(linkage.spin_axes["ball_a"], [0.0, 0.0, 1.0], atol=1e-15)


def test_slides_in_one_direction_are_idle_across_turns_about_it_from_either_end():
    up, along = (0, 1, 0), (1, 0, 0)
    places = [(-2, 0, -1), (0, -2, 1), (1, 1, 1), (-1, -2, 0), (1, 0, -2), (-1, -1, 0)]
    axes = [up, along, along, along, up, (0, 0, 1)]
    joints = [
        {"name": f"j{k + 1}", "kind": kind, "at": list(at), "axis": list(axis)}
        for k, (kind, at, axis) in enumerate(zip("RPRCRR", places, axes, strict=True))
    ]
    for order, links in ((joints, "2 and 3"), (joints[::-1], "3 and 4")):
        motion = sb.from_axes(order).motion(24, input="j1", output="j6")
        assert motion.motion_type == "rigid"
        (idle,) = motion.mobility.idle
        assert idle.startswith(f"slide of links {links} together along the common direction of j")
