"""What hard use found and what was mended, each by the case that showed it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sevenbar as sb
from drawn_anew import changed, joints_of
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.checks import circuits_are_distinct
from evidence.fuzz.random_linkages import random_rotation
from sevenbar.description.forms import from_description
from sevenbar.errors import MOST_LISTED, DescriptionError, TableError
from sevenbar.measuring.measured import Ends, read_measured


@pytest.mark.parametrize("way", ["auto", "general"])
def test_a_limit_a_rounding_below_zero_is_zero_and_not_a_whole_turn(way: str) -> None:
    # (L1 - M)^2 + (D + L3)^2 + N^2 = 25 + 16 + ..; the coupler is that of a pose at crank 0
    linkage = sb.rssr(M=-4, N=-4, L1=1, L2=float(np.sqrt(41)), L3=1, D=-3)
    limits = linkage.motion(24, method=way).limits
    assert limits.size == 2
    assert (limits < 2 * np.pi).all()
    assert limits[0] == pytest.approx(0.0, abs=1e-12)
    assert limits[1] == pytest.approx(1.0622081145647357, abs=1e-9)


def test_thousands_of_mistakes_are_one_message_of_some_lines() -> None:
    with pytest.raises(DescriptionError) as caught:
        sb.loads("format = 1\n" + '[[point]]\nname = ""\nlink = 0\nat = 0\n' * 900 + "[rssr]\n", "f.toml")
    lines = str(caught.value).splitlines()
    assert len(caught.value.problems) == 3 * 900 + 5
    assert lines[:MOST_LISTED] == [f"f.toml: {problem}" for problem in caught.value.problems[:MOST_LISTED]]
    assert lines[MOST_LISTED:] == [f"f.toml: and {3 * 900 + 5 - MOST_LISTED} more mistakes; mend these first"]


def test_as_many_mistakes_as_a_message_holds_are_all_told() -> None:
    names = "".join(f"wrong_{k} = 1\n" for k in range(MOST_LISTED + 1))
    right = "M = 1\nN = 1\nL1 = 1\nL3 = 1\nD = 0\n"
    for cut, last in ((names, "f.toml: and 1 more mistake; mend these first"), (names[:-12], "")):
        with pytest.raises(DescriptionError) as caught:
            sb.loads(f"format = 1\n[rssr]\n{right}{cut}", "f.toml")
        assert str(caught.value).splitlines()[MOST_LISTED:] == ([last] if last else [])


@pytest.mark.parametrize("value", ["1979-05-27", "07:32:00", "1979-05-27 07:32:00"])
def test_a_date_in_the_place_of_a_number_is_quoted_as_the_file_has_it(value: str) -> None:
    with pytest.raises(DescriptionError) as caught:
        sb.loads(f"format = 1\n[rssr]\nM = {value}\nN = 1\nL1 = 1\nL3 = 1\nD = 0\n", "f.toml")
    assert str(caught.value) == f"f.toml: rssr.M: {value} is not a number; give a number"


def test_a_column_s_name_with_a_tab_in_it_is_told_without_one(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_bytes(b"% time angle\n0-0\ntime\trocker\n,0\n")
    with pytest.raises(TableError) as caught:
        read_measured(tmp_path / "t.csv", Ends("crank", "rocker"))
    assert "the columns are 'time\\trocker', 2; " in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("seed", [76336, 217])
def test_an_output_that_turns_back_where_the_input_does_has_the_range_of_its_rows(seed: int) -> None:
    # its rate is zero to the last digit at the input's dead centre, where no sign told of a change
    for circuit in sb.from_axes(joints_of(seed)).motion(720):
        assert circuit.output_range is not None
        low, high = circuit.output_range
        assert low - 1e-9 < circuit.output.min() < low + 1e-3
        assert high - 1e-3 < circuit.output.max() < high + 1e-9


def test_an_output_that_turns_back_with_the_input_is_found_whatever_the_sign_of_a_zero() -> None:
    # its rate at the input's second dead centre is -7e-19 in one step and positive in the next: a range of one value was told
    links = [
        ("R", 0.7666154415997574, 1.9314255591877465, 0.0),
        ("R", 1.000682865643703, 2.2659878146785015, 0.11323982217663389),
        ("R", 0.0, 0.32113236427063724, 0.0),
        ("R", 0.0, 1.133440405648523, 0.0),
        ("R", -0.7220040718095257, -0.4936495973211502, -4.177933441766984),
        ("R", 1.4093723118170096, -0.3808712668512755, 3.0159170347180146),
        ("R", 0.0, 2.4959494703542697, 1.2099739771445558),
    ]
    table = [dict(zip(("joint", "length", "twist", "offset"), link, strict=True)) for link in links]
    linkage = from_description({"format": 1, "angle_unit": "rad", "link": table})
    rng = np.random.default_rng(0)
    for _ in range(100):
        for circuit in linkage.motion(36):
            assert circuit.output_range == pytest.approx(
                (circuit.output.min(), circuit.output.max()), abs=1e-12
            )
            assert sum(d.kind == "output" for d in circuit.dead_centres) == 2
        for link in table:
            link["length"] *= 1 + 1e-6 * rng.normal()
            link["twist"] *= 1 + 1e-6 * rng.normal()
        linkage = from_description({"format": 1, "angle_unit": "rad", "link": table})


#: Two parallel slides move against each other for ever, in small steps, with all else at rest.
SLIDES_ONLY = """
format = 1
[[joint]]
kind = "H"
at = [-1.0, 10.0, 1.0]
axis = [0.0, 0.0, -1.0]
pitch = 1.0
[[joint]]
kind = "R"
at = [-1.0, -1.0, 1.0]
axis = [3.0, 4.0, 0.0]
[[joint]]
kind = "P"
at = [1.0, 0.0, 0.5]
axis = [3.0, 4.0, 0.0]
[[joint]]
kind = "S"
at = [0.5, 10.0, 0.5]
[[joint]]
kind = "P"
at = [-1.0, 0.0, 0.0]
axis = [3.0, 4.0, 0.0]
"""


def test_a_motion_of_two_slides_alone_meets_one_of_all_joints() -> None:
    # 941 places of the slides' motion were each followed to its ends; in the pose drawn the motion of all joints leaves it, a
    # motion that was not found
    linkage = sb.loads(SLIDES_ONLY)
    turning = linkage.motion(24, input="theta_1")
    (circuit,) = turning.circuits
    assert turning.motion_type == "change-point"
    assert np.ptp(circuit.input) > 5
    assert np.nanmax(circuit.residual) < 1e-10 * circuit.size
    assert (np.ptp(circuit.q, axis=0) > 0.05).all()
    sliding = linkage.motion(24, input="theta_3").circuits
    moved = [
        {name for name, by in zip(linkage.columns, np.ptp(c.q, axis=0), strict=True) if by > 1e-6}
        for c in sliding
    ]
    assert {"theta_3", "theta_5"} in moved
    assert set(linkage.columns) in moved


def test_an_extreme_beside_the_first_row_of_a_circuit_is_found() -> None:
    rng = np.random.default_rng(0)
    rotation, shift = random_rotation(rng), rng.normal(size=3)
    joints = changed(joints_of(58693), lambda p: rotation @ p + shift, lambda _, a: rotation @ a)
    linkage = sb.from_axes(joints)
    for coarse, fine in zip(linkage.motion(24, speed=1.0), linkage.motion(7200, speed=1.0), strict=True):
        jerk = fine.dddq[:, fine.output_column]
        assert coarse.jerk is not None
        assert coarse.jerk.lowest == pytest.approx(jerk.min(), rel=1e-5)
        assert coarse.jerk.highest == pytest.approx(jerk.max(), rel=1e-5)


def test_turns_of_balls_close_the_loop_also_where_the_middle_one_is_a_quarter_but_for_1e_8() -> None:
    # the coupler runs along the crank's axis within 1e-8, where each turn has eight digits: the loop was open by 1 rad
    for near in (
        {"M": -1e-100, "N": -2.0, "L1": 1e-12, "L2": 1.000000000000001, "L3": 0.999999999999999, "D": 1e-12},
        {"M": 1e-50, "N": -1.000000000000001, "L1": 1.000000000000001, "L2": 2.0,
         "L3": 0.999999999999999, "D": 1.000000000000001},
    ):  # fmt: skip
        linkage = sb.rssr(**near)
        motion = linkage.motion(24)
        assert motion.circuits
        for circuit in motion:
            q = circuit.q[np.isfinite(circuit.q).all(axis=1)]
            assert len(q) > 20
            assert Loop.of(linkage).errors(q).max() < 1e-13


def test_a_transmission_angle_is_a_number_where_rounding_hides_its_greatest_or_no_direction_is() -> None:
    # an arc of 1.6e-4 rad of a crank of 1e12; a ball that comes to lie in the rocker's axis
    for near in (
        {"M": -1e-50, "N": -1e-12, "L1": 1e12, "L2": 1.000000000000001, "L3": 1.0, "D": 1e12},
        {"M": 0.0, "N": 0.0, "L1": 1.0, "L2": 4.123105625617661, "L3": 4.0, "D": 0.0},
    ):
        for circuit in sb.rssr(**near).motion(24):
            assert circuit.transmission is not None
            assert circuit.transmission.lowest == 0.0
            assert 0.0 <= circuit.transmission.highest < np.pi / 2


def test_rates_that_peak_where_no_digit_of_them_is_left_have_no_extremes() -> None:
    # the branches pass each other 1e-6 rad apart: -0.19 was told where rows have -0.21, and the peak is a million
    near = {
        "M": -0.6996653530221741,
        "N": -0.22343997509953906,
        "L1": 0.12538361869805814,
        "L2": 0.8598965151848134,
        "L3": 0.30326643962482946,
        "D": -0.4806146874610435,
    }
    for circuit in sb.rssr(**near).motion(36):
        assert circuit.input_range is None
        assert (circuit.velocity, circuit.acceleration, circuit.jerk) == (None, None, None)
    # a little farther apart the peak is found; it is that of rows close around it
    apart = sb.rssr(**(near | {"L2": near["L2"] + 1e-9}))
    circuit = apart.motion(36, speed=1.0).circuits[0]
    assert circuit.acceleration is not None
    around = circuit.acceleration.lowest_at + np.linspace(-1e-4, 1e-4, 2001)
    rows = apart.output(around, order=2, speed=1.0).acceleration
    assert rows is not None
    assert circuit.acceleration.lowest == pytest.approx(rows[circuit.branch[0]].min(), rel=1e-9)


@pytest.mark.parametrize("size", [1e-9, 1e-3, 1e6])
def test_limits_of_a_slide_are_told_apart_in_any_unit(size: float) -> None:
    joints = joints_of(194)
    assert joints[0]["kind"] in "PC"
    scaled = changed(joints, lambda p: size * p, lambda _, a: a)
    limits = sb.from_axes(joints).motion(24).limits
    assert limits.size == 4
    np.testing.assert_allclose(sb.from_axes(scaled).motion(24).limits, size * limits, rtol=1e-9)


def test_a_mode_whose_ball_has_no_turns_says_so() -> None:
    # the coupler lies along the axis of the rocker, which names no direction for its spin
    linkage = sb.rssr(M=1, N=-1e-100, L1=0.999999999999999, L2=1e12, L3=1e12, D=0)
    modes = linkage.assembly_modes(-2.8120940746012515)
    assert list(modes.status) == ["turns-undefined"] * 2
    assert np.isfinite(modes.q[:, [0, -1]]).all()
    assert np.isnan(modes.q).any(axis=1).all()
    assert list(sb.load("rssr").assembly_modes(0.3).status) == ["ok"] * 2


def test_names_in_a_list_of_what_there_is_have_no_characters_that_are_not_printed() -> None:
    text = (Path(sb.__file__).parent / "description" / "gallery" / "screw_drill.toml").read_text(
        encoding="utf-8"
    )
    text = text.replace('name = "pin"', 'name = "p\ufeffin"').replace(
        'output = "spindle"', 'output = "spinel"'
    )
    with pytest.raises(sb.errors.SevenbarError) as caught:
        sb.loads(text)
    assert all(line.isprintable() for line in str(caught.value).splitlines())
    assert "\\ufeff" in str(caught.value)


def test_a_circuit_between_change_points_is_found_once() -> None:
    # at a quarter turn a slide is where it may be anything: seeds there were followed as circuits of their own
    linkage = sb.from_axes(
        [
            {"kind": "C", "at": [1, -1, 0.5], "axis": [1, 1, 0]},
            {"kind": "C", "at": [0, 0.5, 1], "axis": [0, 0, -1]},
            {"kind": "P", "at": [0, 0, 0.5], "axis": [3, 4, 0]},
            {"kind": "U", "at": [0, 2, 10], "axes": [[1, 1, 0], [0, 1, 0]]},
        ]
    )
    middles = np.array([circuit.q[len(circuit.q) // 2] for circuit in linkage.motion()])
    gaps = np.linalg.norm(middles[:, None] - middles[None], axis=2)
    assert (gaps[~np.eye(len(gaps), dtype=bool)] > 0.1).all()


def test_a_circuit_whose_steps_led_on_over_a_change_point_is_not_told_in_parts_too() -> None:
    # an antiparallelogram of slides, whose axes lean by less than the digits that a change point leaves
    revolute, leaning = (
        {"joint": "R", "length": 2, "twist": t, "offset": o} for t, o in ((0, 1), (1e-9, -1))
    )
    slide = {"joint": "P", "length": -1, "twist": -90, "angle": 0}
    linkage = from_description({"format": 1, "link": [revolute, leaning, slide, revolute, leaning, slide]})
    motion = linkage.motion(24)
    assert motion.motion_type == "change-point"
    circuits_are_distinct(motion)


def test_a_motion_too_long_to_hold_is_not_told_again_from_each_of_its_modes() -> None:
    # three screws go on for more nodes than a curve may have: what was held from one mode did not reach the next
    linkage = sb.from_axes(
        [
            {"kind": "R", "at": [-1.276, 0.273, -0.921], "axis": [0.686, -0.513, -0.516]},
            {"kind": "H", "at": [-1.275, 0.895, -0.342], "axis": [-0.626, 0.542, -0.561], "pitch": -0.304},
            {"kind": "R", "at": [-1.268, -1.179, -1.164], "axis": [-0.545, -0.091, 0.834]},
            {"kind": "H", "at": [-0.857, -1.106, 1.252], "axis": [0.521, 0.646, -0.558], "pitch": 1.644},
            {"kind": "R", "at": [-2.456, -0.649, -1.096], "axis": [0.591, 0.067, 0.804]},
            {"kind": "R", "at": [0.951, 0.138, -0.173], "axis": [-0.872, -0.29, 0.394]},
            {"kind": "H", "at": [0.86, 0.999, 0.696], "axis": [0.147, -0.178, -0.973], "pitch": -1.284},
        ]
    )
    motion = linkage.motion(24)
    assert sum(not circuit.closed for circuit in motion) == 1
    circuits_are_distinct(motion)


def test_a_screw_turned_once_more_is_another_pose_however_small_its_pitch_beside_the_loop() -> None:
    linkage = sb.from_axes(
        [
            {"kind": "C", "at": [0, 0, 0], "axis": [0, 0, 1]},
            {"kind": "U", "at": [1e8, 0, 0], "axes": [[1, 0, 0], [0, 1, 0]]},
            {"kind": "H", "at": [0, 2, 0], "axis": [0, 1, 0], "pitch": 3},
            {"kind": "P", "at": [0, 2, 5], "axis": [1, 1, 0]},
            {"kind": "R", "at": [1, 2, 3], "axis": [1, 1, 2]},
        ]
    )
    motion = linkage.motion(24)
    circuits_are_distinct(motion)
    # the slide makes up for the pitch: no two circuits are one
    middles = np.array([circuit.q[len(circuit.q) // 2] for circuit in motion])
    gaps = np.linalg.norm(middles[:, None] - middles[None], axis=2)
    assert (gaps[~np.eye(len(gaps), dtype=bool)] > 1.0).all()
