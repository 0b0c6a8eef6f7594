"""The lengths that a report prints of a drawing are dimensions: places at the ground, other lengths, zeros stay."""

from __future__ import annotations

import copy
import json

import numpy as np
import pytest
from typer.testing import CliRunner

import sevenbar as sb
from compared_slopes import compare_all
from sevenbar.commands.cli import app
from sevenbar.description.draft import Draft
from sevenbar.description.forms import from_description
from sevenbar.design.task import DesignTask, FigureWant, FreeNumber
from sevenbar.design.task.file.reader import task_file
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.tolerance.sensitivities import sensitivities
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.kinematics.loop.rigid import rotation_of
from sevenbar.measuring.calibrate import calibrate
from sevenbar.measuring.measured import Measured
from sevenbar.sweep.space import Space

#: A planar four-bar of 40, 100, 80 on a ground of 90, the input link along y; joints at two heights, as CAD has them.
AS_DRAWN = np.eye(3)
INPUT, COUPLER, OUTPUT, GROUND = 40.0, 100.0, 80.0, 90.0


def run(*words):
    result = CliRunner().invoke(app, [*words])
    return result.exit_code, result.output


def planar(first=INPUT, coupler=COUPLER, output=OUTPUT, *, turn=AS_DRAWN, drive=("a", "d")):
    """The four-bar, drawn with the input link straight up."""
    a, d, b = np.zeros(2), np.array([GROUND, 0.0]), np.array([0.0, first])
    apart = d - b
    r = np.hypot(*apart)
    along = (coupler**2 - output**2 + r**2) / (2 * r)
    across = np.sqrt(coupler**2 - along**2)
    c = b + (along * apart + across * np.array([-apart[1], apart[0]])) / r
    joints = [
        {"name": name, "kind": "R", "at": (turn @ [*place, height]).tolist(), "axis": turn[:, 2].tolist()}
        for name, place, height in zip("abcd", (a, b, c, d), (0, 5, 5, 0), strict=True)
    ]
    points = [{"name": "P", "link": 2, "at": (turn @ [*np.add(b, [10, 20]), 5]).tolist()}]
    ends = {"joint": drive[0], "output": drive[1]}
    return from_description({"format": 1, "drive": ends, "joint": joints, "point": points})


CRANK_AXIS, ROCKER_AXIS = np.array([0, 0, 1.0]), np.array([1, 0.1, 0])
CRANK, ROCKER = np.array([0, 0, 10.0]), np.array([300, 30, 20.0])
A, B = np.array([48.5, 0, 0]), np.array([300, 100, 66.0])


def rssr(a=A, b=B):
    joints = [
        {"name": "crank", "kind": "R", "at": CRANK.tolist(), "axis": CRANK_AXIS.tolist()},
        {"name": "ball_a", "kind": "S", "at": a.tolist()},
        {"name": "ball_b", "kind": "S", "at": b.tolist()},
        {"name": "rocker", "kind": "R", "at": ROCKER.tolist(), "axis": ROCKER_AXIS.tolist()},
    ]
    return sb.from_axes(joints)


def farther(place, on, axis, share):
    """A place moved away from an axis, its distance being a share longer."""
    axis = axis / np.linalg.norm(axis)
    foot = on + axis * ((place - on) @ axis)
    return foot + (1 + share) * (place - foot)


def with_lengths(linkage, **lengths):
    return Draft.of_linkage(linkage).with_values(lengths).linkage


@pytest.mark.parametrize("turn", [np.eye(3), rotation_of(np.array([0.5, 0.1, -0.7, 0.5]))])
@pytest.mark.parametrize("lengths", [(30, 110, 70), (40, 100, 80), (90, 90, 90), (50, 90, 50.0)])
def test_a_drawn_four_bar_of_other_lengths_is_the_four_bar_of_these_lengths(lengths, turn) -> None:
    names = ("input_link", "coupler", "output_link")
    changed = with_lengths(planar(turn=turn), **dict(zip(names, lengths, strict=True)))
    assert changed.lengths == pytest.approx(lengths, abs=1e-12)
    ours, theirs = changed.motion(), sb.four_bar(*lengths, GROUND).motion()
    assert ours.motion_type == theirs.motion_type
    swings = [sorted(c.swing or 0.0 for c in motion) for motion in (ours, theirs)]
    assert swings[0] == pytest.approx(swings[1], abs=1e-7)


