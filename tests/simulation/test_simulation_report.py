"""`sevenbar simulate` as a person meets it: what it prints, writes and draws, and what it says of mistakes."""

import csv
import json
import re

import mujoco
import numpy as np
import pytest
from matplotlib.figure import Figure

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.errors import NotCoveredError, OutputError, RequestError
from sevenbar.export.prototype import prototype
from sevenbar.reporting.csv_tables import write_columns
from sevenbar.simulation import report as simulation_report
from sevenbar.simulation.figures import joints_figure, output_figure, points_figure
from sevenbar.simulation.run import simulate


@pytest.fixture(scope="module")
def rssr():
    return simulate(sb.load("rssr"), "mujoco", steps=720)


@pytest.fixture(scope="module")
def rccc():
    return simulate(sb.load("rccc"), "exudyn", steps=90)


@pytest.mark.parametrize("engine", ["exudyn", "mujoco"])
def test_the_report_tells_engine_course_and_differences(engine):
    run = sevenbar("simulate", "rssr", "--engine", engine, "--steps", 360)
    assert run.returncode == 0
    for words in (
        {"exudyn": "Exudyn 1.", "mujoco": "MuJoCo "}[engine],
        "crank at 10 rad/s, output rocker",
        "circuit 0, one turn of the input",
        "360 of 0.00174533 s",
        "closure error",
        "the idle spin of link_2 is held",
        "rocker angle [rad]",
        "rocker velocity [rad/s]",
        "rocker acceleration [rad/s²]",
        "ball_b.3 angle [rad]",
        "B position [mm]",
    ):
        assert words in run.stdout
    # no bar where there is no terminal
    assert run.stderr == f"{engine}: RSSR of Sun and Zhou ..\n"


def test_a_run_is_reported_in_english_whatever_language_is_spoken(rccc, capsys):
    simulation_report.print_text(rccc)
    page, plain = capsys.readouterr().out, simulation_report.as_json(rccc)
    with sb.language("zh"):
        simulation_report.print_text(rccc)
        assert capsys.readouterr().out == page
        assert simulation_report.as_json(rccc) == plain


def test_json_is_one_object_and_nothing_else():
    run = sevenbar("simulate", "bennett", "--engine", "mujoco", "--steps", 360, "--json")
    found = json.loads(run.stdout)
    assert found["engine"]["name"] == "MuJoCo"
    assert found["engine"]["version"] == mujoco.__version__
    assert any(note.startswith("3 redundant constraints") for note in found["engine"]["notes"])
    assert found["course"] == {
        "circuit": 0,
        "closes": True,
        "rows": 361,
        "lead": 100,
        "step": pytest.approx(2 * np.pi / 360),
    }
    assert found["differences"][0]["quantity"] == "theta_4 angle"
    assert 0 < found["differences"][0]["greatest"] < 1e-2
    assert found["closure_error"]["length"] > 0


@pytest.mark.parametrize("engine", ["exudyn", "mujoco"])
def test_an_engine_that_is_not_there_is_named_with_the_extra_that_brings_it(engine, tmp_path):
    message = mistake(
        "simulate",
        "rssr",
        "--engine",
        engine,
        "--out",
        "out",
        cwd=tmp_path,
        before=f"sys.modules['{engine}'] = None",
    )
    assert message == (
        f"simulate needs {engine}, which is not installed; install it with: pip install 'sevenbar[simulate]'"
    )
    assert not list(tmp_path.iterdir())


def test_an_engine_that_cannot_be_loaded_says_why(tmp_path):
    (tmp_path / "exudyn.py").write_text("raise ImportError('libGL.so.1: no such file')")
    message = mistake("simulate", "rssr", before=f"sys.path.insert(0, {str(tmp_path)!r})")
    assert message == (
        "simulate: exudyn cannot be loaded: libGL.so.1: no such file; "
        "install it with: pip install 'sevenbar[simulate]'"
    )


def test_the_rest_works_without_any_engine():
    before = "sys.modules['exudyn'] = sys.modules['mujoco'] = None"
    assert sevenbar("analyze", "rssr", "--json", before=before).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["rssr", "--engine", "adams"],
            "engine: 'adams' is not an engine; give exudyn or mujoco; a file for another program is written by "
            "'sevenbar export .. --to', as in --to adams",
        ),
        (["rssr", "--circuit", "5"], "circuit: 5 is not a circuit of this motion; give 0 to 1"),
        (
            ["rssr", "--input", "rocker", "--steps", "72"],
            "circuit: circuit 0 has 13 rows to compare at 72 steps a turn; give more --steps, or another --circuit",
        ),
        (["rssr", "--steps", "2"], "steps: 2 is not a count; give 4 to 1000000"),
        (
            ["rssr", "--out", "out", "--figures", "bmp"],
            "--figures: 'bmp' is not a figure format; give png, svg, pdf or eps",
        ),
        (
            ["rssr", "--figures", "svg"],
            "--figures: a folder for them is missing; give --out, as in '--out report'",
        ),
        (
            ["rssr", "--speed", "0"],
            "speed: '0' moves nothing; give a finite speed other than 0, as in '10 rad/s'",
        ),
        (
            ["no.toml"],
            "no.toml: no such file; give the path of a TOML file, or a name that 'sevenbar gallery' lists",
        ),
    ],
)
def test_a_mistake_is_one_message(arguments, message, tmp_path):
    assert mistake("simulate", *arguments, cwd=tmp_path) == message


