"""Joints that slide in a plane and turn in it (E): as P, P and R, as a plane pin, and as a swash plate.

Sources: the joint written as three joints of one freedom each, which the core knows since long; the plane turn of
a point about a pivot; the distance of a point from a plane that turns.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from compared_slopes import compare_all
from sevenbar.description.draft import Draft
from sevenbar.design.synthesis.path.generation import path_generation
from sevenbar.drawing.skeleton import poses
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.export import export
from sevenbar.export.layout import arrange
from sevenbar.export.parts import Rod, length_of
from sevenbar.export.pose import take
from sevenbar.reporting.report import markdown
from sevenbar.sweep import run

EXACT = 1e-11

#: Loops of seven freedoms with a joint E in any place: first, inside, last.
LOOPS = ("RURE", "RERC", "ERRRR", "RRERR")


def drawn(kinds: str, seed: int) -> list[dict[str, Any]]:
    """Joints anywhere, without anything parallel."""
    rng = np.random.default_rng(seed)
    joints: list[dict[str, Any]] = []
    for kind in kinds:
        joint: dict[str, Any] = {"kind": kind, "at": rng.normal(size=3), "name": f"j{len(joints)}"}
        if kind == "U":
            joint["axes"] = rng.normal(size=(2, 3))
        else:
            joint["axis"] = rng.normal(size=3)
        joints.append(joint)
    return joints


def in_parts(joints: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The same loop with each E as P, P and R: x of its plane goes towards the joint after, of the last before.

    The last one counts from the ground: its slides are the ground's, so that the turn comes first, and reversed, as
    the ground's place from the link.
    """
    found: list[dict[str, Any]] = []
    for i, joint in enumerate(joints):
        if joint["kind"] != "E":
            found.append(joint)
            continue
        z = joint["axis"] / np.linalg.norm(joint["axis"])
        towards = joints[i + 1 if i + 1 < len(joints) else i - 1]["at"] - joint["at"]
        x = towards - (towards @ z) * z
        x /= np.linalg.norm(x)
        parts = [("P", x), ("P", np.cross(z, x)), ("R", z)]
        if i == len(joints) - 1:
            # of the parts only the last one is at the ground
            (slide, along), *others = parts
            parts = [*((kind, -axis) for kind, axis in others[::-1]), (slide, along)]
        for number, (kind, axis) in enumerate(parts, start=1):
            found.append({"kind": kind, "at": joint["at"], "axis": axis, "name": f"{joint['name']}_{number}"})
    return found


@pytest.mark.parametrize("kinds", LOOPS)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_planar_joint_moves_as_two_slides_and_a_turn(kinds: str, seed: int) -> None:
    joints = drawn(kinds, seed)
    drive = {"joint": "j0" if kinds[0] == "R" else "j1", "output": "j3" if kinds[3] == "R" else "j1"}
    whole, parts = sb.from_axes(joints), sb.from_axes(in_parts(joints))
    assert whole.column_kinds == parts.column_kinds
    one, other = (linkage.motion(48, input=drive["joint"]) for linkage in (whole, parts))
    assert len(one.circuits) == len(other.circuits) > 0
    modes = [linkage.assembly_modes(0.02, input=drive["joint"]).q for linkage in (whole, parts)]
    np.testing.assert_allclose(modes[0], modes[1], atol=1e-8)
    for a, b in zip(one.circuits, other.circuits, strict=True):
        # of two dead centres at the same input either may come first
        first = np.abs(a.q - b.q[0]).max(axis=1).argmin() if a.closed else 0
        for quantity in ("q", "dq", "ddq"):
            mine, theirs = np.roll(getattr(a, quantity), -first, axis=0), getattr(b, quantity)
            scale = 1 + np.nanmax(np.abs(theirs))
            np.testing.assert_allclose(mine, theirs, atol=1e-7 * scale, equal_nan=True)


@pytest.mark.parametrize("kinds", LOOPS)
def test_a_point_behind_a_planar_joint_and_the_frames_of_the_core_and_of_the_steps_are_the_same(
    kinds: str,
) -> None:
    linkage = sb.from_axes(drawn(kinds, 3))
    motion = linkage.motion(24, input="j0" if kinds[0] == "R" else "j1")
    circuit = motion.circuits[0]
    rows = np.flatnonzero(circuit.status == "ok")
    frames = poses(linkage, circuit.q[rows])
    for link in range(len(linkage.links)):
        own = linkage.point_frames[link] @ np.array([0.3, -0.2, 0.7, 1.0])
        want = (frames[:, link] @ own)[:, :3]
        got = circuit.point(link + 1, (0.3, -0.2, 0.7)).position[rows]
        np.testing.assert_allclose(got, want, atol=1e-9 * circuit.size)


