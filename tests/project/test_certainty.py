"""`python -m evidence.certainty`: a small sample of each family holds, closed forms are right, and a difference is reported."""

import math

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_rssr import Rssr
from evidence.certainty import __main__ as command
from evidence.certainty.family import Family, judged
from evidence.certainty.limits import nearest, planar_limits, rssr_limits, spherical_limits, widest
from evidence.certainty.moving import in_line, on_great_circle, regulus, second_order
from evidence.certainty.narrow import moved, planar, reach
from evidence.fuzz.checks import hold
from evidence.fuzz.edges import singular_pose
from evidence.fuzz.random_linkages import Dimensions
from evidence.fuzz.random_loops import drawn

SAMPLE = ("planar", "four-bars", "kites", "RSSR, closed form", "Bennett", "screws as jack")


def test_a_small_sample_holds_and_the_page_has_every_family(tmp_path, monkeypatch, capsys):
    few = {name: family for name, family in command.FAMILIES.items() if name.startswith(SAMPLE)}
    monkeypatch.setattr(command, "FAMILIES", few)
    page = tmp_path / "certainty.md"
    assert command.main(["--quick", "--processes", "1", "--out", str(page)]) == 0, capsys.readouterr().out
    text = page.read_text(encoding="utf-8")
    for name, family in few.items():
        assert f"| {name} | {family.quick} | 0 |" in text


@pytest.mark.parametrize("share", [1 / 64, pytest.param(1 / 8, marks=pytest.mark.proof)])
@pytest.mark.parametrize("name", command.FAMILIES)
def test_a_few_of_each_family_hold(name, share):
    family = command.FAMILIES[name]
    count = math.ceil(share * family.quick)
    row = judged(family, 2, 0, count)
    # a change point is reported some 1e-5 rad off, too, as docs/not-covered.md says
    others = [what for _, what in row.differences if not what.startswith("change-point with limits")]
    assert (row.linkages, others) == (count, [])


@pytest.mark.parametrize(
    ("name", "case"),
    [("planar 4R, nearly stretched", 3), ("spherical 4R, nearly stretched", 15), ("RCCRR, narrow", 5)],
)
def test_cases_in_which_something_was_found_hold_now(name, case):
    assert judged(command.FAMILIES[name], 1, case, case + 1).differences == []


def test_what_does_not_hold_and_what_is_raised_are_differences_and_the_command_reports_them(
    tmp_path, monkeypatch, capsys
):
    def odd(_, seen):
        seen["seen"] += 1
        hold(seen["seen"] % 2, "even")

    def raising(*_):
        raise ValueError("no such thing")

    broken = {
        name: Family("Change points", name, 4, judge) for name, judge in (("odd", odd), ("raising", raising))
    }
    assert judged(broken["odd"], 1, 0, 4).differences == [(1, "even"), (3, "even")]
    monkeypatch.setattr(command, "FAMILIES", broken)
    page = tmp_path / "certainty.md"
    assert command.main(["--out", str(page), "--processes", "1"]) == 1
    assert "raising, case 2: ValueError: no such thing" in capsys.readouterr().out
    assert "| odd | 3 | even |" in page.read_text(encoding="utf-8")
    assert command.main(["--again", "raising", "3"]) == 1
    with pytest.raises(SystemExit):
        command.main(["--again", "nothing", "3"])


def test_every_family_has_its_own_name_and_part():
    from evidence.certainty import changes, counted, moving, narrow, nets, spatial_nets
    from evidence.certainty.page import ASKED

    modules = (narrow, counted, changes, moving, nets, spatial_nets)
    every = [family for module in modules for family in module.FAMILIES]
    assert len(command.FAMILIES) == len(every)
    assert {family.part for family in every} == set(ASKED)


def test_limits_of_a_four_bar_are_where_coupler_and_rocker_are_in_line():
    sides = np.array([2.0, 1.0, 2.2, 2.9])
    limits = [float(x.real) for x in planar_limits(sides) if abs(x.imag) < 1e-20]
    found = planar(sides).motion(24).limits
    # the description counts from the extension of the ground
    np.testing.assert_allclose(np.sort(np.mod(np.array(limits) + math.pi, math.tau)), found, atol=1e-12)


def test_small_spherical_four_bars_have_the_limits_of_planar_ones():
    sides = np.array([2.0, 1.0, 2.2, 2.9])
    for one, other in zip(planar_limits(sides), spherical_limits(1e-6 * sides), strict=True):
        assert abs(complex(one - other)) < 1e-9


def test_limits_of_an_rssr_are_those_that_its_own_circles_have():
    d = Dimensions(M=1.0, N=0.7, L1=1.6, L3=0.9, D=-0.3, L2=1.1)
    reference: Rssr = d.reference()
    for driver, limits in zip(
        ("crank", "rocker"), rssr_limits([d.M, d.N, d.L1, d.L2, d.L3, d.D]), strict=True
    ):
        found = sorted(float(x.real) % math.tau for x in limits if abs(x.imag) < mp.mpf("1e-20"))
        np.testing.assert_allclose(found, np.sort(np.mod(reference.limits(driver), math.tau)), atol=1e-9)


def test_the_nearest_limits_are_found_over_the_turn_and_off_the_real_axis():
    near = [mp.mpc(math.pi - 1e-7), mp.mpc(-math.pi + 1e-7), mp.mpc(1, 1e-9), mp.mpc(1, -1e-9)]
    real, every = nearest(near)
    assert real == pytest.approx(2e-7, rel=1e-6)
    assert every == pytest.approx(2e-9)
    assert widest(near) == real


def test_the_width_of_a_narrow_circuit_is_that_of_the_second_order():
    for seed in range(4):
        pose = singular_pose(np.random.default_rng(seed), "RRRRRRR")
        epsilon = 1e-8
        widths = []
        for side in (1, -1):
            for circuit in moved(pose, side * epsilon).motion(24):
                low, high = circuit.input_range or (-math.pi, math.pi)
                if high - low < 0.01:
                    widths.append(high - low)
        assert widths == pytest.approx([2 * math.sqrt(epsilon * abs(reach(pose)))], rel=0.01)


@pytest.mark.parametrize("draw", [regulus, in_line, on_great_circle])
def test_shaky_poses_have_a_second_order_form_that_never_vanishes(draw):
    freedoms, form = second_order(draw(np.random.default_rng(1)))
    assert freedoms >= 1
    assert form > 1e-3


def test_a_linkage_that_moves_has_a_velocity_without_second_order():
    rng = np.random.default_rng(1)
    freedoms, form = second_order(sb.from_axes(drawn(rng, "RRRRRRR").joints))
    assert (freedoms, form) == (1, 0.0)