def test_a_linkage_that_cannot_be_simulated_says_why():
    joints = [
        {"name": "crank", "kind": "R", "at": (0, 0, 700), "axis": (0, 0, 1)},
        {"name": "ball", "kind": "S", "at": (250, 0, 700)},
        {"name": "cross", "kind": "U", "at": (700, 550, 0), "axes": [(0, 14, 11), (1, 0, 0)]},
        {"name": "first", "kind": "R", "at": (700, 300, 0), "axis": (1, 0, 0)},
        {"name": "second", "kind": "R", "at": (710, 300, 0), "axis": (1, 0, 0)},
    ]
    with pytest.raises(
        NotCoveredError,
        match=r"turn of link 4 about the common axis of second and first: an idle.*"
        "describe the loop without it: R S U R moves alike, without first",
    ):
        simulate(sb.from_axes(joints), "mujoco", input="crank", output="second")
    with pytest.raises(RequestError, match=r"short does not move \(cannot-assemble\), so no engine"):
        simulate(sb.rssr(M=700, N=700, L1=250, L3=550, D=0, L2=2, name="short"), "mujoco")


def test_the_loop_that_is_named_in_place_of_one_with_an_idle_freedom_has_its_motion():
    ends = (
        {"name": "crank", "kind": "R", "at": (0, 0, 0), "axis": (0, 0, 1)},
        {"name": "ball", "kind": "S", "at": (60, 20, 30)},
        {"name": "slider", "kind": "P", "at": (60, 20, 30), "axis": (1, 0.3, 0.2)},
    )
    plate = {"name": "plate", "kind": "E", "at": (60, 20, 30), "axis": (1, 0, 0)}
    slides = [{"kind": "P", "at": (60, 20, 30), "axis": axis} for axis in ((0, 1, 0), (0, 0, 1))]
    idle = sb.from_axes([ends[0], plate, *ends[1:]])
    with pytest.raises(NotCoveredError, match=r"without it: R P P S P moves alike, P P in place of plate$"):
        simulate(idle, "mujoco", input="crank", output="slider")
    own = sb.from_axes([ends[0], *slides, *ends[1:]])
    assert own.kind == "RPPSP"
    one, other = (linkage.motion(72, output="slider") for linkage in (idle, own))
    assert one.motion_type == other.motion_type
    for first, second in zip(one, other, strict=True):
        assert np.allclose(first["slider"], second["slider"], atol=1e-9)
    assert len(prototype(own, other[0], 0, 1.0).bodies) == 4


def test_the_folder_holds_report_rows_model_and_figures(rssr, tmp_path):
    written = simulation_report.write(rssr, tmp_path / "new", ("png", "svg"))
    kinds = [
        f"mujoco_{name}.{ending}" for name in ("output", "joints", "points") for ending in ("png", "svg")
    ]
    assert sorted(path.name for path in written) == sorted(
        ["mujoco.json", "mujoco.csv", "mujoco.xml", *kinds]
    )
    assert sorted((tmp_path / "new").iterdir()) == sorted(written)
    assert json.loads((tmp_path / "new" / "mujoco.json").read_text())["course"]["rows"] == 721
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "new" / "mujoco.xml")).opt.timestep == rssr.course.step


