"""A pin in a slot of one of its two links (K, L): as P and R, from the other end, in engines, forces and exports.

Sources: the same loop with the joint written as a slide and a turn, which are joints of one freedom each; the closed
form of a quick-return lever; Exudyn.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from compared_slopes import compare_all
from run_differences import slides, turns
from sevenbar.errors import DescriptionError
from sevenbar.export import export
from sevenbar.export.layout import arrange
from sevenbar.export.pose import take
from sevenbar.simulation import simulate

#: Loops of seven freedoms with a slot in any place: first, inside, last, two of them.
LOOPS = ("KRURR", "LRURR", "RKUL", "RLUK", "RUKRR", "RULRR", "RURRK", "RURRL", "KRRRL")

#: The same quick-return lever: the pin on the crank before it, and after it.
CRANK, LEVER = (
    {"kind": "R", "name": name, "at": at, "axis": (0, 0, 1)}
    for name, at in (("crank", (0, 300, 0)), ("lever", (0, 0, 0)))
)
PIN, SLOT = (0, 0, 1), (100, 300, 0)
QUICK = {
    "slot after": [CRANK, {"kind": "L", "name": "pin", "at": SLOT, "axes": (PIN, SLOT)}, LEVER],
    "slot before": [LEVER, {"kind": "K", "name": "pin", "at": SLOT, "axes": (SLOT, PIN)}, CRANK],
}


def drawn(kinds: str, seed: int) -> list[dict[str, Any]]:
    """Joints anywhere, without anything parallel; a slot is square to its pin."""
    rng = np.random.default_rng(seed)
    joints: list[dict[str, Any]] = []
    for kind in kinds:
        joint: dict[str, Any] = {"kind": kind, "at": rng.normal(size=3), "name": f"j{len(joints)}"}
        if kind in "UKL":
            joint["axes"] = rng.normal(size=(2, 3))
        else:
            joint["axis"] = rng.normal(size=3)
        if kind in "KL":
            first, second = joint["axes"]
            joint["axes"][0] = np.cross(first, second)
        joints.append(joint)
    return joints


def in_parts(joints: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The same loop with each slot as P and R in their order; of the last one only the last part is at the ground."""
    result: list[dict[str, Any]] = []
    for i, joint in enumerate(joints):
        if joint["kind"] not in "KL":
            result.append(joint)
            continue
        for number, (kind, axis) in enumerate(
            zip("PR" if joint["kind"] == "K" else "RP", joint["axes"], strict=True), 1
        ):
            written = -1.0 if i == len(joints) - 1 and number == 1 else 1.0
            name = f"{joint['name']}_{number}"
            result.append({"kind": kind, "at": joint["at"], "axis": written * np.array(axis), "name": name})
    return result


@pytest.mark.parametrize("kinds", LOOPS)
def test_a_slot_moves_as_a_slide_and_a_turn(kinds: str) -> None:
    joints = drawn(kinds, 1)
    drive = joints[kinds.index("R")]["name"]
    whole, parts = sb.from_axes(joints), sb.from_axes(in_parts(joints))
    assert whole.column_kinds == parts.column_kinds
    one, other = (linkage.motion(48, input=drive) for linkage in (whole, parts))
    assert len(one.circuits) == len(other.circuits) > 0
    for a, b in zip(one.circuits, other.circuits, strict=True):
        # of two dead centres at the same input either may come first
        first = np.abs(a.q - b.q[0]).max(axis=1).argmin() if a.closed else 0
        for quantity in ("q", "dq", "ddq"):
            mine, theirs = np.roll(getattr(a, quantity), -first, axis=0), getattr(b, quantity)
            scale = 1 + np.nanmax(np.abs(theirs))
            np.testing.assert_allclose(mine, theirs, atol=1e-7 * scale, equal_nan=True)


@pytest.mark.parametrize("kinds", ["RUKRR", "LRURR", "RURRK"])
def test_all_derivatives_by_the_places_of_a_slot_are_differences(kinds: str) -> None:
    _, compared = compare_all(sb.from_axes(drawn(kinds, 1)), every=3)
    assert compared > 130


