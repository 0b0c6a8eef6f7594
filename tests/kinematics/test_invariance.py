"""What a motion comes to does not hang on how the linkage was written down.

Source: geometry alone. The same bodies drawn in another frame, another unit, as their mirror image, from the other end
of the loop or from another joint on move alike; joint values are turns and slides of one body against the next one, so
they stay, but for a slide's sign in a mirror and its size in another unit. The last joint counts its link against the
ground, so that its axes are reversed where it becomes one between links. What a ball's turns are named is left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import sevenbar as sb
from drawn_anew import Joints, changed, joints_of
from evidence.fuzz.random_linkages import random_rotation
from evidence.fuzz.random_loops import (
    bennett,
    drawn,
    general,
)
from sevenbar.kinematics.solvers.general import GeneralLoop
from strategies import linkages, wrapped

#: Differences of angles and of places in parts of the size, and of rates in parts of their spread.
SAME, SAME_RATE = 1e-7, 1e-5

#: Nearer dead centres [rad] than this make limits that rounding moves.
FIRM = 1e-3

#: Condition of a dead centre or row past which the digits that are compared are lost.
BADLY = 1e4


loops = st.integers(0, 10**6).map(joints_of)
rotations = st.integers(0, 10**6).map(lambda seed: np.random.default_rng(seed))
few = settings(
    deadline=None, max_examples=22, derandomize=True, suppress_health_check=[HealthCheck.filter_too_much]
)


@dataclass(frozen=True)
class Ends:
    """The columns of input and output by name, and what a slide counts there: its size and its sign."""

    input: str
    output: str
    slide: float = 1.0


def ends_of(linkage: sb.Linkage) -> Ends:
    return Ends(linkage.drive.joint, linkage.drive.output)


def told(linkage: sb.Linkage, ends: Ends) -> tuple[str, list[np.ndarray], list[np.ndarray], np.ndarray]:
    """The motion type; of each circuit its numbers and its rates; the limits. Slides are in parts of the first linkage's."""
    kinds = dict(zip(linkage.columns, linkage.column_kinds, strict=True))
    try:
        motion = linkage.motion(24, input=ends.input, output=ends.output, speed=1.0, method="general")
    except sb.errors.SevenbarError as error:
        return f"refused: {type(error).__name__}", [], [], np.array([])
    slide = [ends.slide if kinds[name] == "slide" else 1.0 for name in (ends.input, ends.output)]
    numbers, rates = [], []
    for circuit in motion:
        row = [float(circuit.turns), float(circuit.closed), float(len(circuit.dead_centres))]
        for name, unit in zip(("input", "output"), slide, strict=True):
            if not circuit.closed:
                # a slide runs away; where following it ends is no place of the linkage
                continue
            row += ends_told(
                getattr(circuit, f"{name}_range"), unit, turns=kinds[getattr(ends, name)] == "turn"
            )
        numbers.append(np.array([*row, *[0.0] * (13 - len(row))]))
        # a negative unit exchanges lowest and highest
        found = [getattr(circuit, rate) for rate in ("velocity", "acceleration", "jerk")]
        per = [slide[1] / slide[0] ** order for order in (1, 2, 3)]
        rates.append(
            np.array(
                [
                    [np.nan, np.nan] if one is None else np.sort([one.lowest * unit, one.highest * unit])
                    for one, unit in zip(found, per, strict=True)
                ]
            ).ravel()
        )
    limits = motion.limits * slide[0]
    return motion.motion_type, numbers, rates, np.sort(limits)


def badly(linkage: sb.Linkage, ends: Ends) -> float:
    """The worst condition of a row in its circuits, dead centres aside."""
    try:
        motion = linkage.motion(24, input=ends.input, output=ends.output, method="general")
    except sb.errors.SevenbarError:
        return 0.0
    return max((float(c.condition[c.status == "ok"].max(initial=0.0)) for c in motion), default=0.0)


def begun_at(joints: Joints, start: int) -> Joints:
    """The loop from another joint on, but none that makes the link between two balls the ground."""
    count = len(joints)
    starts = [k % count for k in range(start, start + count)]
    fitting = [k for k in starts if k and {joints[k]["kind"], joints[k - 1]["kind"]} != {"S"}]
    begun = [*joints[:-1], reversed_axes(joints[-1])]
    begun = begun[fitting[0] :] + begun[: fitting[0]]
    return [*begun[:-1], reversed_axes(begun[-1])]


def reversed_axes(joint: dict[str, Any]) -> dict[str, Any]:
    """A joint that counts the other of its two links."""
    return changed([joint], lambda p: p, lambda _, a: -a)[0]


