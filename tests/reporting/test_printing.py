"""Results print themselves: in a few lines what a person asks first, in notebooks with a picture."""

import re
import subprocess
import sys

import numpy as np
import pytest

import sevenbar as sb
from places import DOCS
from sevenbar.description.gallery import loops
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.printing import WIDTH, Printed, brief


def printed(value):
    """What a value prints, with numbers that rounding makes as ~."""
    return re.sub(r"\d\.\de[-+]\d\d", "~", repr(value))


@pytest.fixture(scope="module")
def linkage():
    return sb.load("rssr")


@pytest.fixture(scope="module")
def motion(linkage):
    return linkage.motion()


def test_a_name_that_is_longer_than_a_line_leaves_room_for_what_is_said_of_it():
    long = "x" * 190
    joints = [
        {"name": f"{long} {i}", "kind": "RRRP"[i], "at": at, "axis": (1, 0, 0) if i == 3 else (0, 0, 1)}
        for i, at in enumerate([(0, 0, 0), (40, 0, 0), (180, 0, 0), (180, 0, 0)])
    ]
    motion = sb.from_axes(joints, name=long).motion(36)
    for result in (motion, motion.linkage, motion.circuits[0], motion.circuits[0].at(0.3)):
        assert long in repr(result)


def test_a_linkage_prints_its_loop_dimensions_and_drive(linkage):
    assert printed(linkage) == (
        "Linkage 'RSSR of Sun and Zhou'\n"
        "  loop         R crank  S ball_a  S ball_b  R rocker\n"
        "  dimensions   M = 700  N = 700  L1 = 250  L2 = 997.497  L3 = 550  D = 0  [mm]\n"
        "  drive        crank at 10 rad/s, output rocker\n"
        "  points       A on link 1, B on link 3\n"
        "  length unit  mm"
    )
    assert "  dimensions   length twist offset of 7 links\n" in repr(sb.load("seven_r"))


def test_modes_print_how_many_they_are_and_whether_that_is_all():
    assert printed(sb.load("seven_r").assembly_modes(0.3)) == (
        "8 assembly modes at input 0.3\n"
        "  q             (8, 7): theta_1, theta_2, theta_3, theta_4, theta_5, theta_6, theta_7\n"
        "  status        8 ok\n"
        "  residual      at most ~\n"
        "  completeness  algebraic: all modes are found"
    )
    assert printed(sb.rssr(M=700, N=700, L1=250, L3=50, D=0).assembly_modes(3.0)).splitlines()[0] == (
        "0 assembly modes at input 3"
    )


def test_a_motion_prints_its_type_circuits_limits_completeness_and_closure_error(motion):
    assert printed(motion) == (
        "Motion of 'RSSR of Sun and Zhou'\n"
        "  drive          crank at 10 rad/s, output rocker\n"
        "  motion type    crank-rocker\n"
        "  circuits       2, each closes after one turn of the input\n"
        "    0            rocker -7.001° to 68.146°\n"
        "    1            rocker 111.854° to 187.001°\n"
        "  input limits   none: the input turns fully\n"
        "  completeness   closed-form: all modes are found\n"
        "  idle freedom   spin of the coupler (link 2) about the line of ball_a and ball_b, held by\n"
        "                 convention\n"
        "  redundant      no constraints\n"
        "  closure error  at most ~ mm"
    )


def test_the_page_on_motions_shows_what_a_motion_prints(motion):
    page = DOCS / "api" / "motions.md"
    shown = re.sub(r"\d\.\de[-+]\d\d", "~", page.read_text(encoding="utf-8"))
    assert "".join(f"    {line}\n" for line in printed(motion).splitlines()) in shown


def test_circuits_of_several_types_are_told_apart():
    lines = printed(sb.load("rscr").motion()).splitlines()
    assert lines[2:9] == [
        "  motion type    mixed",
        "                 the circuits differ; see below",
        "  circuits       3: 2 close after one turn of the input, 1 goes to and fro",
        "    0            crank-rocker, one turn, crank full turns, rocker -25.467° to 0.017°",
        "    1            double-rocker, to and fro, crank 295.376° to 214.546°, rocker 55.312° to 141.603°",
        "    2            crank-rocker, one turn, crank full turns, rocker -118.968° to -86.850°",
        "  input limits   214.546°  295.376°",
    ]


