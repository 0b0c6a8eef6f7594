"""The studio's curves: the picture read back is the motion's own numbers, and nothing leaves the frame."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.gallery import loops
from sevenbar.drawing import output_curves
from sevenbar.drawing.quantities import MOTION, Over, Row, quantities
from sevenbar.drawing.style import CIRCUIT_COLOURS
from sevenbar.kinematics.circuits.poses import walk
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.loop.column import Column
from sevenbar.studio.state.view import View, views_of
from sevenbar.studio.svg.curves import panels
from studio_pictures import (
    MOTIONS,
    ROCKING,
    SVG,
    area,
    by_key,
    circles,
    motion_of,
    number,
    output_panels,
    pixels,
    subpaths,
    texts,
    ticks,
    value_at,
)

# --- the picture holds the motion's numbers


@pytest.mark.parametrize(
    "name", ["rssr", "seven_r", "double-rocker", "mixed", "slide out", "slide in", "two turns"]
)
def test_every_vertex_is_a_row_of_the_circuit_to_a_tenth_of_a_pixel(name: str) -> None:
    motion = motion_of(name)
    for circuit in motion:
        (panel, *_) = output_panels(motion, circuit.index)
        below, beside = ticks(panel)
        vertices = np.concatenate(subpaths(panel))
        # a pass ends where the next one starts, and the last where the first starts
        _, first = np.unique(np.round(vertices, 6), axis=0, return_index=True)
        rows = vertices[np.sort(first)][: len(circuit.time)]
        sliding = {c: not motion.linkage.turns(c) for c in (motion.input, motion.output)}
        inputs = circuit.input if sliding[motion.input] else np.degrees(circuit.input)
        outputs = circuit.output if sliding[motion.output] else np.degrees(circuit.output)
        np.testing.assert_allclose(value_at(below, rows[:, 0]), inputs, rtol=0, atol=0.1 * pixels(below))
        apart = value_at(beside, rows[:, 1]) - outputs
        turns = 0.0 if sliding[motion.output] else 360.0 * round(apart[0] / 360.0)
        np.testing.assert_allclose(apart, turns, rtol=0, atol=0.1 * pixels(beside))


@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("over", ["input", "time"])
def test_curves_of_the_output_are_those_of_the_figures(name: str, over: Over) -> None:
    motion = motion_of(name)
    drawn = output_curves.passes(motion)
    for circuit in motion:
        for panel, word in zip(
            output_panels(motion, circuit.index, over=over),
            ("angle", "velocity", "acceleration"),
            strict=True,
        ):
            for line, part in zip(
                [p for p in drawn if p.circuit is circuit], walk(circuit).passes, strict=True
            ):
                off = panel.values[part] - line.values(word)
                turns = 360.0 * np.round(off / 360.0) if word == "angle" else 0.0 * off
                np.testing.assert_allclose(off, turns, atol=1e-9)
                assert panel.scale is not None
                across = line.across(over)
                scale = {panel.x[part][0]: across[0], panel.x[part][-2]: across[-2]}
                atol = 1e-9 * np.ptp(across)
                np.testing.assert_allclose(value_at(scale, panel.x[part]), across, atol=atol)


def test_a_power_of_ten_stands_at_the_axis_whose_numbers_it_takes() -> None:
    motion = sb.load("rssr").motion(speed=1e6)
    angle, velocity, _ = output_panels(motion, over="time")
    below, _ = ticks(angle)
    _, beside = ticks(velocity)
    assert "time [10⁻⁶ s]" in [text.text for text in texts(angle.svg)]
    assert value_at(below, angle.x)[-1] == pytest.approx(math.tau, rel=1e-3)
    assert "rocker velocity [10³ rad/s]" in [text.text for text in texts(velocity.svg)]
    assert value_at(beside, velocity.y).max() == pytest.approx(velocity.values.max() / 1e3, rel=1e-3)


@pytest.mark.parametrize("name", ["rssr", "mixed", *ROCKING])
def test_every_velocity_is_the_slope_of_its_angle_over_the_time_of_the_walk(name: str) -> None:
    motion = motion_of(name)
    found = by_key(motion)
    for circuit in motion:
        view = View(motion, circuit)
        for key in [key for key in found if key.endswith(".angle")]:
            values, rates = (
                found[key].values(view),
                found[key.replace(".angle", ".velocity")].values(view),
            )
            if found[key].unit == "deg":
                values = np.radians(values)
            for part in view.path.passes:
                inner = slice(
                    part.start + (part.stop - part.start) // 4, part.stop - (part.stop - part.start) // 4
                )
                slope = np.gradient(values, view.path.time)[inner]
                np.testing.assert_allclose(
                    rates[inner], slope, atol=2e-2 * np.abs(slope).max() + 1e-6 * abs(motion.speed)
                )


@pytest.mark.parametrize("name", ["rssr", "seven_r", "mixed"])
def test_a_points_speed_is_its_way_over_the_time(name: str) -> None:
    motion = motion_of(name)
    for point in motion.linkage.points:
        speed = by_key(motion)[f"point.{point.name}.speed"]
        assert (speed.item, speed.unit) == (point, f"{motion.linkage.length_unit}/s")
        for circuit in motion:
            view = View(motion, circuit)
            part = view.path.passes[0]
            inner = slice(
                part.start + (part.stop - part.start) // 4, part.stop - (part.stop - part.start) // 4
            )
            position = circuit.point(point.link, point.at).position[view.path.rows]
            steps = np.linalg.norm(np.gradient(position, view.path.time, axis=0), axis=1)
            np.testing.assert_allclose(
                speed.values(view)[inner], steps[inner], atol=5e-3 * steps[inner].max()
            )


@pytest.mark.parametrize("name", loops())
def test_every_angle_starts_within_half_a_turn_and_runs_on_without_a_leap(name: str) -> None:
    motion = sb.load(name).motion(samples=90)
    for circuit in motion:
        view = View(motion, circuit)
        for quantity in quantities(motion):
            if quantity.unit != "deg" or quantity.key == "transmission angle":
                continue
            values = quantity.values(view)
            known = values[np.isfinite(values)]
            if known.size:
                assert -180.0 < known[0] <= 180.0 + 1e-6
            if np.isfinite(values).all():
                off = (values[:-1] - np.degrees(circuit.q[view.path.rows[:-1], quantity.item.number])) / 360.0
                np.testing.assert_allclose(off, round(off[0]), atol=1e-9)
                assert np.abs(np.diff(values)).max() < 60


def test_a_start_at_half_a_turn_does_not_flicker_with_its_rounding() -> None:
    motion = motion_of("rssr")
    circuit = motion.circuits[1]
    assert math.degrees(circuit.output[0]) == pytest.approx(180)
    for nudge in (-1e-10, 0.0, 1e-10, math.tau, -math.tau - 1e-10):
        nudged = replace(circuit, q=circuit.q + nudge)
        assert quantities(motion)[0].values(View(motion, nudged))[0] == pytest.approx(180)


# --- what can be drawn


def test_quantities_are_the_output_then_every_other_column_then_the_points() -> None:
    motion = motion_of("slide out")
    found = quantities(motion)
    assert [(q.name, q.unit) for q in found[:3]] == [
        ("slider position (output)", "mm"),
        ("slider velocity (output)", "mm/s"),
        ("slider acceleration (output)", "mm/s²"),
    ]
    columns = [name for name in motion.linkage.columns if name not in (motion.input, motion.output)]
    keys = [f"column.{name}.{word}" for name in columns for word in ("angle", "velocity", "acceleration")]
    points = [
        f"point.{point.name}.{word}" for point in motion.linkage.points for word in ("speed", "acceleration")
    ]
    assert [q.key for q in found[3:]] == ["transmission angle", *keys, *points]


@pytest.mark.parametrize("name", ["rssr", "double-rocker", "slide in"])
def test_a_new_quantity_is_one_row_of_the_list(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    jerk = Row[TimedWalk](
        Column, "jerk", "{unit}/s³", 3, lambda one, column: one.circuit.dddq[one.path.rows, column.number]
    )
    monkeypatch.setattr("sevenbar.drawing.quantities.MOTION", (*MOTION, jerk))
    motion = motion_of(name)
    circuit = motion.circuits[0]
    values = circuit.dddq[walk(circuit).rows, circuit.output_column]
    # in the studio's menu and pictures, and in figures
    found = by_key(motion)["output.jerk"]
    assert (found.name, found.label()) == (f"{motion.output} jerk (output)", f"{motion.output} jerk [rad/s³]")
    (panel,) = panels(views_of(motion), [found])
    np.testing.assert_array_equal(panel.values, values)
    line, *_ = sb.plot.curves(motion, "input", quantities=["jerk"]).axes[0].lines
    np.testing.assert_array_equal(line.get_ydata(), values[walk(circuit).passes[0]])


def test_names_differ_even_where_a_joint_and_a_point_are_called_the_same() -> None:
    joints: list[dict[str, Any]] = [
        {"kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1), "name": "output"},
        {"kind": "S", "at": (0, 100, 0)},
        {"kind": "S", "at": (220, 130, 0)},
        {"kind": "R", "at": (200, 0, 0), "axis": (0, 0, 1), "name": "P"},
    ]
    points = [{"name": "P", "link": 2, "at": (0, 100, 0)}, {"name": "output", "link": 2, "at": (0, 100, 0)}]
    motion = sb.from_axes(joints, points=points).motion(input="P")
    found = quantities(motion)
    assert len({q.name for q in found}) == len({q.key for q in found}) == len(found)


# --- limits, gaps, extremes, ranges


@pytest.mark.parametrize("name", [*ROCKING, "mixed"])
def test_limits_stand_at_the_inputs_where_the_motion_ends(name: str) -> None:
    motion = motion_of(name)
    for panel in output_panels(motion):
        below, _ = ticks(panel)
        lines = [
            e
            for e in ET.fromstring(panel.svg).iter(f"{SVG}path")
            if (e.findtext(f"{SVG}title") or "").startswith("input limit")
        ]
        places = np.array([float(re.match(r"M([-\d.]+)", e.get("d", ""))[1]) for e in lines])  # type: ignore[index]
        sliding = not motion.linkage.turns(motion.input)
        ends = np.array([end for circuit in motion for end in circuit.input_range or ()])
        wanted = ends if sliding else np.degrees(ends)
        for end in wanted:
            assert np.abs(value_at(below, places) - end).min() < 0.1 * pixels(below)
        values = np.array([number(re.search(r"[−\d.]+", e[0].text or "")[0]) for e in lines])  # type: ignore[index]
        np.testing.assert_allclose(values, value_at(below, places), atol=0.2 * pixels(below) + 0.06)
        beside_lines = [t.text for t in texts(panel.svg) if t.y == panel.frame.box[1] - 3]
        assert beside_lines
        assert set(beside_lines) <= {(e[0].text or "").removeprefix("input limit ") for e in lines}


@pytest.mark.parametrize("name", ["double-rocker", "parallelogram"])
def test_a_line_breaks_where_there_is_no_rate_and_nowhere_else(name: str) -> None:
    motion = motion_of(name)
    for circuit in motion:
        angle, *rates = output_panels(motion, circuit.index)
        passes = walk(circuit).passes
        assert [len(line) for line in subpaths(angle)] == [part.stop - part.start for part in passes]
        for panel in rates:
            known = ["".join("01"[int(x)] for x in np.isfinite(panel.values[part])) for part in passes]
            assert any("0" in part for part in known)
            runs = [len(run) for part in known for run in part.split("0") if run]
            assert [len(line) for line in subpaths(panel)] == runs


def test_extremes_are_marked_on_the_curve_with_the_papers_numbers() -> None:
    table = ((-0.1222, 1.189), (-5.445, 7.96), (-137.6, 56.92))
    for panel, (low, high) in zip(output_panels(motion_of("rssr")), table, strict=True):
        _, beside = ticks(panel)
        marks = circles(panel)
        values = value_at(beside, np.array([y for _, y, _ in marks]))
        told = [number(re.search(r"[−\d.]+", title)[0]) for *_, title in marks]  # type: ignore[index]
        wanted = np.degrees([low, high]) if "°" in marks[0][2] else np.array([low, high])
        np.testing.assert_allclose(values, wanted, atol=0.2 * pixels(beside))
        np.testing.assert_allclose(told, wanted, atol=2e-3 * np.ptp(wanted))
        for x, y, _ in marks:
            assert np.hypot(panel.x - x, panel.y - y).min() < 1.5


def test_endless_rates_leave_room_for_the_rest_and_the_picture_says_so() -> None:
    angle, *rates = output_panels(motion_of("double-rocker"))
    assert "axis cut" not in angle.svg
    for panel in rates:
        assert panel.scale is not None
        assert "axis cut" in panel.svg
        assert panel.scale.high < np.nanmax(np.abs(panel.values)) / 3
        inside = (panel.y > panel.frame.box[1]) & (panel.y < panel.frame.box[3])
        assert inside.mean() > 0.75


@pytest.mark.parametrize("name", ["seven_r", "mixed", "slide out", "rssr"])
def test_the_chosen_circuit_has_a_third_of_the_height_in_every_rate(name: str) -> None:
    motion = motion_of(name)
    rates = [quantity for quantity in quantities(motion) if quantity.row.order and not quantity.row.is_size]
    for circuit in motion:
        for panel in panels(views_of(motion), rates, circuit.index):
            _, top, _, bottom = panel.frame.box
            if panel.scale is None or np.nanmax(panel.values) - np.nanmin(panel.values) < 1e-6:
                continue
            inside = panel.y[np.isfinite(panel.y)].clip(top, bottom)
            assert np.ptp(inside) > 0.28 * (bottom - top)


def test_a_constant_rate_is_drawn_flat_and_has_no_extremes() -> None:
    motion = sb.load("five_bar").motion()
    for panel in output_panels(motion)[1:]:
        assert np.ptp(panel.y) < 0.01
        assert circles(panel) == []


def test_the_chosen_circuit_is_in_front_in_its_own_colour() -> None:
    motion = motion_of("seven_r")
    for circuit in motion:
        groups = area(output_panels(motion, circuit.index)[0]).findall(f"{SVG}g")
        assert groups[-1].get("stroke") == CIRCUIT_COLOURS[circuit.index]
        faint = [group.get("stroke") for group in groups[0]]
        assert len(faint) == 7
        assert not set(faint) & set(CIRCUIT_COLOURS)


def test_a_pass_on_which_the_input_falls_is_dashed() -> None:
    motion = motion_of("double-rocker")
    path = walk(motion.circuits[0])
    lines = area(output_panels(motion)[0]).findall(f"{SVG}g")[-1]
    falls = [path.input[part][-1] < path.input[part][0] for part in path.passes]
    assert falls == [line.get("stroke-dasharray") is not None for line in lines]
    assert any(falls)


# --- the transmission angle


def test_the_transmission_angle_of_a_four_bar_is_that_of_its_triangle() -> None:
    motion = sb.load("planar_4r").motion()
    (found,) = (quantity for quantity in quantities(motion) if quantity.name == "transmission angle")
    view = views_of(motion)[0]
    values = found.values(view)
    # crank 40, coupler 100, rocker 80, ground 90: law of cosines about the joint of coupler and rocker
    turned = math.pi - view.path.input
    diagonal = 40**2 + 90**2 - 2 * 40 * 90 * np.cos(math.pi - turned)
    other = 40**2 + 90**2 - 2 * 40 * 90 * np.cos(turned)
    angles = [np.degrees(np.arccos((100**2 + 80**2 - d) / (2 * 100 * 80))) for d in (diagonal, other)]
    wanted = [np.minimum(angle, 180 - angle) for angle in angles]
    assert min(np.abs(values - each).max() for each in wanted) < 1e-9
    assert values.min() == pytest.approx(29.686295, abs=1e-4)
    assert not any(
        quantity.key == "transmission angle" for quantity in quantities(sb.load("seven_r").motion())
    )


def test_axodes_are_the_axes_of_the_joints_at_their_moments() -> None:
    view = views_of(sb.load("planar_4r").motion())[0]
    # the crank turns about its own axis, in the ground and in itself
    for lines in view.axodes(1):
        middle = lines.mean(axis=1)
        assert np.abs(np.cross(lines[0, 1] - lines[0, 0], middle - middle[0])).max() < 1e-6
    # fixed and moving axode of the coupler touch along the axis of the moment, at every row
    fixed, moving = view.axodes(2)
    axes = view.circuit.screw_axes(2)
    for row in (0, 45, 200):
        frame = view.point_frame(2, float(row))
        place = frame[:3, :3] @ axes.moving_point[row] + frame[:3, 3]
        assert np.abs(place - axes.point[row]).max() < 1e-9 * view.frame.span
    assert len(fixed) == len(moving) > 50


def test_a_curve_fills_its_picture_where_another_circuit_lies_far_away() -> None:
    """A press whose mirrored circuit has its ram 800 mm higher."""
    z = [0, 0, 1]
    joints = [
        {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": z},
        {"name": "pin", "kind": "R", "at": [50, 0, 0], "axis": z},
        {"name": "wrist", "kind": "R", "at": [0, -397, 0], "axis": z},
        {"name": "ram", "kind": "P", "at": [0, -397, 0], "axis": [0, 1, 0]},
    ]
    motion = sb.from_axes(joints).motion()
    views = views_of(motion)
    (panel,) = panels(views, quantities(motion)[:1], 0)
    assert panel.scale is not None
    assert np.ptp(panel.values) > 0.8 * (panel.scale.high - panel.scale.low)