def ends_told(ends: tuple[float, float] | None, unit: float, *, turns: bool) -> list[float]:
    """A range: of an angle by its ends on the circle and its width."""
    if ends is None:
        return [9.0] * 5
    low, high = np.sort([ends[0] * unit, ends[1] * unit])
    if not turns:
        return [low, high, high - low, 0.0, 0.0]
    return [np.cos(low), np.sin(low), np.cos(high), np.sin(high), high - low]


def alike(first: sb.Linkage, second: sb.Linkage, ends: Ends, other: Ends) -> None:
    """Both motions come to the same, circuits in any order."""
    kind, numbers, rates, limits = told(first, ends)
    kind2, numbers2, rates2, limits2 = told(second, other)
    # beside a change point rounding decides
    assume(kind != "change-point")
    assume(badly(first, ends) < BADLY)
    if len(limits) > 1:
        assume(np.diff(limits).min() > FIRM)
    assert kind2 == kind
    assert len(numbers2) == len(numbers)
    assert limits2.shape == limits.shape
    scale = 1.0 + np.abs(limits).max(initial=0.0)
    if limits.size:
        assert (
            np.abs(wrapped(limits2 - limits)).max() < SAME * scale
            or np.abs(limits2 - limits).max() < SAME * scale
        )
    left = list(range(len(numbers2)))
    for row, rate in zip(numbers, rates, strict=True):
        apart = [np.abs(numbers2[k] - row).max() + differ(rates2[k], rate) for k in left]
        best = int(np.argmin(apart))
        assert np.abs(numbers2[left[best]] - row).max() < SAME * (1 + np.abs(row).max())
        assert differ(rates2[left[best]], rate) < SAME_RATE
        left.pop(best)


def differ(one: np.ndarray, other: np.ndarray) -> float:
    """The greatest difference of two rows of rates in parts of their size; infinite where only one has a bound."""
    if (np.isnan(one) != np.isnan(other)).any():
        return np.inf
    return float(np.nan_to_num(np.abs(one - other) / (1e-3 + np.abs(one) + np.abs(other))).max(initial=0.0))


@few
@given(loops, rotations)
def test_a_rigid_change_of_frame_changes_no_motion_and_carries_its_traces(
    joints: Joints, rng: np.random.Generator
) -> None:
    rotation, shift = random_rotation(rng), rng.normal(size=3)
    moved = changed(joints, lambda p: rotation @ p + shift, lambda _, a: rotation @ a)
    first, second = sb.from_axes(joints), sb.from_axes(moved)
    alike(first, second, ends_of(first), ends_of(second))
    # the drawn pose closes: through it one circuit and its points can be compared row by row
    pose = np.zeros(len(first.columns))
    try:
        one, other = first.circuit(pose, 24), second.circuit(pose, 24)
    except sb.errors.SevenbarError:
        return
    assume(
        one.motion_type != "change-point" and np.isfinite(one.condition).all() and one.condition.max() < 1e6
    )
    assert len(one.q) == len(other.q)
    at = rng.normal(size=3)
    idle = first.idle_links
    for link in (1, len(joints) - 1):
        if link in idle:
            continue
        a, b = one.point(link, tuple(at)), other.point(link, tuple(rotation @ at + shift))
        same = (a.status == "ok") & (b.status == "ok")
        np.testing.assert_allclose(
            b.position[same], a.position[same] @ rotation.T + shift, rtol=0, atol=1e-7 * one.size
        )
        scale = 1 + np.abs(a.velocity[same]).max(initial=0.0)
        np.testing.assert_allclose(b.velocity[same], a.velocity[same] @ rotation.T, rtol=0, atol=1e-6 * scale)


@few
@given(loops, st.sampled_from([1e-9, 1e-3, 25.4, 1e6]))
def test_another_unit_of_length_changes_no_angle_and_slides_by_its_size(joints: Joints, size: float) -> None:
    scaled = changed(joints, lambda p: size * p, lambda _, a: a)
    for joint in scaled:
        joint |= {"pitch": size * joint["pitch"]} if "pitch" in joint else {}
    first, second = sb.from_axes(joints), sb.from_axes(scaled)
    ends = ends_of(first)
    alike(first, second, ends, Ends(ends.input, ends.output, 1 / size))


@few
@given(loops)
def test_the_mirror_image_moves_alike_with_its_slides_turned_round(joints: Joints) -> None:
    mirror = np.diag([1.0, -1.0, 1.0])
    # a turn's axis is turned round by a mirror, so that the turn keeps its sign; C keeps its axis for both
    image = changed(
        joints, lambda p: mirror @ p, lambda freedom, a: mirror @ a * (1 if freedom == "slide" else -1)
    )
    first, second = sb.from_axes(joints), sb.from_axes(image)
    ends = ends_of(first)
    kinds = {name: joint.kind for joint in first.joints for name in joint.columns}
    # slides of C have both signs at once where the other end is a P
    assume(
        {kinds[ends.input], kinds[ends.output]} & {"C"} == set()
        or "P" not in kinds[ends.input] + kinds[ends.output]
    )
    alike(first, second, ends, ends)


