"""The solids of the studio stand on the linkage's own places, keep their sizes, and never turn over."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.arrays import Floats
from sevenbar.description import gallery
from sevenbar.drawing import skeleton
from sevenbar.drawing.skeleton import Skeleton
from sevenbar.drawing.style import INPUT, OUTPUT
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.studio.pictures.poses import stretched, turns
from sevenbar.studio.pictures.shapes import mesh
from sevenbar.studio.pictures.solids import SolidPlan, plan, poses, rgb


@cache
def planned(name: str, circuit: int = 0) -> tuple[Motion, Skeleton, SolidPlan]:
    motion = sb.load(name).motion()
    frame = skeleton.skeleton(motion, motion.circuits[circuit])
    return motion, frame, plan(frame, (motion.input, motion.output))


def rotated(turn: Floats, vector: tuple[float, float, float]) -> Floats:
    """The vector turned by quaternions wxyz (..., 4), by the sandwich product."""
    w, v = turn[..., :1], turn[..., 1:]
    at = np.broadcast_to(np.array(vector), v.shape)
    twice: Floats = 2 * np.cross(v, at)
    return at + w * twice + np.cross(v, twice)


def ends(found: tuple[Floats, Floats, Floats]) -> tuple[Floats, Floats]:
    turn, middle, scale = found
    half = rotated(turn, (0, 0, 1)) * scale[..., 2:] / 2
    return middle - half, middle + half


@pytest.mark.parametrize("name", gallery.loops())
def test_each_link_has_tubes_from_joint_to_joint_in_every_pose(name: str) -> None:
    _, frame, made = planned(name)
    start, end = ends(poses(made, frame.places)["cylinder"])
    for a, b in (pair for way in frame.polylines for pair in pairwise(way)):
        if np.linalg.norm(frame.places[:, a] - frame.places[:, b], axis=1).max() < 1e-9 * frame.span:
            continue
        off = np.maximum(
            np.linalg.norm(start - frame.places[:, a, None], axis=2),
            np.linalg.norm(end - frame.places[:, b, None], axis=2),
        )
        assert off.max(axis=0).min() < 1e-12 * max(frame.span, np.abs(frame.places).max())


@pytest.mark.parametrize("name", ["double_wishbone", "five_rod", "rssr_ss"])
def test_each_rod_has_a_tube_from_end_to_end_in_every_pose(name: str) -> None:
    motion, frame, made = planned(name)
    start, end = ends(poses(made, frame.places)["cylinder"])
    assert len(frame.rods) == len(motion.linkage.rods)
    for a, b in frame.rods:
        off = np.maximum(
            np.linalg.norm(start - frame.places[:, a, None], axis=2),
            np.linalg.norm(end - frame.places[:, b, None], axis=2),
        )
        assert off.max(axis=0).min() < 1e-12 * max(frame.span, np.abs(frame.places).max())


@pytest.mark.parametrize("name", gallery.loops())
def test_no_solid_of_a_rigid_link_changes_its_size_along_the_motion(name: str) -> None:
    motion, frame, made = planned(name)
    for _, _, scale in poses(made, frame.places).values():
        assert np.ptp(scale, axis=0).max() < 1e-7 * frame.span
        assert scale.max() < 2.5 * frame.span
    assert motion.circuits


@pytest.mark.parametrize("name", gallery.loops())
def test_orientations_are_unit_quaternions_and_blocks_and_nuts_turn_little_from_row_to_row(name: str) -> None:
    _, frame, made = planned(name)
    for shape, (turn, middle, scale) in poses(made, frame.places).items():
        assert np.abs(np.linalg.norm(turn, axis=-1) - 1).max() < 1e-12
        assert np.isfinite(middle).all()
        assert (scale > 0).all() or shape == "cylinder"
        if shape in ("box", "hexagon", "thread"):
            # q and -q are one orientation
            close = np.abs(np.sum(turn[1:] * turn[:-1], axis=-1))
            assert 2 * np.arccos(np.clip(close, -1, 1)).max() < 0.25


def test_turns_lead_z_onto_the_way_and_x_towards_the_roll_straight_down_too() -> None:
    rng = np.random.default_rng(5)
    along = rng.normal(size=(400, 3))
    along[:6] = [(0, 0, -1), (0, 0, 1), (1e-9, 0, -1), (-1e-160, 1e-160, -1), (0, 1e-5, -1), (1e-8, 1e-8, -1)]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    roll = rng.normal(size=(400, 3))
    roll[200:] = 0.0
    turn = turns(along, roll)
    assert np.abs(np.linalg.norm(turn, axis=1) - 1).max() < 1e-15 * 8
    assert np.abs(rotated(turn, (0, 0, 1)) - along).max() < 1e-14
    across = roll - np.sum(roll * along, axis=1, keepdims=True) * along
    assert np.abs(np.cross(rotated(turn, (1, 0, 0)), across)[:200]).max() < 1e-13
    assert (np.sum(rotated(turn, (1, 0, 0)) * across, axis=1)[:200] > 0).all()


@pytest.mark.parametrize("name", gallery.loops())
def test_a_pose_that_is_not_known_hides_what_stands_on_it_and_raises_nothing(name: str) -> None:
    _, frame, made = planned(name)
    lost = np.full_like(frame.places[0], np.nan)
    for turn, middle, scale in poses(made, lost).values():
        assert np.isfinite(turn).all()
        assert np.isfinite(middle).all()
        assert np.isfinite(scale).all()
    assert all((scale == 0).all() for _, _, scale in poses(made.moving(), lost).values())


def test_the_ground_stays_where_only_the_moving_places_are_unknown() -> None:
    _, frame, made = planned("rssr")
    lost = frame.places[0].copy()
    # both feet of the two balls
    lost[[*frame.polylines[1], frame.polylines[0][-1], frame.polylines[2][0]]] = np.nan
    *_, scale = poses(made, lost)["cylinder"]
    grounded = ~made.solids["moves"][made.shapes["cylinder"]]
    assert (scale[grounded] > 0).all()
    assert (scale[:3] == 0).all(axis=1).sum() == 3 - grounded[:3].sum()


def test_many_poses_at_once_are_those_of_each() -> None:
    _, frame, made = planned("seven_r")
    together = poses(made, frame.places[:5])
    for row in range(5):
        for shape, found in poses(made, frame.places[row]).items():
            for one, many in zip(found, together[shape], strict=True):
                assert np.array_equal(one, many[row])


@pytest.mark.parametrize(("name", "slider"), [("rssp", "box"), ("rccc", "box"), ("screw_drill", "hexagon")])
def test_what_slides_stays_on_its_rail_between_the_ends(name: str, slider: str) -> None:
    motion, frame, made = planned(name)
    found = poses(made, frame.places)
    _, blocks, _ = found[slider]
    rods = [ends(found[shape]) for shape in ("cylinder", "thread") if shape in found]
    start, end = np.concatenate([a for a, _ in rods], 1), np.concatenate([b for _, b in rods], 1)
    last = len(motion.linkage.joints) - 1
    for i, joint in enumerate(motion.linkage.joints):
        if joint.kind not in "PH":
            continue
        foot = frame.polylines[i - 1][-1] if i == last else frame.polylines[i][0]
        assert np.abs(blocks - frame.places[:, foot, None]).max(axis=(0, 2)).min() < 1e-12 * frame.span
        way = end - start
        length = np.linalg.norm(way, axis=2, keepdims=True)
        way = way / np.where(length > 0, length, 1)
        arm = frame.places[:, foot, None] - start
        along = np.sum(arm * way, axis=2, keepdims=True)
        on = (np.linalg.norm(arm - along * way, axis=2) < 1e-9 * frame.span) & (along[..., 0] > 0)
        on &= along[..., 0] < length[..., 0]
        # a threaded rod is of several pieces
        assert on.any(axis=1).all()


def test_the_nut_turns_once_on_its_thread_for_each_pitch_it_moves() -> None:
    motion, frame, made = planned("screw_drill")
    index = next(i for i, joint in enumerate(motion.linkage.joints) if joint.kind == "H")
    found = poses(made, frame.places)
    thread, nut = found["thread"][0][:, 0], found["hexagon"][0][:, 0]
    z, x, y = (rotated(thread, v) for v in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    seen = rotated(nut, (1, 0, 0))
    turned = np.unwrap(np.arctan2(np.sum(seen * y, axis=1), np.sum(seen * x, axis=1)))
    slid = np.sum(
        (frame.places[:, frame.polylines[index][0]] - frame.places[:, frame.polylines[index - 1][-1]]) * z,
        axis=1,
    )
    assert np.ptp(slid) > 0.05 * frame.span
    pitch = motion.linkage.joints[index].pitch
    assert np.abs((turned - turned[0]) - math.tau * (slid - slid[0]) / pitch).max() < 1e-6


def test_a_screw_shows_its_hand_and_each_kind_its_shape() -> None:
    _, _, made = planned("screw_drill")
    assert {"thread", "hexagon"} <= set(made.shapes)
    motion, frame, _ = planned("screw_drill")
    joints = tuple(replace(joint, pitch=-joint.pitch) for joint in motion.linkage.joints)
    left = plan(replace(frame, linkage=replace(motion.linkage, joints=joints)), (motion.input, motion.output))
    assert "left thread" in left.shapes
    assert "thread" not in left.shapes
    for name, shape, count in (("rssr", "socket", 2), ("rssp", "socket", 2), ("five_bar", "socket", 1)):
        rows = planned(name)[2].shapes[shape]
        assert rows.stop - rows.start == count


def test_input_is_blue_and_output_orange_whichever_joints_they_are() -> None:
    for name in ("rssr", "rssp", "six_bar", "seven_r"):
        motion, frame, made = planned(name)
        back = plan(frame, (motion.output, motion.input))
        for colour, other in ((INPUT, OUTPUT), (OUTPUT, INPUT)):
            here = (made.solids["colour"] == rgb(colour)).all(axis=1)
            assert here.any()
            assert np.array_equal(here, (back.solids["colour"] == rgb(other)).all(axis=1))


def test_thicknesses_follow_the_unit_and_a_linkage_of_any_size_looks_alike() -> None:
    motion, frame, made = planned("rssr")
    small = replace(frame, places=frame.places * 1e-6)
    tiny = plan(small, (motion.input, motion.output))
    for (turn, middle, scale), (turn_2, middle_2, scale_2) in zip(
        poses(made, frame.places[7]).values(), poses(tiny, small.places[7]).values(), strict=True
    ):
        assert np.allclose(turn, turn_2, atol=1e-12)
        assert np.allclose(middle, middle_2 * 1e6, atol=1e-9 * frame.span)
        assert np.allclose(scale, scale_2 * 1e6, atol=1e-9 * frame.span)


def test_a_plan_from_one_circuit_serves_the_poses_of_the_others() -> None:
    motion, first, made = planned("seven_r")
    for circuit in motion.circuits[1:3]:
        other = skeleton.skeleton(motion, circuit)
        start, end = ends(poses(made, other.places[3])["cylinder"])
        for a, b in (pair for way in first.polylines for pair in pairwise(way)):
            off = np.linalg.norm(start - other.places[3, a], axis=1)
            off += np.linalg.norm(end - other.places[3, b], axis=1)
            assert off.min() < 1e-11 * first.span


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        ("cylinder", math.pi),
        ("ball", 4 / 3 * math.pi),
        ("cone", math.pi / 3),
        ("box", 1.0),
        ("hexagon", 1.5 * math.sqrt(3)),
    ],
)
def test_unit_shapes_have_their_volume_and_face_outwards(shape: str, volume: float) -> None:
    corners, faces = mesh(shape)
    a, b, c = (corners[faces[:, i]] for i in range(3))
    assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(volume, rel=0.02)


@pytest.mark.parametrize(
    "shape", ["cylinder", "ball", "cone", "box", "hexagon", "socket", "thread", "left thread"]
)
def test_unit_shapes_are_closed(shape: str) -> None:
    corners, faces = mesh(shape)
    _, merged = np.unique(np.round(corners, 9), axis=0, return_inverse=True)
    kept = merged.reshape(-1)[faces]
    kept = kept[(kept != np.roll(kept, 1, axis=1)).all(axis=1)]
    edges = {(int(a), int(b)) for face in kept for a, b in zip(face, np.roll(face, -1), strict=True)}
    assert len(edges) == kept.size
    assert all((b, a) in edges for a, b in edges)


@pytest.mark.parametrize(("shape", "hand"), [("thread", 1), ("left thread", -1)])
def test_the_crest_of_a_thread_climbs_to_its_hand(shape: str, hand: int) -> None:
    corners, _ = mesh(shape)
    radius = np.hypot(corners[:, 0], corners[:, 1])
    inside = (np.abs(corners[:, 2]) < 0.45) & (radius > 0.1)
    angle, height = np.arctan2(corners[inside, 1], corners[inside, 0]), corners[inside, 2]
    turns_ = 6
    # the first harmonic of the radius along the screw is strong in one hand only
    right, left = (
        abs(np.sum((radius[inside] - 1) * np.exp(1j * (math.tau * turns_ * height - way * angle))))
        for way in (1, -1)
    )
    assert (right > 20 * left) if hand > 0 else (left > 20 * right)


def test_bars_between_places_reach_from_start_to_end_and_none_where_there_is_no_way() -> None:
    start = np.array([(0.0, 0, 0), (1, 2, 3), (1, 1, 1), (np.nan, 0, 0)])
    end = np.array([(0.0, 0, -2), (4, 5, -1), (1, 1, 1), (0, 0, 1)])
    found = stretched(start, end, 0.1)
    assert np.abs(np.stack(ends(found))[:, :2] - np.stack([start, end])[:, :2]).max() < 1e-14
    assert (found[2][2:] == 0).all()
    assert np.isfinite(np.concatenate(found, axis=1)).all()
