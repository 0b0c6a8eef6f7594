"""The studio's 3D picture: nodes are moved, not made anew; what is not known is not shown; the camera sees all."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from viser import ViserServer

import sevenbar as sb
from sevenbar.description import gallery
from sevenbar.drawing import skeleton
from sevenbar.drawing.skeleton import Skeleton
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.studio.pictures.stage import FIELD, Stage


@pytest.fixture(scope="module")
def server() -> Iterator[ViserServer]:
    made = ViserServer(host="127.0.0.1", port=8970, verbose=False)
    yield made
    made.stop()


@pytest.fixture
def stage(server: ViserServer) -> Stage:
    server.scene.reset()
    return Stage(server.scene)


def frame_of(name: str, circuit: int = 0) -> tuple[Motion, Skeleton]:
    motion = sb.load(name).motion()
    return motion, skeleton.skeleton(motion, motion.circuits[circuit])


def show(stage: Stage, name: str, row: float = 3.5) -> tuple[Motion, Skeleton]:
    motion, frame = frame_of(name)
    stage.frame_view(frame.places)
    stage.set(frame, (motion.input, motion.output))
    stage.pose(frame.pose(row))
    return motion, frame


def node(server: ViserServer, name: str) -> Any:
    return server.scene.get_handle_by_name(name)


@pytest.mark.parametrize("name", ["rssr", "seven_r"])
def test_dragging_moves_the_nodes_and_makes_none_anew(stage: Stage, server: ViserServer, name: str) -> None:
    motion, frame = show(stage, name)
    names = ("/linkage/cylinder", "/linkage/box", "/axes", "/joints")
    before = {name: node(server, name) for name in names}
    tubes = before["/linkage/cylinder"].batched_positions.copy()
    larger = replace(frame, places=frame.places * 1.01)
    stage.set(larger, (motion.input, motion.output))
    stage.pose(larger.pose(3.5))
    assert all(node(server, name) is handle for name, handle in before.items())
    assert np.abs(node(server, "/linkage/cylinder").batched_positions - tubes).max() > 1e-3


def test_another_linkage_replaces_shapes_and_leaves_no_node_behind(stage: Stage, server: ViserServer) -> None:
    show(stage, "rssr")
    assert node(server, "/linkage/socket") is not None
    show(stage, "seven_r")
    assert node(server, "/linkage/socket") is None
    assert node(server, "/points") is not None
    show(stage, "bennett")
    assert node(server, "/points") is None


def test_the_picture_is_the_same_for_a_linkage_of_any_size(stage: Stage, server: ViserServer) -> None:
    motion, frame = show(stage, "rssr", 7)
    large = node(server, "/linkage/cylinder").batched_positions.copy()
    small = replace(frame, places=frame.places * 2e-5 + 3.0)
    stage.frame_view(small.places)
    stage.set(small, (motion.input, motion.output))
    stage.pose(small.pose(7))
    assert np.abs(large).max() < 1.2
    assert np.abs(node(server, "/linkage/cylinder").batched_positions - large).max() < 1e-5


def test_the_scale_stays_while_a_dimension_is_dragged(stage: Stage) -> None:
    motion, frame = show(stage, "rssr")
    centre, scale = stage.centre.copy(), stage.scale
    stage.set(replace(frame, places=frame.places * 2), (motion.input, motion.output))
    stage.pose(frame.pose(0) * 2)
    assert stage.scale == scale
    assert np.array_equal(stage.centre, centre)


def test_a_pose_without_solution_hides_the_linkage_and_the_next_brings_it_back(
    stage: Stage, server: ViserServer
) -> None:
    _, frame = show(stage, "seven_r")
    stage.labels(True)
    stage.pose(np.full_like(frame.places[0], np.nan))
    moving = node(server, "/linkage/ball")
    assert (moving.batched_scales == 0).all()
    assert not node(server, "/names/0").visible
    stage.pose(frame.pose(9))
    assert (moving.batched_scales > 0).all()
    assert node(server, "/names/0").visible


def test_paths_with_gaps_have_as_many_segments_and_none_across_a_gap(
    stage: Stage, server: ViserServer
) -> None:
    motion, frame = show(stage, "rssr")
    count = len(node(server, "/joints").points)
    places = frame.places.copy()
    places[100:140, list(frame.inner.values())] = np.nan
    stage.set(replace(frame, places=places), (motion.input, motion.output))
    points = node(server, "/joints").points
    assert len(points) == count == 2 * (len(frame.places) - 1)
    assert np.isfinite(points).all()
    lengths = np.linalg.norm(points[:, 1] - points[:, 0], axis=1)
    assert (lengths == 0).sum() == 2 * 41
    assert lengths.max() < 0.02


def test_ghosts_are_the_moving_links_at_their_poses_and_keep_their_nodes(
    stage: Stage, server: ViserServer
) -> None:
    _, frame = show(stage, "rssr")
    solid = node(server, "/linkage/socket").batched_positions.copy()
    stage.ghosts([(frame.pose(3.5), None), (frame.pose(90), "#ff0000")])
    ghost = node(server, "/ghosts/socket")
    assert np.array_equal(ghost.batched_positions[:2], solid)
    assert (ghost.batched_colors[2:] == (255, 0, 0)).all()
    assert ghost.opacity == pytest.approx(0.2)
    assert node(server, "/ghosts/box") is None
    stage.ghosts([(frame.pose(10), None), (frame.pose(91), "#ff0000")])
    assert node(server, "/ghosts/socket") is ghost
    stage.ghosts([(frame.pose(row), None) for row in range(40)])
    assert len(node(server, "/ghosts/socket").batched_positions) == 2 * 16
    stage.ghosts([])
    assert node(server, "/ghosts/socket") is None


def test_arrows_point_along_their_vectors_and_none_clears_them(stage: Stage, server: ViserServer) -> None:
    _, frame = show(stage, "rssr")
    origin, vector = frame.pose(4)[1], np.array([0.0, 0.0, -300.0])
    stage.arrows([(origin, vector, "#0072B2", "v"), (origin, 0 * vector, "#D55E00", "a")])
    tip = stage.in_scene(origin + vector)
    head = node(server, "/arrows/cone")
    assert head.batched_positions[0] + (0, 0, -head.batched_scales[0, 2] / 2) == pytest.approx(tip, abs=1e-5)
    assert (head.batched_scales[1] == 0).all()
    assert node(server, "/arrow_labels/0").text == "v"
    stage.arrows([])
    assert node(server, "/arrows/cone") is None
    assert node(server, "/arrow_labels/0") is None


def test_arrows_of_joints_are_apart_from_those_of_points_and_seen_round_a_rod(
    stage: Stage, server: ViserServer
) -> None:
    _, frame = show(stage, "rssr")
    origin, way = frame.pose(0)[1], np.array([0.0, 0.0, 300.0])
    stage.arrows([(origin, way, "#ff0000", "v")])
    stage.arrows([(origin, way, "#00ff00", "12 N")], "joints")
    point, joint = (node(server, f"/{name}/cylinder") for name in ("arrows", "force_arrows"))
    assert joint.batched_scales[0, 0] > 1.5 * point.batched_scales[0, 0]
    assert joint.batched_positions == pytest.approx(point.batched_positions, abs=1e-6)
    assert node(server, "/force_labels/0").text == "12 N"
    stage.arrows([], "joints")
    assert node(server, "/force_arrows/cone") is None
    assert node(server, "/arrows/cone") is not None
    stage.arrows([(origin, way, "#00ff00", "12 N")], "joints")
    stage.clear()
    assert node(server, "/force_arrows/cone") is None
    assert node(server, "/arrows/cone") is None


def test_marks_stand_at_their_points_with_their_texts(stage: Stage, server: ViserServer) -> None:
    _, frame = show(stage, "rssr")
    stage.marks(frame.places[[0, 100], 2], ["least", "most"])
    assert node(server, "/marks/ball").batched_positions == pytest.approx(
        stage.in_scene(frame.places[[0, 100], 2]), abs=1e-6
    )
    assert [node(server, f"/mark_labels/{i}").text for i in range(2)] == ["least", "most"]
    stage.marks(np.empty((0, 3)), [])
    assert node(server, "/marks/ball") is None


def test_names_follow_the_pose_and_those_in_one_place_share_a_label(
    stage: Stage, server: ViserServer
) -> None:
    _, frame = show(stage, "rssr")
    stage.labels(True)
    assert [node(server, f"/names/{i}").text for i in range(4)] == ["crank", "A", "B", "rocker"]
    stage.pose(frame.pose(50))
    place = stage.in_scene(frame.pose(50)[frame.inner[1]])
    assert node(server, "/names/1").position[:2] == pytest.approx(place[:2])
    stage.labels(False)
    assert node(server, "/names/1") is None
    show(stage, "rscr")
    stage.labels(True)
    texts = [node(server, f"/names/{i}").text for i in range(4)]
    assert "ball, A" in texts


def test_axes_and_paths_are_shown_and_hidden(stage: Stage, server: ViserServer) -> None:
    _, frame = show(stage, "seven_r")
    stage.axes(False)
    stage.paths(False)
    stage.pose(frame.pose(50))
    assert not any(node(server, name).visible for name in ("/axes", "/joints", "/points"))
    old = node(server, "/axes").points.copy()
    stage.axes(True)
    stage.paths(True)
    assert all(node(server, name).visible for name in ("/axes", "/joints", "/points"))
    assert np.abs(node(server, "/axes").points - old).max() > 0.01


def test_an_axis_is_as_long_between_two_rows_as_at_them(stage: Stage, server: ViserServer) -> None:
    _, frame = show(stage, "seven_r")

    def lengths() -> Any:
        points = node(server, "/axes").points.reshape(7, -1, 3)
        return np.linalg.norm(points[:, -1] - points[:, 0], axis=1)

    stage.pose(frame.pose(4))
    whole = lengths()
    for row in (4.5, 60.5, 200.5):
        stage.pose(frame.pose(row))
        assert lengths() == pytest.approx(whole, rel=2e-3)


def test_a_state_out_of_date_is_grey_also_when_it_is_set_so(stage: Stage, server: ViserServer) -> None:
    motion, frame = show(stage, "seven_r")
    coloured = node(server, "/linkage/cylinder").batched_colors.copy()
    assert np.ptp(coloured, axis=1).max() > 100
    stage.grey(True)
    for name in ("/linkage/cylinder", "/linkage/ball"):
        assert np.ptp(node(server, name).batched_colors, axis=1).max() == 0
    assert np.ptp(node(server, "/points").colors, axis=2).max() == 0
    stage.set(frame, (motion.input, motion.output))
    stage.pose(frame.pose(5))
    assert np.ptp(node(server, "/linkage/cylinder").batched_colors, axis=1).max() == 0
    stage.grey(False)
    assert np.array_equal(node(server, "/linkage/cylinder").batched_colors, coloured)
    assert np.ptp(node(server, "/points").colors, axis=2).max() > 50


@pytest.mark.parametrize("name", gallery.loops())
def test_the_camera_sees_every_place_of_the_motion_from_the_front(stage: Stage, name: str) -> None:
    _, frame = show(stage, name)
    eye, target = stage.look()
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, (0, 0, 1))
    right /= np.linalg.norm(right)
    seen = stage.in_scene(frame.places.reshape(-1, 3)) - eye
    deep = seen @ ahead
    assert (deep > 0.1).all()
    assert (np.abs(seen @ np.cross(right, ahead)) < math.tan(FIELD / 2) * deep).all()
    assert (np.abs(seen @ right) < 1.25 * math.tan(FIELD / 2) * deep).all()
    assert abs((np.abs(seen @ np.cross(right, ahead)) / deep).max() / math.tan(FIELD / 2)) > 0.25


@pytest.mark.parametrize("name", ["rssr", "seven_r"])
def test_the_span_is_that_of_the_places_that_are_known(name: str) -> None:
    _, frame = frame_of(name)
    places = frame.places.copy()
    places[5:9] = np.nan
    flat = places.reshape(-1, 3)
    assert replace(frame, places=places).span == (np.nanmax(flat, axis=0) - np.nanmin(flat, axis=0)).max()
