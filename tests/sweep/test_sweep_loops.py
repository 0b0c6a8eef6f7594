"""General loops of a sweep, measured by the core all at once, are what the ordinary analysis has of each."""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.kinematics.measures import MEASURES
from sevenbar.sweep.axes import span
from sevenbar.sweep.batches import batched
from sevenbar.sweep.block import Block
from sevenbar.sweep.ordinary import analysed
from sevenbar.sweep.plan import SweepPlan

LINKAGES = ("seven_r", "rccc", "rscr", "rssp", "planar_4r", "six_bar", "five_bar")


#: Loops whose transmission angle is measured one by one.
WITH_ANGLES = ("planar_4r", "rssp")


def plan_of(name: str, count: int) -> SweepPlan:
    linkage = sb.load(name)
    dimensions = [d for d in Draft.of_linkage(linkage).dimensions if d.kind == "length" and d.value]
    ends = sorted((0.9 * dimensions[-1].value, 1.1 * dimensions[-1].value))
    measures = [measure for measure in MEASURES if name not in WITH_ANGLES or "transmission" not in measure]
    return SweepPlan.of(linkage, {dimensions[-1].name: span(*ends)}, measures, count=count, seed=1)


@pytest.mark.parametrize("name", LINKAGES)
def test_loops_measured_at_once_are_as_each_by_itself(name: str) -> None:
    plan = plan_of(name, 6)
    values = plan.space.values(0, 6)
    blocks, rest = batched(plan, values, 2)
    assert not len(rest)
    at_once = Block.joined(blocks)
    alone = analysed(plan, values, 0, np.arange(6))
    assert at_once.linkage.tolist() == alone.linkage.tolist()
    assert at_once.circuit.tolist() == alone.circuit.tolist()
    for measure, column in alone.columns.items():
        if column.dtype == object:
            assert at_once.columns[measure].tolist() == column.tolist(), measure
        else:
            np.testing.assert_allclose(
                at_once.columns[measure], column, rtol=1e-9, atol=1e-9, err_msg=measure
            )


@pytest.mark.parametrize("name", WITH_ANGLES)
def test_transmission_angles_of_loops_are_those_of_their_motion(name: str) -> None:
    linkage = sb.load(name)
    own = next(d for d in Draft.of_linkage(linkage).dimensions if d.kind == "length" and d.value)
    plan = SweepPlan.of(linkage, {own.name: [own.value]}, ["transmission_lowest", "transmission_highest"])
    values = plan.space.values(0, 1)
    blocks, rest = batched(plan, values, 1)
    assert rest.tolist() == [0]
    assert not blocks or not len(blocks[0].linkage)
    alone = analysed(plan, values, 0, rest)
    circuit = linkage.motion().circuits[0]
    assert np.radians(alone.columns["transmission_lowest"][0]) == pytest.approx(circuit.transmission.lowest)
    assert np.radians(alone.columns["transmission_highest"][0]) == pytest.approx(circuit.transmission.highest)


def test_threads_and_neighbours_change_no_bit() -> None:
    plan = plan_of("seven_r", 5)
    values = plan.space.values(0, 5)
    (whole,), _ = batched(plan, values, 1)
    (threaded,), _ = batched(plan, values, 2)
    (last,), _ = batched(plan, values[:, 4:], 1)
    for measure, column in whole.columns.items():
        if column.dtype != object:
            assert column.tobytes() == threaded.columns[measure].tobytes()
            assert column[whole.linkage == 4].tobytes() == last.columns[measure].tobytes()


def test_loops_that_do_not_move_are_left_to_tell_why() -> None:
    # a Bennett whose first length alone is changed cannot be assembled
    linkage = sb.load("bennett")
    plan = SweepPlan.of(linkage, {"length_1": [0.9 * linkage.dimensions["length_1"]]}, ["motion_type"])
    blocks, rest = batched(plan, plan.space.values(0, 1), 1)
    assert rest.tolist() == [0]
    assert sum(len(block.linkage) for block in blocks) == 0
