"""How far the joints of a net move, beside single loops, the rows between, and loops found another way."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.kinematics.ranges.net_extents import net_joint_ranges


def agree(one, other, *, turns, size):
    """Two ranges are one, angles to whole turns."""
    assert (one.low is None) == (other.low is None)
    if one.low is None:
        return
    assert one.extent == pytest.approx(other.extent, abs=1e-8 * (1 if turns else size))
    for mine, theirs in ((one.low, other.low), (one.high, other.high)):
        off = mine.value - theirs.value
        off -= math.tau * round(off / math.tau) if turns else 0.0
        assert abs(off) < 1e-8 * (1 if turns else size)


def test_the_first_four_bar_of_watts_six_bar_has_the_ranges_that_it_has_alone() -> None:
    net = sb.load("watt")
    single = sb.from_pins(net.description["pin"][:4], ground="frame", drive="crank")
    turning = [circuit for circuit in net.motion() if circuit.input_range is None]
    # in the third the second four-bar stops the crank
    assert len(turning) == 2
    for circuit in turning:
        alone = single.circuit(circuit.q[0, :4]).joint_ranges
        own = circuit.joint_ranges
        for name, other in zip(circuit.columns[:4], alone.values(), strict=True):
            agree(own[name], other, turns=True, size=1.0)
        last = list(alone.values())[-1]
        assert own["rocker"].low.input % math.tau == pytest.approx(last.low.input % math.tau, abs=1e-7)


@pytest.mark.parametrize("name", [name for name in sb.gallery.nets() if name != "peaucellier"])
def test_the_rows_of_a_net_lie_within_the_ranges_and_come_near_their_ends(name: str) -> None:
    motion = sb.load(name).motion(720)
    for circuit in motion:
        for column, one in circuit.joint_ranges.items():
            values = circuit.q[:, circuit.columns.index(column)]
            low, high = np.nanmin(values), np.nanmax(values)
            if one.low is None:
                assert high - low > 0.98 * math.tau
                continue
            rounding = 1e-9 * (1.0 if one.turns else motion.linkage.size)
            assert one.low.value - rounding <= low < one.low.value + 1e-2 * (high - low) + rounding
            assert one.high.value - 1e-2 * (high - low) - rounding < high <= one.high.value + rounding


@pytest.mark.parametrize(
    "name", ["rssr", "rccc", "bennett", "seven_r", "spherical_4r", "engine", "rssr_press"]
)
def test_ranges_of_a_loop_are_the_same_by_its_length_and_by_its_outputs(name: str) -> None:
    linkage = sb.load(name)
    for circuit in linkage.motion():
        ranges = circuit.joint_ranges
        by_output = net_joint_ranges(linkage, circuit)
        assert list(by_output) == list(ranges)
        for column, one in ranges.items():
            agree(one, by_output[column], turns=one.turns, size=linkage.size)


def test_a_slide_that_drives_a_net_has_the_range_of_the_input() -> None:
    for circuit in sb.load("five_rod").motion():
        one = circuit.joint_ranges["strut"]
        assert (one.low.value, one.high.value) == circuit.input_range
        assert (one.low.input, one.high.input) == circuit.input_range


def test_the_report_has_the_ranges_and_leaves_out_the_bends_of_balls() -> None:
    from sevenbar.reporting.extents import extent_rows, extents_dict

    motion = sb.load("double_wishbone").motion()
    rows = extent_rows(motion)[1]
    assert [row[1] for row in rows] == ["lower arm", "upper arm"] * 2
    assert extents_dict(motion[0], motion.linkage)["ball_cones"] is None


def test_a_hair_off_a_change_point_a_range_is_right_or_said_to_be_unknown() -> None:
    at = [(0, 0), (0, 1), (2 + 1e-12, 1), (2, 0), (2, 2), (4, 2), (4, 0)]
    links = ["frame crank", "crank coupler", "coupler rocker", "frame rocker", "rocker rod", "rod lever", "frame lever"]  # fmt: skip
    pins = [{"at": place, "links": names.split()} for place, names in zip(at, links, strict=True)]
    for circuit in sb.from_pins(pins, ground="frame").motion(360):
        try:
            ranges = circuit.joint_ranges
        except sb.errors.RequestError as error:
            assert str(error).startswith("circuit: the range of ")
            continue
        for column, one in ranges.items():
            values = circuit.q[:, circuit.columns.index(column)]
            if one.low is not None:
                assert one.low.value - 1e-8 <= np.nanmin(values)
                assert np.nanmax(values) <= one.high.value + 1e-8