@few
@given(loops)
def test_the_loop_written_from_its_other_end_moves_alike(joints: Joints) -> None:
    # an inner joint now carries the other body, so its axis is turned round and its turn is the same
    first, *inner, last = joints[::-1]
    back = changed([first, *map(reversed_axes, inner), last], lambda p: p, lambda _, a: a)
    for joint in back:
        joint |= {"axes": joint["axes"][::-1]} if "axes" in joint else {}
    one, second = sb.from_axes(joints), sb.from_axes(back)
    ends = ends_of(one)
    other = {name: reversed_column(one, name) for name in (ends.input, ends.output)}
    alike(one, second, ends, Ends(other[ends.input], other[ends.output]))


def reversed_column(linkage: sb.Linkage, name: str) -> str:
    """The column of the same freedom where the loop is written from its other end: a U's two change places."""
    joint = next(joint for joint in linkage.joints if name in joint.columns)
    return joint.columns[1 - joint.columns.index(name)] if joint.kind == "U" else name


@few
@given(loops, st.integers(1, 11))
def test_the_loop_begun_at_another_joint_moves_alike(joints: Joints, start: int) -> None:
    first, second = sb.from_axes(joints), sb.from_axes(begun_at(joints, start))
    ends = ends_of(first)
    alike(first, second, ends, ends)


@settings(few, max_examples=12)
@given(st.integers(0, 10**6), st.integers(1, 6))
def test_rows_begun_at_another_joint_move_alike(seed: int, start: int) -> None:
    rng = np.random.default_rng([32, seed])
    case = (bennett if seed % 3 == 0 else general)(rng)
    start %= len(case.kinds)
    names = [f"j{i}" for i in range(len(case.kinds))]
    first = case.linkage(names=names)
    second = case.begun_at(start).linkage(names=names[start:] + names[:start])
    alike(first, second, ends_of(first), ends_of(first))


@settings(few, max_examples=8)
@given(st.integers(0, 10**6))
def test_the_unit_of_angles_in_a_file_changes_nothing(seed: int) -> None:
    case = general(np.random.default_rng([33, seed]))
    texts = []
    for unit, factor in (("rad", 1.0), ("deg", 180 / np.pi)):
        rows = "".join(
            f"[[link]]\nlength = {a!r}\ntwist = {t * factor!r}\noffset = {d!r}\n"
            for a, t, d in zip(*(x.tolist() for x in (case.length, case.twist, case.offset)), strict=True)
        )
        texts.append(f'format = 1\nangle_unit = "{unit}"\n{rows}')
    first, second = map(sb.loads, texts)
    np.testing.assert_allclose(
        second.transforms, first.transforms, rtol=0, atol=1e-14 * GeneralLoop(first).size
    )
    alike(first, second, ends_of(first), ends_of(first))


@settings(few, max_examples=8)
@given(loops, st.floats(-3.0, 3.0), rotations)
def test_as_many_modes_in_any_frame_and_from_any_joint(
    joints: Joints, theta: float, rng: np.random.Generator
) -> None:
    first = sb.from_axes(joints)
    driver = first.drive.joint
    rotation = random_rotation(rng)
    others: Sequence[Joints] = (
        changed(joints, lambda p: rotation @ p, lambda _, a: rotation @ a),
        begun_at(joints, int(rng.integers(len(joints)))),
    )
    try:
        modes = first.assembly_modes(theta, input=driver)
    except sb.errors.SevenbarError:
        assume(False)
    for other in others:
        assert len(sb.from_axes(other).assembly_modes(theta, input=driver)) == len(modes)


@settings(few, max_examples=30)
@given(linkages)
def test_the_closed_form_of_an_rssr_and_the_general_way_from_any_joint_tell_the_same(
    case: Any,
) -> None:
    linkage = case.linkage()
    motion = linkage.motion(24, speed=1.0)
    assume(motion.motion_type != "change-point")
    if motion.limits.size > 1:
        assume(np.diff(motion.limits).min() > FIRM)
    general_way = linkage.motion(24, speed=1.0, method="general")
    assert general_way.motion_type == motion.motion_type
    np.testing.assert_allclose(general_way.limits, motion.limits, rtol=0, atol=SAME)
    assert len(general_way.circuits) == len(motion.circuits)


@settings(few, max_examples=2)
@given(st.sampled_from(["RCCC", "RSSP"]))
def test_the_comparison_tells_different_linkages_apart(kinds: str) -> None:
    first = sb.from_axes([dict(j) for j in drawn(np.random.default_rng(1), kinds).joints])
    second = sb.from_axes([dict(j) for j in drawn(np.random.default_rng(2), kinds).joints])
    with pytest.raises(AssertionError):
        alike(first, second, ends_of(first), ends_of(second))