@pytest.mark.parametrize("way", QUICK)
def test_a_quick_return_lever_swings_as_its_triangle_says(way: str) -> None:
    linkage = sb.from_axes(QUICK[way])
    assert (linkage.mobility().finite, len(linkage.mobility().redundant)) == (1, 3)
    motion = linkage.motion(72, input="crank", output="lever")
    circuit = motion.circuits[0]
    assert motion.motion_type == "crank-rocker"
    swing = 2 * math.asin(1 / 3)
    assert circuit.swing == pytest.approx(swing, abs=1e-12)
    assert circuit.time_ratio == pytest.approx((math.pi + swing) / (math.pi - swing), abs=1e-12)
    slide = circuit.q[:, linkage.columns.index("pin.2" if way == "slot after" else "pin.1")]
    along = np.hypot(100 * np.cos(circuit.input), 300 + 100 * np.sin(circuit.input))
    # the pin moves in the lever's slot, or the slot over the pin
    np.testing.assert_allclose(np.abs(slide), np.abs(along - np.hypot(*SLOT[:2])), atol=1e-9)


@pytest.mark.parametrize("way", QUICK)
def test_torque_of_a_load_on_the_lever_is_that_of_virtual_work(way: str) -> None:
    joints = QUICK[way]
    lever = 2 if way == "slot after" else 1
    linkage = sb.from_axes(joints)
    circuit = linkage.motion(36, input="crank", output="lever").circuits[0]
    push = sb.Load(lever, torque=(0, 0, 2.0))
    torque = circuit.forces(loads=[push]).torque
    np.testing.assert_allclose(torque, -2.0 * circuit.dq[:, -1 if lever == 2 else 0], atol=1e-12)


#: A crank, a ball on it, and a slot between skew directions, inside and at the ground.
SPATIAL = {"K": ((1, 0.2, 0), (0, 0, 1)), "L": ((0, 0, 1), (1, 0.2, 0))}
BALL = {"kind": "S", "name": "ball", "at": (30, 0, 0)}


def spatial(kind: str, place: str) -> list[dict[str, Any]]:
    slot = {"kind": kind, "name": "slot", "at": (80, 30, 40), "axes": SPATIAL[kind]}
    hinge = {"kind": "R", "name": "hinge", "at": (100, 60, 0), "axis": (1, 1, 0.5)}
    crank = CRANK | {"at": (0, 0, 0)}
    return [crank, BALL, *((slot, hinge) if place == "inside" else (hinge, slot))]


@pytest.mark.parametrize("kind", "KL")
@pytest.mark.parametrize("place", ["inside", "last"])
@pytest.mark.parametrize("input", ["crank", "slot"])
def test_a_slot_moves_and_drives_in_exudyn_as_sevenbar_says(kind: str, place: str, input: str) -> None:
    pytest.importorskip("exudyn")
    column = {"crank": "crank", "slot": "slot.1" if kind == "K" else "slot.2"}[input]
    run = simulate(sb.from_axes(spatial(kind, place)), "exudyn", input=column, steps=400)
    assert max(turns(run), slides(run), run.tilt, run.gap / run.course.circuit.size) < 1e-9


@pytest.mark.parametrize("way", QUICK)
def test_exports_hold_the_pin_in_its_slot(way: str, tmp_path: Path) -> None:
    motion = sb.from_axes(QUICK[way]).motion(24, input="crank", output="lever")
    export(motion, None, tmp_path / "lever.cmd")
    text = (tmp_path / "lever.cmd").read_text()
    assert "constraint create joint planar" in text
    assert "constraint create primitive_joint inplane" in text
    assembly = arrange(take(motion))
    bar = [solid for part in assembly.parts for solid in part.add if type(solid).__name__ == "Bar"]
    assert len(bar) == 1
    # as long as the pin slides
    assert np.linalg.norm(bar[0].end - bar[0].start) > 200


def test_a_slot_that_is_not_across_its_pin_is_refused() -> None:
    for kind in "KL":
        wrong = {"kind": kind, "at": (1, 0, 0), "axes": ((1, 0, 0.5), (0, 0, 1))}
        with pytest.raises(DescriptionError, match=r"are 63\.4 deg apart; a slot is square to its pin"):
            sb.from_axes([CRANK, wrong, LEVER])


def test_a_word_for_a_slot_names_its_kind() -> None:
    joint = {"kind": "pin in slot", "at": (1, 0, 0), "axes": ((1, 0, 0), (0, 0, 1))}
    with pytest.raises(DescriptionError, match="did you mean 'K'"):
        sb.from_axes([CRANK, joint, LEVER])
