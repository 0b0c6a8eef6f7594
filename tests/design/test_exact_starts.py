"""Starts that theory gives a task: four-bars whose coupler takes its poses, within the bounds where there are any.

Source: the distances of pivots at the poses, by the displacements themselves.
"""

from dataclasses import replace

import numpy as np
import pytest

from places import EXAMPLES
from sevenbar.design.exact.starts import exact_starts
from sevenbar.design.task import FreeNumber, designed, read_task

TASK = EXAMPLES / "design" / "pick_place_task.toml"


def stretch(task, values):
    """By how much the lengths of crank and rocker differ from pose to pose, the greatest [length]."""
    at = dict(zip(task.names, values, strict=True))
    worst = 0.0
    for ground, body in (("crank", "A"), ("rocker", "B")):
        fixed, moving = (np.array([at[f"{joint}.x"], at[f"{joint}.y"]]) for joint in (ground, body))
        lengths = [
            np.linalg.norm(pose[:2, :2] @ moving + pose[:2, 3] - fixed)
            for pose in (np.eye(4), *task.wants[0].poses)
        ]
        worst = max(worst, np.ptp(lengths))
    return worst


def test_they_take_all_poses_within_the_bounds():
    task = read_task(TASK)
    found = exact_starts(task, 20)
    assert len(found) == 20
    for values in found:
        assert ((values >= task.low) & (values <= task.high)).all()
        assert stretch(task, values) < 1e-9


@pytest.mark.parametrize("count", [2, 3])
def test_the_drawn_pose_counts_among_them_if_it_is_not_one_of_them(count):
    task = read_task(TASK)
    want = task.wants[0]
    # two others and the drawn one are three, three others are four
    other = replace(task, wants=(replace(want, poses=want.poses[1 : 1 + count]),))
    found = exact_starts(other, 8)
    assert found
    inside = [v for v in found if ((v > other.low) & (v < other.high)).all()]
    assert inside
    assert max(stretch(other, values) for values in inside) < 1e-9


def test_a_search_that_begins_with_them_meets_the_poses_exactly():
    task = read_task(TASK)
    found = designed(task, count=1, starts=0, given=exact_starts(task, 16))
    assert found.designs[0].met[0].greatest < 1e-9


def test_bounds_without_any_get_the_nearest_ones_inside():
    task = read_task(TASK)
    narrow = tuple(
        FreeNumber(f.name, v - 1, v + 1) for f, v in zip(task.free, 4 * [-120.0, -60.0], strict=True)
    )
    for values in exact_starts(replace(task, free=narrow), 4):
        assert all(f.low <= v <= f.high for f, v in zip(narrow, values, strict=True))


def test_other_tasks_have_none():
    task = read_task(TASK)
    want = task.wants[0]
    assert exact_starts(replace(task, placement="free"), 4) == []
    assert exact_starts(replace(task, wants=(replace(want, link=1),)), 4) == []
    tilted = want.poses.copy()
    tilted[1, 2, 3] = 5.0
    assert exact_starts(replace(task, wants=(replace(want, poses=tilted),)), 4) == []
    steering = read_task(TASK.parent / "steering_task.toml")
    assert exact_starts(steering, 4) == []