def test_links_may_be_named_as_the_report_prints_them_and_by_their_place_in_the_file() -> None:
    draft = Draft.of_linkage(planar())
    assert [d.name for d in draft.lengths] == ["input_link", "coupler", "output_link"]
    assert (
        draft.dimension("input link") == draft.dimension("input_link") == draft.dimension("joint[1].longer")
    )
    # driven from the other end, links change their roles
    names = [d.name for d in Draft.of_linkage(planar(drive=("d", "a"))).lengths]
    assert names == ["output_link", "coupler", "input_link"]


def test_a_drawn_rssr_of_other_lengths_is_that_redrawn_with_crank_and_rocker_as_they_point() -> None:
    a, b = farther(A, CRANK, CRANK_AXIS, -0.3), farther(B, ROCKER, ROCKER_AXIS, 0.1)
    redrawn = rssr(a, b)
    names = ("crank", "coupler", "rocker")
    changed = with_lengths(rssr(), **dict(zip(names, redrawn.lengths, strict=True)))
    assert changed.lengths == pytest.approx(redrawn.lengths, rel=1e-14)
    ours, theirs = changed.motion(), redrawn.motion()
    assert ours.motion_type == theirs.motion_type
    for one, other in zip(ours, theirs, strict=True):
        assert one.output == pytest.approx(other.output, abs=1e-9, nan_ok=True)
        for ball in ("A", "B"):
            assert one.point(ball).position == pytest.approx(
                other.point(ball).position, abs=1e-8, nan_ok=True
            )
    found = sensitivities(changed, lengths=["rocker"])
    (x,) = [k for k, one in enumerate(found.outputs) if one.name == "A.x"]
    rows = found.status == "ok"
    trace = found.circuit.point("A").position[:, 0]
    assert found.values[rows, x] == pytest.approx(trace[rows], abs=1e-7)


def test_a_slider_crank_takes_both_links_and_says_that_its_offset_is_drawn() -> None:
    z = [0, 0, 1]
    joints = [
        {"name": "a", "kind": "R", "at": [0, 0, 0], "axis": z},
        {"name": "b", "kind": "R", "at": [0, 40, 0], "axis": z},
        {"name": "c", "kind": "R", "at": [90, 10, 0], "axis": z},
        {"name": "d", "kind": "P", "at": [50, 0, 0], "axis": [1, 0, 0]},
    ]
    linkage = sb.from_axes(joints)
    changed = with_lengths(linkage, input_link=30, coupler=120)
    motion = changed.motion()
    assert motion.four_bar.links == pytest.approx({"input link": 30, "coupler": 120})
    # the stroke of an offset slider-crank
    stroke = np.sqrt((120 + 30) ** 2 - 10**2) - np.sqrt((120 - 30) ** 2 - 10**2)
    assert motion[0].swing == pytest.approx(stroke)
    with pytest.raises(
        RequestError,
        match=r"'offset' follows from where joints are drawn; give one of input_link, coupler, a\.x",
    ):
        Draft.of_linkage(linkage).dimension("offset")


def test_what_a_link_carries_stays_on_it_and_zeros_stay_where_they_are_drawn() -> None:
    changed = with_lengths(planar(), input_link=50)
    for circuit in changed.motion(36):
        row = int(np.argmin(np.abs(circuit.input)))
        # the input link points up at zero, as drawn
        place = circuit.point("P").position[row]
        assert np.hypot(*(place[:2] - [0, 50])) == pytest.approx(np.hypot(10, 20))


def test_derivatives_by_lengths_are_those_of_changed_linkages() -> None:
    linkage = rssr()
    found = sensitivities(linkage, lengths=["crank", "coupler", "rocker"])
    for name in ("crank", "coupler", "rocker"):
        place, h = found.loop.numbers.names.index(name), 1e-4
        change = np.zeros(len(found.loop.numbers.names))
        change[place] = h
        outputs = [found.changed(sign * change).motion(found.samples)[0] for sign in (1, -1)]
        for measure in ("swing",):
            slope = np.degrees(outputs[0].swing - outputs[1].swing) / (2 * h)
            assert float(found.measure(measure).slopes[place]) == pytest.approx(slope, rel=1e-4)


def test_a_file_says_how_much_longer_a_link_is_and_reads_back(tmp_path) -> None:
    draft = Draft.of_linkage(rssr()).with_values({"crank": 30.0})
    path = tmp_path / "shorter.toml"
    path.write_text(draft.toml())
    assert "longer = -18.5" in draft.toml()
    assert sb.load(path).lengths == draft.linkage.lengths
    code, shown = run("analyze", str(path))
    assert code == 0
    assert "crank = 30 " in shown