def test_a_pin_in_a_plane_goes_round_its_pivot() -> None:
    """A link that turns about a pivot, on the ground by a joint E: values in the closed form of a plane turn."""
    arm = np.array([3.0, 1.0, 0.0])
    linkage = sb.from_axes(
        [
            {"kind": "R", "name": "pivot", "at": (0, 0, 0), "axis": (0, 0, 1)},
            {"kind": "E", "name": "pin", "at": arm, "axis": (0, 0, 1)},
        ]
    )
    assert (linkage.mobility().finite, len(linkage.mobility().redundant)) == (1, 3)
    (circuit,) = linkage.motion(36).circuits
    assert linkage.columns == ("pivot", "pin.3", "pin.2", "pin.1")
    # x of the joint points to the pivot
    x = -arm / np.linalg.norm(arm)
    y = np.cross([0, 0, 1], x)
    for theta, row, rate in zip(circuit.input, circuit.q, circuit.dq, strict=True):
        c, s = math.cos(theta), math.sin(theta)
        place = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ arm - arm
        assert row[3:1:-1] == pytest.approx([place @ x, place @ y], abs=EXACT)
        assert (row[1] - theta + math.pi) % math.tau == pytest.approx(math.pi, abs=EXACT)
        turning = np.array([[-s, -c, 0], [c, -s, 0], [0, 0, 0]]) @ arm
        assert rate == pytest.approx([1, 1, turning @ y, turning @ x], abs=EXACT)
    # the slide may drive, too, up to where the pin turns back
    (rocks,) = linkage.motion(36, input="pin.1", output="pivot").circuits
    reach = float(np.linalg.norm(arm))
    assert rocks.input_range == pytest.approx((0, 2 * reach), abs=1e-9)
    assert len(linkage.assembly_modes(1.0, input="pin.1").q) == 2


@pytest.mark.parametrize("kinds", ["ERRRR", "RURE"])
def test_a_sweep_measures_loops_with_a_planar_joint_as_their_motion_does(kinds: str) -> None:
    linkage = sb.from_axes(drawn(kinds, 4))
    draft = Draft.of_linkage(linkage)
    values = [share * draft.dimension("j2.x").value for share in (0.9, 1.1)]
    table = run(linkage, {"j2.x": values}, ["motion_type", "circuits", "swing"]).table()
    for index, value in enumerate(values):
        motion = draft.with_values({"j2.x": value}).linkage.motion(90)
        own = [row for row in table.to_pylist() if row["linkage"] == index]
        assert [row["circuit"] for row in own] == [circuit.index for circuit in motion] != []
        slides = not motion.circuits[0].output_turns
        for row, circuit in zip(own, motion, strict=True):
            swing = circuit.swing if slides or circuit.swing is None else math.degrees(circuit.swing)
            key = next(name for name in row if name.startswith("swing"))
            assert row[key] == (None if swing is None else pytest.approx(swing, rel=1e-9))


def test_mobility_report_and_names_of_a_planar_joint() -> None:
    linkage = sb.load("swash_plate")
    assert linkage.columns[1:4] == ("slipper.1", "slipper.2", "slipper.3")
    assert linkage.column_kinds[1:4] == ("slide", "slide", "turn")
    assert linkage.drivable() == list(linkage.columns)
    assert "slipper.2" in markdown(linkage.motion(12, output="slipper.2"))


def test_a_row_cannot_hold_a_planar_joint_and_says_what_can() -> None:
    with pytest.raises(DescriptionError, match="takes more than one row; write P, P and R"):
        sb.from_dh("RRRE", length=[1] * 4, twist=[0] * 4, offset=[0] * 4)
    with pytest.raises(DescriptionError, match="did you mean 'E'"):
        sb.from_axes([{"kind": "planar", "at": (0, 0, 0), "axis": (0, 0, 1)}] * 2)
    with pytest.raises(DescriptionError, match="axis: is missing; a joint of kind E needs it"):
        sb.from_axes([{"kind": "E", "at": (0, 0, 0)}, {"kind": "R", "at": (1, 0, 0), "axis": (0, 0, 1)}])


