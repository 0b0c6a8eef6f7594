"""The command that writes screw axes, and the handles of results in Python."""

import csv
import json
import traceback

import matplotlib
import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar


def test_the_table_has_every_row_of_every_circuit_with_units(tmp_path):
    run = sevenbar("axodes", "planar_4r", "--samples", "24", "--out", str(tmp_path / "axes"))
    assert "screw axes against the ground, theta_1 at 1 rad/s" in run.stdout
    with (tmp_path / "axes" / "axodes.csv").open() as file:
        rows = list(csv.DictReader(file))
    motion = sb.load("planar_4r").motion(24)
    assert len(rows) == 48
    axes = motion[1].screw_axes(2)
    for k in range(24):
        assert float(rows[24 + k]["link2_point_y_mm"]) == axes.point[k, 1]
        assert float(rows[24 + k]["link2_rate_rad_s"]) == axes.rate[k]
        centre = motion[1].instant_centres()[1, 3].in_plane[k, 0]
        assert float(rows[24 + k]["P13_x_mm"]) == centre
    told = json.loads((tmp_path / "axes" / "axodes.json").read_text())
    assert [one["link"] for one in told["circuits"][0]["links"]] == [1, 2, 3]
    again = mistake("axodes", "planar_4r", "--out", str(tmp_path / "axes"), cwd=tmp_path)
    assert "--force" in again


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--link", "9"), "--link: 9 is not a link; give 1 to 4, the last is the ground"),
        (("--link", "2", "--relative-to", "2"), "--relative-to: link 2 is one of --link; give another"),
        (("--relative-to", "0"), "--relative-to: 0 is not a link; give 1 to 4, the last is the ground"),
    ],
)
def test_links_that_do_not_exist_are_refused(tmp_path, arguments, message):
    assert message in mistake("axodes", "rssr", *arguments, cwd=tmp_path)


def test_a_motion_is_a_sequence_of_its_circuits():
    motion = sb.load("rssr").motion(24)
    assert len(motion) == 2
    assert motion[0] is motion.circuits[0]
    assert motion[-1] is motion.circuits[1]
    assert motion[np.int64(1)] is motion.circuits[1]
    assert motion[:] == motion.circuits
    assert list(motion) == list(motion.circuits)
    with pytest.raises(IndexError, match="no circuit 2; it has 2, counted from 0"):
        motion[2]
    apart = sb.rssr(M=700, N=700, L1=10, L2=20, L3=30, D=0).motion()
    assert len(apart) == 0
    assert apart


def test_results_draw_themselves():
    motion = sb.load("planar_4r").motion(24)
    for figure in (
        motion.plot(),
        motion.plot(kind="joints"),
        motion.linkage.plot(),
        motion.linkage.plot(kind="curves"),
    ):
        assert isinstance(figure, matplotlib.figure.Figure)
    with pytest.raises(
        sb.errors.RequestError, match="kind: 'curve' is not a figure of a motion; did you mean 'curves'"
    ):
        motion.plot(kind="curve")


def test_modules_offer_their_own_names_only():
    assert dir(sb.plot) == sorted(sb.plot.__all__)
    assert not {"np", "math", "annotations"} & {
        name for word in sb._ON_DEMAND for name in dir(getattr(sb, word))
    }


@pytest.mark.parametrize(
    "call",
    [
        lambda: sb.load("no such linkage"),
        lambda: sb.loads("format = 2"),
        lambda: sb.rssr(M=1, N=2, L1=-3, L3=4, D=0),
        lambda: sb.from_dh("RR", length=[1], twist=[0, 0], offset=[0, 0]),
        lambda: sb.load("rssr").motion(samples=1),
        lambda: sb.load("rssr").assembly_modes("wide"),
        lambda: sb.load("rssr").motion(12)[0].point("C"),
        lambda: sb.load("rssr").motion(12).plot(kind="x"),
    ],
)
def test_a_traceback_ends_at_the_call(call):
    with pytest.raises(sb.errors.SevenbarError) as caught:
        call()
    frames = traceback.extract_tb(caught.value.__traceback__)
    inside = [frame for frame in frames if "/sevenbar/" in frame.filename.replace("\\", "/")]
    assert len(inside) == 1
    assert inside[0].filename.endswith("errors.py")
    assert caught.value.__suppress_context__


def test_the_speed_is_reported_as_it_was_written():
    from sevenbar.reporting.facts import facts_of

    found = sb.load("planar_4r")
    assert dict(facts_of(found.motion(12, speed="3000 rpm")))["drive"] == (
        "theta_1 at 3000 rpm (314.159 rad/s), output theta_4"
    )
    assert dict(facts_of(found.motion(12, speed=2.0)))["drive"] == "theta_1 at 2 rad/s, output theta_4"
    assert dict(facts_of(sb.load("universal_joint").motion(12)))["drive"].startswith(
        "input_shaft at 60 rpm (6.28319 rad/s)"
    )
    assert dict(facts_of(sb.load("rssr").motion(12)))["drive"] == "crank at 10 rad/s, output rocker"


def test_a_loop_without_a_name_is_called_by_what_it_is():
    from sevenbar.reporting.summary import summary

    found = sb.from_dh("RRRR", length=[40, 100, 80, 90], twist=[0] * 4, offset=[0] * 4)
    assert summary(found.motion(12)).title == "4R linkage"
    facts = dict(summary(found.motion(12)).facts)
    assert facts["links"] == "input link 40  coupler 100  output link 80  ground 90  [mm]"
    assert facts["Grashof"] == (
        "s + l - (p + q) = 40 + 100 - (80 + 90) = -30 mm; Grashof crank-rocker: theta_1 and theta_2 turn fully"
    )