def test_a_map_and_a_sweep_vary_the_lengths_that_the_report_prints(tmp_path) -> None:
    path = tmp_path / "four.toml"
    path.write_text(Draft.of_linkage(planar()).toml())
    args = ["--over", "input link=20:60:3", "--over", "coupler=90:110:2", "--measure", "swing", "--json"]
    code, shown = run("sweep", str(path), *args)
    assert (code, json.loads(shown[shown.index("{") :])["linkages"]) == (0, 6)
    ranges = ["--over", "input_link=20:60", "--over", "output_link=60:90"]
    code, shown = run("map", str(path), *ranges, "--grid", "4")
    assert code == 0
    assert "crank-rocker" in shown
    assert "coupler, a.x" in shown


def test_a_length_and_a_place_that_changes_it_are_refused(tmp_path) -> None:
    path = tmp_path / "four.toml"
    path.write_text(Draft.of_linkage(planar()).toml())
    draft, over = Draft.of(path.read_text(), "four"), {"input_link": [20, 30], "b.x": [-1, 1]}
    with pytest.raises(
        RequestError, match=r"input_link counts from its drawn length, which b\.x changes; give one"
    ):
        Space.of(draft, over, None, None, None)


@pytest.mark.parametrize(
    ("joint", "longer", "message"),
    [
        (3, 1.0, "joint[4].longer: does not belong to the last joint"),
        (0, -40.0, "joint[1].longer: -40 leaves nothing of link 1; give more than -40"),
        (0, "long", "joint[1].longer: 'long': no 'long' is known"),
    ],
)
def test_what_is_wrong_with_a_longer_link_is_named(joint, longer, message) -> None:
    raw = json.loads(json.dumps(planar().description, default=list))
    raw["joint"][joint]["longer"] = longer
    with pytest.raises(DescriptionError) as error:
        from_description(raw)
    assert message in str(error.value)


def test_arcs_of_a_spherical_drawing_are_named_as_what_they_are() -> None:
    axes = ([1, 0, 0], [1, 0.5, 0], [1, 1, 1], [1, 0, 1])
    linkage = sb.from_axes([{"kind": "R", "at": [0, 0, 0], "axis": axis} for axis in axes])
    draft = Draft.of_linkage(linkage)
    assert draft.lengths == ()
    with pytest.raises(RequestError, match="'input_link' is an arc, which follows from the axes as drawn"):
        draft.dimension("input_link")


def test_a_calibration_finds_the_lengths_of_a_drawing() -> None:
    real = with_lengths(rssr(), crank=48.0, rocker=84.0)
    circuit = real.motion(90)[0]
    rows = np.flatnonzero(circuit.status == "ok")[:25]
    rows = rows[circuit.dq[rows, real.columns.index("crank")] > 0]
    values = {"input": circuit.input[rows], "angle": circuit.output[rows]}
    found = calibrate(rssr(), Measured("by hand", np.arange(len(rows)), values), free=["crank", "rocker"])
    assert {p.name: p.value for p in found.calibrated} == pytest.approx(
        {"crank": 48.0, "rocker": 84.0}, abs=1e-6
    )


# --- design tasks of drawings: their lengths, and the stops of the linkage

TASK = """
linkage = "four.toml"
[free]
input_link = "30:60"
"P.x" = "0:150"
[[want]]
kind = "straight"
point = "P"
range = "{range}"
"""


def written(tmp_path, text, stop=""):
    draft = Draft.of_linkage(planar())
    (tmp_path / "four.toml").write_text(draft.toml() + stop)
    (tmp_path / "task.toml").write_text(text)
    return tmp_path / "task.toml"


def test_a_design_task_frees_a_length_of_a_drawing(tmp_path) -> None:
    task = task_file(written(tmp_path, TASK.format(range="0:90deg"))).task
    assert [one.name for one in task.free] == ["input_link", "P.x"]
    loop = TaskLoop(task.draft, task.names)
    changed = loop.drawn(loop.start + np.array([5.0, 0.0])).linkage
    assert changed.lengths == pytest.approx((INPUT + 5, COUPLER, OUTPUT))


def test_a_task_in_python_frees_a_length_and_refuses_what_is_no_dimension() -> None:
    want = FigureWant("swing", 70.0)
    task = DesignTask(Draft.of_linkage(planar()), (FreeNumber("input_link", 30, 60),), (want,))
    assert "input_link" in {one.name for one in task.draft.dimensions}
    with pytest.raises(RequestError, match="dimension: 'inputlink' is not a dimension"):
        DesignTask(Draft.of_linkage(planar()), (FreeNumber("inputlink", 30, 60),), (want,))