def test_the_rows_are_written_with_both_sides_and_their_units(rssr, rccc, tmp_path):
    write_columns(tmp_path / "rows.csv", simulation_report.columns(rssr))
    with (tmp_path / "rows.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 721
    assert list(rows[0])[:4] == ["row", "time_s", "crank_sevenbar_deg", "crank_mujoco_deg"]
    rocker = sb.load("rssr").output(
        np.radians([float(row["crank_sevenbar_deg"]) for row in rows]), 2, speed=10.0
    )
    for name, values, factor, tolerance in (
        ("deg", rocker.position, 180 / np.pi, 0.02),
        ("rad_s", rocker.velocity, 1, 0.1),
        ("rad_s2", rocker.acceleration, 1, 0.5),
    ):
        read = [[float(row[f"rocker_{who}_{name}"]) for row in rows] for who in ("sevenbar", "mujoco")]
        assert read[0] == pytest.approx(values[0] * factor, abs=1e-9)
        assert read[1] == pytest.approx(values[0] * factor, abs=tolerance)
    # a rate that is not formed is an empty cell
    assert {row["ball_a.1_mujoco_rad_s"] for row in rows} == {""}
    assert max(float(row["closure_error_mm"]) for row in rows) == pytest.approx(rssr.gap)
    assert "slide_2_exudyn_in" in simulation_report.columns(rccc)


def test_nothing_is_written_over_without_being_told_to(rssr, tmp_path):
    (tmp_path / "mujoco.csv").write_text("mine")
    with pytest.raises(
        OutputError, match=re.escape(f"{tmp_path / 'mujoco.csv'}: exists already; give another")
    ):
        simulation_report.write(rssr, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mujoco.csv"]
    assert (tmp_path / "mujoco.csv").read_text() == "mine"
    simulation_report.write(rssr, tmp_path, force=True)
    assert (tmp_path / "mujoco.csv").read_text().startswith("row,")


def test_a_folder_that_cannot_be_made_is_told_before_the_run(tmp_path):
    (tmp_path / "taken").write_text("a file")
    # a million steps would take minutes, and show a bar
    assert mistake("simulate", "rssr", "--steps", 1_000_000, "--out", "taken/out", cwd=tmp_path) == (
        "taken/out: cannot be written: taken is a file; give a folder that can be made or written"
    )


def test_the_program_refuses_before_the_run_and_writes_with_force(tmp_path):
    call = ["simulate", "five_bar", "--engine", "exudyn", "--steps", 60, "--out", "out"]
    assert sevenbar(*call, cwd=tmp_path).returncode == 0
    assert mistake(*call, cwd=tmp_path) == (
        "out/exudyn.json: exists already; give another path, or --force to replace it"
    )
    before = (tmp_path / "out" / "exudyn.json").stat().st_mtime_ns
    assert sevenbar(*call, "--force", cwd=tmp_path).returncode == 0
    assert (tmp_path / "out" / "exudyn.json").stat().st_mtime_ns > before
    # the other engine shares the folder
    assert sevenbar(*call[:3], "mujoco", *call[4:], cwd=tmp_path).returncode == 0


def test_files_appear_all_or_none(rssr, tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Figure, "savefig", full)
    with pytest.raises(OutputError, match="no space left on device"):
        simulation_report.write(rssr, tmp_path / "new")
    assert not list(tmp_path.iterdir())


def test_figures_have_theory_as_a_line_the_engine_as_marks_and_the_difference_on_its_own_scale(rssr):
    figure = output_figure(rssr)
    panels = figure.axes
    assert len(panels) == 6
    for left, right, engine, theory, factor in zip(
        panels[::2],
        panels[1::2],
        (rssr.engine.q, rssr.engine.dq, rssr.engine.ddq),
        (rssr.theory.q, rssr.theory.dq, rssr.theory.ddq),
        (180 / np.pi, 1, 1),
        strict=True,
    ):
        line, marks = left.lines
        assert (line.get_linestyle(), line.get_marker()) == ("-", "None")
        assert (marks.get_linestyle(), marks.get_marker()) == ("None", "o")
        assert line.get_ydata() == pytest.approx(theory[:, -1] * factor)
        chosen = np.searchsorted(line.get_xdata(), marks.get_xdata())
        assert marks.get_ydata() == pytest.approx(engine[chosen, -1] * factor)
        (error,) = right.lines
        assert error.get_ydata() == pytest.approx(engine[:, -1] - theory[:, -1])
        low, high = right.get_ylim()
        assert high - low < 3 * np.ptp(error.get_ydata())
    assert [axes.get_ylabel() for axes in panels[1::2]] == [
        "difference [rad]",
        "difference [rad/s]",
        "difference [rad/s²]",
    ]


def test_each_run_draws_what_it_has(rssr, rccc, tmp_path):
    for run, stems in ((rssr, ["joints", "output", "points"]), (rccc, ["joints", "output"])):
        name = run.record.engine.lower()
        written = simulation_report.write(run, tmp_path / run.linkage.name, ["svg"])
        assert [path.name for path in written if path.suffix == ".svg"] == [f"{name}_{s}.svg" for s in stems]
    # turns and slides apart, theory and engine for each column
    panels = joints_figure(rccc).axes
    assert [len(axes.lines) for axes in panels] == [8, 4, 6, 3]
    assert panels[2].get_ylabel() == "slides [in]"
    assert [len(axes.lines) for axes in points_figure(rssr).axes] == [4, 2] * 3