def test_the_disc_of_a_planar_joint_holds_its_slipper_in_every_pose() -> None:
    motion = sb.load("swash_plate").motion(48)
    assembly = arrange(take(motion))
    (disc,) = (solid for solid in assembly.parts[0].add if isinstance(solid, Rod) and flat(solid))
    axis = (disc.end - disc.start) / length_of(disc)
    for row in motion.circuits[0].q:
        plate, slipper = poses(motion.linkage, row[None])[0, :2]
        # the slipper's own place, from the plate that carries the disc
        away = np.linalg.solve(plate, slipper[:, 3])[:3] - disc.end
        assert np.linalg.norm(away - (away @ axis) * axis) < disc.radius - 0.7 * assembly.unit
        assert abs(away @ axis) < 5 * assembly.unit


def flat(solid: Rod) -> bool:
    return solid.radius > 2 * length_of(solid)


def test_adams_measures_the_slides_of_a_planar_joint_and_says_that_it_cannot_drive_one(tmp_path: Any) -> None:
    linkage = sb.load("swash_plate")
    motion = linkage.motion(24, output="slipper.2")
    export(motion, None, tmp_path / "pump.cmd")
    text = (tmp_path / "pump.cmd").read_text()
    assert "constraint create joint planar" in text
    for function in ("DY(", "VY(", "ACCY("):
        assert function in text
    other = linkage.motion(24, input="slipper.2", output="piston")
    with pytest.raises(RequestError, match=r"ADAMS has no motion for .slipper\.2."):
        export(other, None, tmp_path / "other.cmd")


@pytest.mark.parametrize("kinds", ["RERC", "RURE"])
def test_all_derivatives_by_dimensions_of_a_loop_with_a_planar_joint_are_differences(kinds: str) -> None:
    _, compared = compare_all(sb.from_axes(drawn(kinds, 1)), every=3)
    assert compared > 130


@pytest.mark.parametrize("name", ["swash_plate", "as P, P and R"])
def test_a_path_is_found_with_a_planar_joint(name: str) -> None:
    drawing = Draft.of_linkage(sb.load("swash_plate"))
    if name != "swash_plate":
        joints = [dict(joint) | {"at": np.array(joint["at"], dtype=float)} for joint in drawing.raw["joint"]]
        for joint in joints:
            if "axis" in joint:
                joint["axis"] = np.array(joint["axis"], dtype=float)
        drawing = Draft.of_linkage(sb.from_axes(in_parts(joints)))
    knuckle, place = (len(drawing.linkage.joints) - 2, (50.0, 6.0, 20.0))
    there = drawing.with_values({"knuckle.x": 52.0, "knuckle.z": 14.0}).linkage
    wanted = there.motion(24).circuits[0].point(knuckle, place).position[::3]
    (best, *_) = path_generation(
        drawing, wanted, (knuckle, place), vary=["knuckle.x", "knuckle.z"], count=1, starts=8
    )
    assert best.error_greatest < 1e-6
    assert best.draft.dimension("knuckle.x").value == pytest.approx(52.0, abs=1e-4)
    assert best.draft.dimension("knuckle.z").value == pytest.approx(14.0, abs=1e-4)
    assert best.motion_type == "crank-slider"


@pytest.mark.parametrize("kinds", ["RESP", "RESR", "RSER"])
def test_a_ball_spins_beside_a_plate_wherever_in_it_its_turn_is_written(kinds: str) -> None:
    # the link between turns about the plate's normal through the ball
    last = {"P": ((60, 20, 30), (1, 0.3, 0.2)), "R": ((30, 50, 30), (1, 0.3, 0.2))}[kinds[3]]
    found = []
    for at in ((60, 20, 30), (30, 20, 30), (60, 0, 0), (60, 20, 10), (10, 5, 7)):
        places = {"R": ((0, 0, 0), (0, 0, 1)), "E": (at, (1, 0, 0)), "S": ((60, 20, 30),)}
        joints = []
        for k, kind in enumerate(kinds):
            place, *axis = last if k == 3 else places[kind]
            joints.append({"name": f"j{k}", "kind": kind, "at": place, **({"axis": axis[0]} if axis else {})})
        for order in (joints, joints[::-1]):
            motion = sb.from_axes(order).motion(36, input="j0", output="j3")
            (idle,) = motion.mobility.idle
            assert idle.startswith("spin of link 2 about the ")
            found.append((motion.motion_type, motion.circuits))
    assert len({kind for kind, _ in found}) == 1
    assert len({len(circuits) for _, circuits in found}) == 1
    if kinds == "RESP":
        # its slide runs to infinity, and is followed some way
        return
    ends = [np.sort([c.input_range + c.output_range for c in circuits], axis=0) for _, circuits in found]
    for one in ends:
        np.testing.assert_allclose(one, ends[0], atol=1e-9, rtol=1e-9)
