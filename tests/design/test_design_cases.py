"""The designs on the page of cases do what it says, by formulas that share nothing with the program's solvers."""

import re

import numpy as np

from places import DOCS

PAGE = (DOCS / "design-cases.md").read_text(encoding="utf-8")

#: Crank angles of the nozzle.
CRANK = np.radians(np.linspace(0.0, 90.0, 91))


def places(label):
    """The places in a row of a table."""
    row = next(line for line in PAGE.splitlines() if line.startswith(f"| {label}"))
    return [np.array([float(x) for x in one.split(",")]) for one in re.findall(r"\(([^()]*,[^()]*)\)", row)]


def turned(place, axis, angles):
    """A place (3,) turned about an axis through the origin by angles (n,): Rodrigues' formula."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    return c * place + s * np.cross(axis, place) + (1 - c) * (axis @ place) * axis


def test_the_nozzle_opens_by_its_angle_within_its_cones():
    (a,), (b,) = places("A, as drawn"), places("B, as drawn")
    hinge, axis = np.array([40.0, 90.0, 330.0]), np.array([-1.0, -0.3, -0.1])
    axis /= np.linalg.norm(axis)
    ball = turned(a, np.array([0.0, 0.0, 1.0]), CRANK)
    arm, rod = b - hinge, np.linalg.norm(b - a)
    # |hinge + R arm - A| = rod, by bisection, one crank angle after the other
    flap = [0.0]
    for at in ball[1:]:
        tried = flap[-1] + np.radians(np.linspace(0.0, 2.0, 2001))
        left = np.linalg.norm(hinge + turned(arm, axis, tried) - at, axis=1) - rod
        k = int(np.flatnonzero(np.sign(left[:-1]) != np.sign(left[1:]))[0])
        flap.append(tried[k] + (tried[k + 1] - tried[k]) * left[k] / (left[k] - left[k + 1]))
    flap = np.array(flap)
    assert (np.diff(flap) > 0).all()
    # the page has five digits
    assert abs(np.degrees(flap[-1]) - 23.75) < 1e-3
    assert abs(np.abs(np.degrees(flap) - 23.75 / 90 * np.degrees(CRANK)).max() - 0.408) < 2e-3
    way = hinge + turned(arm, axis, flap) - ball
    way /= np.linalg.norm(way, axis=1)[:, None]
    at_crank = np.degrees(np.arccos(way[:, 2]))
    # the stud of the flap is upright as drawn and turns with it
    stud = turned(np.array([0.0, 0.0, 1.0]), axis, flap)
    at_flap = np.degrees(np.arccos((way * stud).sum(axis=1)))
    assert at_crank.max() < 15.001
    assert at_flap.max() < 15.001
    assert at_flap.max() > 14.99


def test_the_steering_is_as_near_to_ackermann_as_the_page_says():
    (left, right) = [np.append(place, 0.0) for place in places("ends of the arms")]
    pivots = np.array([0.0, 600.0, 0.0]), np.array([0.0, -600.0, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    rod = np.linalg.norm(left - right)
    angles = np.radians(np.linspace(-29.0, 38.0, 68))
    ends = pivots[0] + turned(left - pivots[0], up, angles)
    found = []
    for at, angle in zip(ends, angles, strict=True):
        wanted = np.arctan(np.tan(angle) / (1 + 0.48 * np.tan(angle)))
        tried = wanted + np.radians(np.linspace(-2.0, 2.0, 4001))
        other = pivots[1] + turned(right - pivots[1], up, tried)
        error = np.linalg.norm(other - at, axis=1) - rod
        k = int(np.flatnonzero(np.sign(error[:-1]) != np.sign(error[1:]))[0])
        found.append(tried[k] - wanted)
    assert abs(np.degrees(np.abs(found).max()) - 0.459) < 3e-3


#: The gripper's poses: place [mm] and angle [deg].
POSES = ((0.0, 0.0, 0.0), (20.0, 45.0, -10.0), (90.0, 50.0, -28.0), (130.0, 5.0, -40.0))


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def test_the_pick_and_place_takes_its_poses_exactly_in_order_and_without_a_dead_centre():
    (crank, rocker), (a, b) = places("pivots of crank and rocker"), places("joints A and B")
    found = []
    for x, y, angle in POSES:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turn, shift = np.array([[c, -s], [s, c]]), np.array([x, y])
        found.append((turn @ a + shift, turn @ b + shift))
    # the page has six decimals
    for one, other in found:
        assert abs(np.linalg.norm(one - crank) - np.linalg.norm(a - crank)) < 1e-4
        assert abs(np.linalg.norm(other - rocker) - np.linalg.norm(b - rocker)) < 1e-4
    # the crank goes one way, by less than a turn, and rod and rocker are never in line
    angles = np.unwrap([np.arctan2(*(one - crank)[::-1]) for one, _ in found])
    assert (np.diff(angles) > 0).all() or (np.diff(angles) < 0).all()
    arm, rod, lever = (np.linalg.norm(w) for w in (a - crank, b - a, b - rocker))
    sides = []
    for angle in np.linspace(angles[0], angles[-1], 721):
        end = crank + arm * np.array([np.cos(angle), np.sin(angle)])
        way = rocker - end
        gap = np.linalg.norm(way)
        assert abs(rod - lever) < gap < rod + lever
        sides.append(gap)
    signs = [np.sign(cross(other - one, rocker - other)) for one, other in found]
    assert len(set(signs)) == 1
    cosines = [(rod**2 + lever**2 - gap**2) / (2 * rod * lever) for gap in sides]
    assert np.degrees(np.arccos(np.abs(cosines).max())) > 23.6
