"""Fronts of two wants against closed forms of a planar and a spherical four-bar, whatever order they are in."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.task import DesignTask, FigureWant, FreeNumber
from sevenbar.design.task.front import ParetoPoint, _unbeaten, pareto
from sevenbar.design.task.programs import MinimaxValues, lowered

#: The front of a planar 4R, coupler and ground 100, crank 10 to 60, rocker 30 to 150, by brute force over both:
#: how far the swing is off 50 degrees, and the greatest least transmission angle [deg].
PLANAR = {0: 57.155, 2: 58.07, 5: 59.50, 10: 61.83, 15: 63.21, 20: 64.00, 21.28: 64.11, 22.84: 64.158}


#: The arcs of coupler and ground of the gallery's spherical four-bar [rad].
ARC_2, ARC_4 = math.radians(80), math.radians(85)


def acute(cosines):
    angle = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    return np.minimum(angle, 180 - angle)


def planar(crank, rocker, coupler=100.0, ground=100.0):
    """Swing of the rocker and least transmission angle [deg] of a crank-rocker, by the law of cosines."""

    def corner(a, b, far):
        return (a * a + b * b - far * far) / (2 * a * b)

    dead = [np.arccos(np.clip(corner(ground, rocker, coupler + way * crank), -1, 1)) for way in (-1, 1)]
    angles = [acute(corner(coupler, rocker, ground + way * crank)) for way in (-1, 1)]
    return np.degrees(np.abs(dead[1] - dead[0])), np.minimum(*angles)


def spherical(crank, rocker, coupler=ARC_2, ground=ARC_4):
    """The same of arcs [rad], by the spherical law of cosines."""

    def corner(a, b, far):
        return (np.cos(far) - np.cos(a) * np.cos(b)) / (np.sin(a) * np.sin(b))

    dead = [np.arccos(np.clip(corner(ground, rocker, coupler + way * crank), -1, 1)) for way in (-1, 1)]
    angles = [acute(corner(coupler, rocker, ground + way * crank)) for way in (-1, 1)]
    return np.degrees(np.abs(dead[1] - dead[0])), np.minimum(*angles)


def four_bar_task():
    draft = Draft.of_linkage(sb.load("planar_4r")).with_values({"length_4": 100.0})
    free = (FreeNumber("length_1", 10, 60), FreeNumber("length_3", 30, 150))
    return DesignTask(draft, free, (FigureWant("swing", 50.0), FigureWant("transmission_lowest", "great")))


def best(swings, lowest, wanted, off):
    """The greatest least transmission angle of brute force, the swing off by no more [deg], but for the grid."""
    return lowest[np.abs(swings - wanted) <= off + 0.03].max()


@pytest.fixture(scope="module")
def brute_force():
    return planar(*np.meshgrid(np.linspace(10, 16, 601), np.linspace(30, 60, 901), indexing="ij"))


def test_brute_force_over_both_numbers_has_the_planar_front(brute_force):
    for off, angle in PLANAR.items():
        assert best(*brute_force, 50, off) == pytest.approx(angle, abs=0.06)


@pytest.mark.parametrize(("wants", "points"), [((1, 2), 5), ((2, 1), 6)])
def test_a_front_of_two_measures_is_that_of_brute_force_at_its_ends_and_between(wants, points, brute_force):
    front = pareto(four_bar_task(), *wants, points=points, starts=2)
    off, lowest = front.values.T if wants == (1, 2) else front.values[::-1, ::-1].T
    assert len(off) == points
    assert (off[0], lowest[0]) == pytest.approx((0, 57.155), abs=1e-3)
    assert (off[-1], lowest[-1]) == pytest.approx((22.843, 64.158), abs=1e-2)
    assert lowest == pytest.approx([best(*brute_force, 50, value) for value in off], abs=0.1)
    # its middle is there
    assert max(np.diff(off) / np.ptp(off)) <= 0.5
    for point in front.points:
        assert point.design.optimality < 1e-9
        swing, angle = planar(*point.design.values)
        assert sorted(point.values) == pytest.approx(sorted((abs(swing - 50), angle)), abs=1e-6)


def test_a_front_of_a_spherical_four_bar_is_that_of_brute_force():
    free = (FreeNumber("twist_1", 15, 50), FreeNumber("twist_3", 50, 110))
    wants = FigureWant("swing", 90.0), FigureWant("transmission_lowest", "great")
    task = DesignTask(Draft.of_linkage(sb.load("spherical_4r")), free, wants)
    front = pareto(task, "swing", "transmission_lowest", points=4, starts=1)
    arcs = np.meshgrid(
        np.radians(np.linspace(15, 50, 701)), np.radians(np.linspace(50, 110, 901)), indexing="ij"
    )
    swing, lowest = spherical(*arcs)
    for off, angle in front.values:
        # where both extremes of the angle are equal it has a kink
        assert angle == pytest.approx(best(swing, lowest, 90, off), abs=0.05)
    assert len(front.points) == 4
    assert max(point.design.optimality for point in front.points) < 1e-9


def test_a_front_over_lengths_of_a_drawing_is_that_of_the_law_of_cosines():
    # input link 40, coupler 98.5, output link 80, ground 90 as drawn
    places = {"a": (0, 0, 0), "b": (0, 40, 0), "c": (90, 80, 0), "d": (90, 0, 0)}
    joints = [{"name": name, "kind": "R", "at": at, "axis": (0, 0, 1)} for name, at in places.items()]
    free = (FreeNumber("input_link", 25, 60), FreeNumber("coupler", 70, 140))
    wants = FigureWant("swing", 70.0), FigureWant("transmission_lowest", "great")
    front = pareto(DesignTask(Draft.of_linkage(sb.from_axes(joints)), free, wants), 1, 2, points=3, starts=2)
    crank, coupler = np.meshgrid(np.linspace(25, 60, 701), np.linspace(70, 140, 1401), indexing="ij")
    with np.errstate(invalid="ignore"):
        swing, lowest = planar(crank, 80.0, coupler, 90.0)
    # those whose crank turns
    turns = 2 * (np.minimum(crank, 80) + np.maximum(coupler, 90)) <= crank + 80 + coupler + 90
    lowest = np.where(turns & (crank <= np.minimum(coupler, 80)), lowest, -1.0)
    assert len(front.points) == 3
    assert front.values[0][0] == pytest.approx(0, abs=1e-6)
    for off, angle in front.values:
        assert angle == pytest.approx(best(swing, lowest, 70, off), abs=0.1)


def test_designs_that_are_equally_good_but_for_rounding_are_one_point():
    tied = [(0.0016, 54.843858089793), (0.0103, 54.84385808979296), (0.0016 + 1e-12, 54.843858089793)]
    assert [point.values for point in _unbeaten([ParetoPoint(pair, None) for pair in tied])] == tied[:1]


@pytest.mark.parametrize("slope", [1.0, 1e2, 1e4])
def test_no_room_is_missed_for_a_lower_height_however_steep(slope):
    # least t - z with z <= 1 - curve: the room's multiplier is the slope
    def valued(z):
        room = np.array([(1 - z[0] - 0.1 * z[0] ** 2) / slope])
        by = np.array([[(-1 - 0.2 * z[0]) / slope]])
        return MinimaxValues(np.array([3.0 - z[0]]), np.array([[-1.0]]), room, by)

    end = (math.sqrt(1 + 0.4) - 1) / 0.2
    for start in (0.0, 2.5):
        assert lowered(valued, np.array([start])) == pytest.approx([end], abs=1e-5)