def test_a_circuit_prints_its_ranges_dead_centres_and_rates(motion):
    assert printed(motion.circuits[0]) == (
        "Circuit 0: crank-rocker, one turn\n"
        "  rows                 360: 360 ok\n"
        "  columns              crank, ball_a.1, ball_a.2, ball_a.3, ball_b.1, ball_b.2, ball_b.3, rocker\n"
        "  crank                full turns\n"
        "  rocker               -7.001° to 68.146°\n"
        "  output dead centres  37.949°, 196.303°\n"
        "  time ratio           1.27339\n"
        "  transmission angle   16.999° to 45.942°\n"
        "  velocity             -5.44544 to 7.95977\n"
        "  acceleration         -137.587 to 56.919\n"
        "  closure error        at most ~"
    )
    rocking = sb.load("rscr").motion().circuits[1]
    assert "  rows                 560: 2 dead-centre, 558 ok\n" in repr(rocking)
    assert "  input dead centres   295.376°, 214.546°\n" in repr(rocking)


def test_a_slide_is_printed_as_a_length():
    circuit = sb.load("rssp").motion().circuits[0]
    assert not circuit.output_turns
    low, high = circuit.output_range
    assert f"  {circuit.columns[circuit.output_column]:21}{low:.6g} to {high:.6g}\n" in repr(circuit)


def test_a_trace_and_the_closed_form_print_their_extent(motion):
    assert repr(motion.circuits[0].point(1, (250, 0, 0))) == (
        "Trace of a point: 360 rows\n"
        "  status        360 ok\n"
        "  x             -250 to 250\n"
        "  y             -250 to 250\n"
        "  z             700 to 700\n"
        "  speed         2500 to 2500\n"
        "  acceleration  25000 to 25000"
    )
    rocking = sb.rssr(M=700, N=700, L1=600, L3=550, D=0)
    found = rocking.output([0.0, np.pi], order=1)
    assert repr(found).splitlines()[:2] == [
        "Output of both branches at 2 inputs",
        "  status    2 no-solution, 2 ok",
    ]


@pytest.mark.parametrize("name", loops())
def test_every_result_of_the_gallery_prints_short_lines_without_solving(name, monkeypatch):
    linkage = sb.load(name)
    motion = linkage.motion(36)
    results = [linkage, motion, linkage.assembly_modes(0.3), *motion.circuits[:2]]
    results += [circuit.point(1, (1, 2, 3)) for circuit in motion.circuits[:1]]

    def solving(*_arguments, **_named):
        raise AssertionError("printing has solved")

    for method in ("motion", "assembly_modes", "circuit", "output"):
        monkeypatch.setattr(Linkage, method, solving)
    for result in results:
        lines = repr(result).splitlines()
        assert 2 <= len(lines) <= 24
        assert max(map(len, lines)) <= WIDTH
        assert "array(" not in repr(result)
        assert str(result) == repr(result)


def test_a_notebook_shows_the_lines_and_a_picture(linkage, motion):
    circuit = motion.circuits[0]
    for result in (linkage, motion, circuit, circuit.point(1, (250, 0, 0))):
        html = result._repr_html_()
        assert "<pre" in html
        assert repr(result).splitlines()[0].replace("'", "&#x27;") in html
        assert html.count("data:image/png;base64,") == 1
        assert len(html) < 80_000
    assert "<img" not in linkage.assembly_modes(0.3)._repr_html_()


def test_without_matplotlib_and_without_a_pose_there_is_no_picture_and_no_error(linkage, motion, monkeypatch):
    apart = sb.rssr(M=700, N=700, L1=10, L2=20, L3=30, D=0)
    assert "<img" not in apart._repr_html_()
    assert "<img" not in apart.motion()._repr_html_()
    for module in ("figure", "configuration", "output_curves"):
        monkeypatch.setitem(sys.modules, f"sevenbar.drawing.{module}", None)
    for result in (linkage, motion, motion.circuits[0]):
        assert "<img" not in result._repr_html_()
        assert "RSSR" in result._repr_html_() or "Circuit 0" in result._repr_html_()


