"""Loops of screws: what `mobility` says of them, each input's motion says too; source: the subgroups that their screws span."""

import math

import numpy as np
import pytest

import sevenbar as sb
from evidence.certainty.screw_loops import FAMILIES, moves, screw, slide
from sevenbar.kinematics.solvers.batches import loop_motions
from sevenbar.reporting import report
from sevenbar.reporting.how_found import how_found


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.__name__)
@pytest.mark.parametrize("places", [1, 9])
def test_every_input_says_of_a_screw_loop_what_mobility_says(family, places):
    random = np.random.default_rng(places)
    for _ in range(6):
        linkage = sb.from_axes(family(random, places))
        assert linkage.mobility().finite == FAMILIES[family]
        told = [moves(linkage, column) for column in linkage.drivable()]
        assert told == [bool(FAMILIES[family])] * len(told)


THREE = [screw([0, 0, 0]), screw([0.3, 0.5, 0]), screw([2, 0.2, 0]), slide([2, 0.2, 0], [1, 0, 0])]


def test_a_screw_that_turns_on_without_end_is_a_spindle_and_no_rocker():
    linkage = sb.from_axes(THREE)
    types = [linkage.motion(24, input=name).motion_type for name in linkage.drivable()]
    # crank and coupler gain a turn each round, against each other; the third screw swings
    assert types == ["spindle-slider", "spindle-slider", "rocker-slider", "slider-rocker"]
    circuit = linkage.motion(24, output="theta_2").circuits[0]
    assert (circuit.motion_type, circuit.closed) == ("double-spindle", False)
    assert circuit.input_range[1] - circuit.input_range[0] > 10 * math.tau
    batch = loop_motions([linkage], 0, 1, 24, 1)
    assert set(batch.circuit_types) == {"double-spindle"}


def test_the_motion_is_that_of_the_slider_crank_of_turns():
    turns = [dict(joint, kind="R") for joint in THREE[:3]]
    plain = sb.from_axes([{k: v for k, v in j.items() if k != "pitch"} for j in turns] + THREE[3:])
    known = np.concatenate([c.q for c in plain.motion(24)])
    for circuit in sb.from_axes(THREE).motion(24):
        for q in circuit.q[circuit.status == "ok"]:
            apart = known - q
            apart[:, :3] = (apart[:, :3] + math.pi) % math.tau - math.pi
            assert np.abs(apart).max(axis=1).min() < 1e-9


def test_the_report_says_without_end():
    told = report.markdown(sb.from_axes(THREE).motion(24))
    assert "without end" in told


def test_screws_are_seeds_where_nothing_turns():
    """Rows do not close at zero, so no drawn pose leads to the circuits."""
    rows = {"length": [1.0, 2.6, 2.4, 2.0], "twist": [0.0] * 4, "offset": [0.0] * 4, "pitch": [0.3] * 4}
    linkage = sb.from_dh("HHHH", **rows)
    assert linkage.mobility().finite == 1
    motion = linkage.motion(24)
    assert motion.circuits
    assert "screws within one turn" in how_found(motion)


def test_screws_on_the_corners_of_a_kite_are_told_to_move():
    """Each fold leads on to others, some turns of a screw on, out to where screws are no longer followed."""
    kite = sb.from_axes([screw([x, y, 0]) for x, y in ((0, 0), (1, 1.5), (2.7, 0), (1, -1.5))])
    assert kite.mobility().finite == 1
