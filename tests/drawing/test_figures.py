"""Figures of any loop: drawn links are rigid, drawn numbers are the motion's own."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import sevenbar as sb
from gallery_sample import FEW, sampled
from sevenbar.description.gallery import loops
from sevenbar.drawing import output_curves, paths, plot, skeleton
from sevenbar.drawing.animate import animate
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.loop.rigid import inverse, pose


@pytest.fixture(scope="module")
def motions() -> dict[str, sb.Motion]:
    return {name: sb.load(name).motion(samples=48) for name in loops()}


@pytest.mark.parametrize("name", loops())
def test_the_joints_values_lead_to_the_links_places(motions: dict[str, sb.Motion], name: str) -> None:
    motion = motions[name]
    for circuit in motion:
        rows = np.flatnonzero(~np.isnan(circuit.q).any(axis=1))
        given = poses(motion.linkage, circuit.q[rows])
        for i, own in enumerate(motion.linkage.point_frames[:-1]):
            x, y, z = map(float, inverse(own)[:3, 3])
            turn, place = (
                circuit.link_motion(i + 1).rotation[rows],
                circuit.point(i + 1, (x, y, z)).position[rows],
            )
            np.testing.assert_allclose(given[:, i], pose(turn, place), atol=1e-9 * max(circuit.size, 1.0))


@pytest.mark.parametrize("name", loops())
def test_drawn_links_are_rigid_and_meet_in_the_joints(motions: dict[str, sb.Motion], name: str) -> None:
    motion = motions[name]
    slide = {i for i, joint in enumerate(motion.linkage.joints) if joint.kind in "PCHE"}
    for circuit in motion:
        frame = skeleton.skeleton(motion, circuit)
        for link in frame.polylines:
            for a, b in pairwise(link):
                lengths = np.linalg.norm(frame.places[:, a] - frame.places[:, b], axis=1)
                assert np.nanmax(np.abs(lengths - np.nanmean(lengths))) < 1e-9 * max(circuit.size, 1.0)
        for i, (link, after) in enumerate(
            zip(frame.polylines, (*frame.polylines[1:], frame.polylines[0]), strict=True)
        ):
            if (i + 1) % len(frame.polylines) not in slide:
                gap = np.abs(frame.places[:, link[-1]] - frame.places[:, after[0]])
                assert np.nanmax(gap) < 1e-9 * max(circuit.size, 1.0)


@pytest.mark.parametrize("name", sampled((*FEW, "rccc")))
def test_each_figure_of_each_linkage_can_be_drawn(motions: dict[str, sb.Motion], name: str) -> None:
    motion = motions[name]
    middle = motion.circuits[0].input_range or (0.3, 0.3)
    modes = motion.linkage.assembly_modes(sum(middle) / 2)
    figures = [plot.configuration(motion), plot.curves(motion), plot.joints(motion)]
    figures += [plot.modes_overview(motion.linkage, modes), plot.point_path(motion, (1, (1.0, 2.0, 3.0)))]
    figures += [plot.point_path(motion, point.name) for point in motion.linkage.points]
    for figure in figures[:: 5 if name not in ("seven_r", "rccc") else 1]:
        figure.canvas.draw()


def test_a_path_holds_the_points_own_numbers(motions: dict[str, sb.Motion]) -> None:
    motion = motions["seven_r"]
    trace = motion.circuits[2].point(4, (-100, -90, -80))
    figure = plot.point_path(motion, "P", 2)
    for axes, vectors in zip(figure.axes, (trace.velocity, trace.acceleration), strict=False):
        drawn: Any = axes
        path = np.array(drawn.lines[0].get_data_3d()).T
        np.testing.assert_array_equal(path, np.concatenate([trace.position, trace.position[:1]]))
        rows, arrows, longest = paths.arrows_along(trace.position, vectors)
        assert len(rows) == paths.ARROWS
        # the greatest of all rows is named, whether it is among the arrows or not
        assert longest == np.linalg.norm(vectors, axis=1).max()
        scale = np.linalg.norm(arrows, axis=1).max() / np.linalg.norm(vectors[rows], axis=1).max()
        np.testing.assert_allclose(arrows, scale * vectors[rows], rtol=1e-12, atol=1e-12)
        assert f"at most {longest:.1f} mm/s" in drawn.get_title()
    x, y = figure.axes[2].lines[0].get_data()
    np.testing.assert_allclose(np.asarray(y)[:-1], np.linalg.norm(trace.velocity, axis=1), rtol=1e-14)
    np.testing.assert_allclose(np.asarray(x)[:-1], np.degrees(motion.circuits[2].input), rtol=1e-14)


def test_both_views_of_a_path_have_one_scale(motions: dict[str, sb.Motion]) -> None:
    figure = plot.point_path(motions["seven_r"], "P")
    first, second = ([a.get_xlim(), a.get_ylim(), a.get_zlim()] for a in figure.axes[:2])  # type: ignore[attr-defined]
    assert first == second


def test_a_point_that_does_not_exist_is_told(motions: dict[str, sb.Motion]) -> None:
    with pytest.raises(RequestError, match="point: no point 'Q'; this linkage has P"):
        plot.point_path(motions["seven_r"], "Q")
    with pytest.raises(RequestError, match="this linkage has none; give"):
        plot.point_path(motions["bennett"], "Q")
    with pytest.raises(RequestError, match="link: 9 is not a link; give 1 to 7"):
        plot.point_path(motions["seven_r"], (9, (0, 0, 0)))


def test_every_joint_has_a_panel_with_a_line_for_each_circuit(motions: dict[str, sb.Motion]) -> None:
    motion = motions["seven_r"]
    figure = plot.joints(motion)
    assert [axes.get_ylabel() for axes in figure.axes] == [f"θ{i} [deg]" for i in "₂₃₄₅₆₇"]
    for column, axes in enumerate(figure.axes, start=1):
        assert len(axes.lines) == 8
        for circuit, line in zip(motion, axes.lines, strict=True):
            values = np.asarray(line.get_ydata())
            values = values[np.isfinite(values)][:-1]
            off = np.remainder(values - np.degrees(circuit.q[:, column]) + 180.0, 360.0) - 180.0
            assert np.abs(off).max() < 1e-9
    looks = {(line.get_color(), str(line.get_linestyle())) for line in figure.axes[0].lines}
    assert len(looks) == 8


def test_slides_are_drawn_in_the_length_unit(motions: dict[str, sb.Motion]) -> None:
    motion = motions["rssp"]
    figure = plot.curves(motion, "input")
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["slider position [mm]", "slider velocity [mm/s]", "slider acceleration [mm/s²]"]
    line = next(line for line in figure.axes[0].lines if line.get_label() == "circuit 0")
    np.testing.assert_array_equal(np.asarray(line.get_ydata())[:-1], motion.circuits[0].output)
    driven = motion.linkage.motion(samples=48, input="slider", output="crank")
    figure = plot.curves(driven)
    assert figure.axes[-2].get_xlabel() == "slider position [mm]"
    marked = {
        round(float(mark.get_xdata()[0]), 6)
        for mark in figure.axes[0].lines
        if mark.get_label() == output_curves.LIMIT
    }
    assert marked == set(np.round(driven.limits, 6))
    assert "slider at ±1 mm/s" in figure.legends[0].get_title().get_text()


def test_all_modes_are_drawn_to_one_scale() -> None:
    linkage = sb.load("seven_r")
    modes = linkage.assembly_modes(math.radians(30))
    figure = plot.modes_overview(linkage, modes)
    assert [axes.get_title() for axes in figure.axes] == [f"mode {i}" for i in range(8)]
    assert len({(a.get_xlim(), a.get_ylim(), a.get_zlim()) for a in figure.axes}) == 1  # type: ignore[attr-defined]
    assert figure.get_suptitle().endswith("8 assembly modes\nat θ₁ = 30°")
    rssp = sb.load("rssp")
    with pytest.raises(RequestError, match="modes: the loop closes at no mode"):
        plot.modes_overview(rssp, rssp.assembly_modes(5000.0, input="slider"), input="slider")


def test_circuits_whose_curves_coincide_are_one_line_that_names_both(motions: dict[str, sb.Motion]) -> None:
    motion = motions["seven_r"]
    drawn = output_curves.passes(motion)
    assert len({(line.style["color"], str(line.style["ls"])) for line in drawn}) == 8
    # the 7R paper's loop: each output belongs to two circuits
    for first, second in ((0, 1), (2, 3), (4, 5), (6, 7)):
        np.testing.assert_allclose(drawn[first].values("angle"), drawn[second].values("angle"), atol=1e-9)
    figure = plot.curves(motion)
    figure.canvas.draw()
    entries = [text.get_text() for text in figure.legends[0].get_texts()]
    pairs = [f"circuits {i} and {i + 1}" for i in range(0, 8, 2)]
    assert entries == [*pairs, output_curves.EXTREME]
    box, page = figure.legends[0].get_window_extent(), figure.bbox
    assert box.x0 >= page.x0
    assert box.x1 <= page.x1


@pytest.mark.parametrize("name", ["seven_r", "rssp", "bricard_trihedral", "spherical_4r"])
def test_any_loop_can_be_animated(motions: dict[str, sb.Motion], name: str, tmp_path: Path) -> None:
    with Image.open(animate(motions[name], tmp_path / "a.gif", frames=3)) as image:
        assert image.n_frames == 3  # type: ignore[attr-defined]


def test_a_row_whose_balls_have_no_turns_is_drawn_where_its_links_are():
    motion = sb.load("rssp").motion()
    circuit = motion.circuits[0]
    q, status = circuit.q.copy(), circuit.status.copy()
    balls = [i for i, name in enumerate(circuit.columns) if name not in motion.linkage.drivable()]
    q[5, balls], status[5] = np.nan, "turns-undefined"
    lost = replace(circuit, q=q, status=status)
    drawn, whole = (skeleton.skeleton(motion, one).places for one in (lost, circuit))
    np.testing.assert_allclose(drawn, whole, atol=1e-9 * circuit.size)