def test_dir_shows_what_a_user_needs(linkage, motion):
    for result in (linkage, motion, motion.circuits[0]):
        assert dir(result)
        assert all(not name.startswith("_") for name in dir(result))
        assert all(hasattr(result, name) for name in dir(result))
    assert {"assembly_modes", "motion", "joints", "drive"} <= set(dir(linkage))
    assert set(dir(sb)) >= set(sb.__all__) | {"plot", "sweep", "design"}
    assert not {"importlib", "annotations", "ModuleType", "kinematics"} & set(dir(sb))


def test_a_result_quoted_in_a_message_is_one_line(linkage):
    with pytest.raises(sb.errors.SevenbarError) as caught:
        sb.load("rssr").motion(samples=linkage)
    assert "\n" not in str(caught.value)


def test_an_array_is_told_by_its_shape_and_a_result_by_its_head(linkage, motion):
    assert brief(np.zeros((3, 4))) == "array (3, 4)"
    assert brief(linkage) == "Linkage 'RSSR of Sun and Zhou'"
    assert brief(motion.circuits) == "2 of them"
    assert brief({"a": 1.23456789}) == "a: 1.23457"
    assert repr(motion.circuits[0].link_motion(1)) == (
        "LinkMotion\n"
        "  rotation      array (360, 3, 3)\n"
        "  velocity      array (360, 3)\n"
        "  acceleration  array (360, 3)"
    )


def test_an_import_of_the_package_loads_no_words_of_results():
    code = "import sys, sevenbar; print('sevenbar.reporting' in sys.modules)"
    run = [sys.executable, "-c", code]
    assert subprocess.run(run, capture_output=True, text=True, check=True).stdout == "False\n"


def test_json_of_a_motion_loads_nothing_that_prints_pages():
    code = (
        "import sys, sevenbar as sb\n"
        "from sevenbar.reporting.report import as_json\n"
        "as_json(sb.load('rssr').motion())\n"
        "print([name for name in ('rich.console', 'sevenbar.reporting.printed') if name in sys.modules])"
    )
    run = [sys.executable, "-c", code]
    assert subprocess.run(run, capture_output=True, text=True, check=True).stdout == "[]\n"


def test_results_of_all_packages_print_themselves():
    from sevenbar.design.maps import motion_map
    from sevenbar.design.tolerance import sensitivities
    from sevenbar.measuring.compare import compare, ends_of
    from sevenbar.measuring.measured import read_measured
    from sevenbar.sweep import grid, run

    linkage = sb.load("rssr")
    ends = ends_of(linkage)
    bench = compare(linkage, read_measured("examples/rssr_bench.csv", ends), ends)
    drawn = motion_map(linkage, {"L1": (240, 260), "L3": (540, 560)}, grid=5)
    swept = run(linkage, {"L1": grid(200, 500, 4)}, ["motion_type"])
    heads = {
        "Comparison of 'RSSR of Sun and Zhou'": bench,
        "Map of 'RSSR of Sun and Zhou'": drawn,
        "Sensitivities of 'RSSR of Sun and Zhou', circuit 0": sensitivities(linkage, samples=8),
        "Sweep of 4 linkages": swept,
    }
    for head, result in heads.items():
        assert isinstance(result, Printed)
        lines = repr(result).splitlines()
        assert lines[0] == head
        assert 4 <= len(lines) <= 16
        assert max(map(len, lines)) <= WIDTH
    assert "circuit 0, branch 0" in repr(bench)
    assert "crank-rocker" in repr(drawn)
    assert "  dimensions  L1_mm" in repr(swept)


def test_a_motion_without_a_row_that_has_rates_has_no_closure_error():
    # every pose of it is a change point
    motion = sb.rssr(M=1e-50, N=-1e-100, L1=2.0, L2=1.000000000000001, L3=1e12, D=1e12).motion()
    assert "closure error  no row has one" in repr(motion)
    assert "nan" not in repr(motion) + repr(motion.circuits[0])


def test_a_brief_report_has_what_a_linkage_does_and_says_where_others_may_be_missing():
    from sevenbar.reporting.summary import summary

    known = summary(sb.load("planar_4r").motion(36), short=True)
    assert [name for name, _ in known.facts] == ["drive", "motion type", "circuits", "input limits"]
    assert "transmission angle min" in [row[0] for sheet in known.sheets for row in sheet.rows]
    unsure = dict(summary(sb.load("screw_drill").motion(36), short=True).facts)
    assert unsure["completeness"].startswith("searched")