STOP = '\n[[stop]]\njoint = "{joint}"\nrange = ["-40deg", "60deg"]\n'


@pytest.mark.parametrize("turns", [0, 360])
def test_a_want_between_the_stops_of_the_input_is_taken(tmp_path, turns) -> None:
    text = TASK.format(range=f"{turns - 40}:{turns + 60}deg")
    assert task_file(written(tmp_path, text, STOP.format(joint="a"))).task.wants


def test_a_want_beyond_a_stop_of_the_input_is_refused(tmp_path) -> None:
    with pytest.raises(
        DescriptionError, match=r"want\[1\]: its inputs, .* go beyond a stop of a, .*; give inputs between"
    ):
        task_file(written(tmp_path, TASK.format(range="-30:61deg"), STOP.format(joint="a")))


def test_a_stop_that_nothing_holds_is_refused_until_a_must_holds_it(tmp_path) -> None:
    text = TASK.format(range="0:30deg")
    with pytest.raises(
        DescriptionError, match=r"must: none holds the stop of d, .* kind = 'range', joint = 'd'"
    ):
        task_file(written(tmp_path, text, STOP.format(joint="d")))
    held = text + '[[must]]\nkind = "range"\njoint = "d"\nrange = "-40:60deg"\n'
    assert task_file(written(tmp_path, held, STOP.format(joint="d"))).task.musts


def test_stops_of_a_longer_link_end_the_motion_where_the_four_bar_of_these_lengths_meets_them(
    tmp_path,
) -> None:
    # joints count from the drawn pose, whatever the lengths
    draft = Draft.of_linkage(with_lengths(planar(), input_link=45.0))
    (tmp_path / "four.toml").write_text(
        draft.toml() + '\n[[stop]]\njoint = "d"\nrange = ["-12deg", "15deg"]\n'
    )
    b, c, d = np.array([0.0, INPUT]), planar_place_c(0.0, INPUT), np.array([GROUND, 0.0])
    drawn = np.arctan2(*(c - d)[::-1])
    assert np.hypot(*(c - b)) == pytest.approx(COUPLER)
    ends = []
    for circuit in sb.load(str(tmp_path / "four.toml")).motion().circuits:
        for span in circuit.allowed.spans:
            ends += [span.start, span.end]
    assert ends
    for value in ends:
        off = np.arctan2(*(planar_place_c(value, 45.0) - d)[::-1]) - drawn
        off = np.degrees((off + np.pi) % (2 * np.pi) - np.pi)
        assert min(abs(off + 12), abs(off - 15)) < 1e-7


def planar_place_c(angle, first):
    """Where joint c is, the input link turned so far from straight up, on the drawn side of the diagonal."""
    b, d = first * np.array([-np.sin(angle), np.cos(angle)]), np.array([GROUND, 0.0])
    apart = d - b
    r = np.hypot(*apart)
    along = (COUPLER**2 - OUTPUT**2 + r**2) / (2 * r)
    across = np.sqrt(COUPLER**2 - along**2)
    return b + (along * apart + across * np.array([-apart[1], apart[0]])) / r


def test_a_path_varies_the_lengths_of_a_drawing(tmp_path) -> None:
    (tmp_path / "four.toml").write_text(Draft.of_linkage(planar()).toml())
    there = with_lengths(planar(), input_link=44.0, coupler=103.0).motion().circuits
    places = there[0].point("P").position[:180:30]
    rows = "\n".join(",".join(f"{x:.9f}" for x in place) for place in places)
    (tmp_path / "points.csv").write_text(f"x [mm],y [mm],z [mm]\n{rows}\n")
    words = ["--point", "P", "--vary", "input_link", "--vary", "coupler", "--starts", "2", "--json"]
    code, output = run(
        "design", "path", str(tmp_path / "four.toml"), "--path", str(tmp_path / "points.csv"), *words
    )
    assert code == 0
    best = json.loads(output[output.index("{") :])["designs"][0]
    assert best["input_link_mm"] == pytest.approx(44.0, abs=1e-4)
    assert best["coupler_mm"] == pytest.approx(103.0, abs=1e-4)


@pytest.mark.parametrize("link", [0, 1, 2])
@pytest.mark.parametrize("drawing", [planar, rssr])
def test_derivatives_by_places_of_a_longer_link_count_that_its_direction_turns(drawing, link) -> None:
    raw = copy.deepcopy(dict(drawing().description))
    raw["joint"][link]["longer"] = 15.0
    _, compared = compare_all(from_description({"format": 1} | raw))
    assert compared > 400
