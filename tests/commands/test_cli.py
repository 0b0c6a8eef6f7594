"""The command line as a person meets it: what it prints, what it writes, what it says of mistakes."""

import csv
import io
import json
import math
import re

import numpy as np
import pytest
from rich.console import Console

import sevenbar as sb
from command_runs import mistake, sevenbar
from places import EXAMPLES, REFERENCES
from sevenbar.description.gallery import loops, names
from sevenbar.reporting import report

TABLE_1 = json.loads((REFERENCES / "rssr_table1.json").read_text(encoding="utf-8"))


def test_the_report_tells_the_paper_s_case():
    run = sevenbar("analyze", EXAMPLES / "rssr.toml")
    assert run.returncode == 0
    for words in (
        "crank-rocker",
        "-0.122185",
        "1.18937",
        "-5.44544",
        "7.95977",
        "-137.587",
        "56.919",
        "spin of the coupler",
    ):
        assert words in run.stdout


def test_json_is_one_object_and_nothing_else():
    run = sevenbar("analyze", "rssr", "--json")
    assert (run.returncode, run.stderr) == (0, "")
    report = json.loads(run.stdout)
    assert {
        "format",
        "linkage",
        "units",
        "motion_type",
        "limits",
        "completeness",
        "circuits",
        "idle",
        "redundant",
    } <= set(report)
    circuit = report["circuits"][0]
    wanted = {
        "motion_type",
        "closed",
        "turns",
        "dead_centres",
        "residual_max",
        "swing",
        "time_ratio",
        "transmission",
        "extremes",
    }
    assert wanted <= set(circuit)
    for quantity, (low, high) in TABLE_1["exact"].items():
        assert circuit["extremes"][quantity]["lowest"] == pytest.approx(low, rel=1e-9)
        assert circuit["extremes"][quantity]["highest"] == pytest.approx(high, rel=1e-9)


def test_a_value_without_bound_is_null_beside_its_status():
    report = json.loads(sevenbar("analyze", "rssr", "--input", "rocker", "--json").stdout)
    assert report["motion_type"] == "rocker-crank"
    velocity = report["circuits"][0]["extremes"]["velocity"]
    assert velocity["status"] == "unbounded"
    assert velocity["highest"] is None
    assert report["circuits"][0]["extremes"]["angle"]["status"] == "turns-fully"


def test_the_folder_holds_report_rows_and_figures(tmp_path):
    out = tmp_path / "new" / "folder"
    run = sevenbar("analyze", "rssr", "--samples", 36, "--out", out, "--figures", "png", "--figures", "svg")
    assert run.returncode == 0, run.stderr
    names = {
        "report.md",
        "report.json",
        "motion.csv",
        "configuration.png",
        "configuration.svg",
        "motion.png",
        "motion.svg",
    }
    assert {p.name for p in out.iterdir()} == names
    assert all(str(out / name) in run.stdout for name in names)
    with (out / "motion.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[:5] == ["circuit", "branch", "sample", "status", "time_s"]
    units = ("_s", "_deg", "_rad_s", "_rad_s2", "_rad_s3", "_mm", "_mm_s", "_mm_s2")
    # torque by torque has no unit
    assert all(name.endswith(units) or name == "mechanical_advantage" for name in list(rows[0])[4:])
    assert len(rows) == 2 * 36
    assert {row["circuit"] for row in rows} == {"0", "1"}
    motion = sb.load("rssr").motion(36)
    assert float(rows[40]["rocker_rad_s2"]) == motion.circuits[1].ddq[4, -1]
    assert json.loads((out / "report.json").read_text())["motion_type"] == "crank-rocker"


def test_a_row_without_value_is_an_empty_cell_beside_its_status(tmp_path):
    assert (
        sevenbar("analyze", "rssr", "--input", "rocker", "--samples", 36, "--out", tmp_path).returncode == 0
    )
    with (tmp_path / "motion.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    dead = [row for row in rows if row["status"] == "dead-centre"]
    assert len(dead) == 4
    assert all(row["crank_rad_s"] == "" and row["crank_deg"] != "" for row in dead)
    assert "nan" not in (tmp_path / "motion.csv").read_text()


@pytest.mark.parametrize(
    ("arguments", "taken"),
    [
        (["analyze", "rssr", "--out", "."], "report.md"),
        # a figure, of which is known only when the motion is that it is drawn
        (["analyze", "rssr", "--out", "."], "configuration.png"),
        (["analyze", "rssr", "--out", "out", "--animate", "move.gif"], "move.gif"),
        (["plot", "rssr", "--out", ".", "--kind", "curves"], "motion.png"),
        (["modes", "rssr", "--out", "modes.png"], "modes.png"),
    ],
)
def test_nothing_is_overwritten_without_force(tmp_path, arguments, taken):
    (tmp_path / taken).write_text("mine")
    message = f"{taken}: exists already; give another path, or --force to replace it"
    assert mistake(*arguments, cwd=tmp_path) == message
    assert [path.name for path in tmp_path.iterdir()] == [taken]
    assert (tmp_path / taken).read_text() == "mine"
    assert sevenbar(*arguments, "--force", cwd=tmp_path).returncode == 0
    assert (tmp_path / taken).read_bytes() != b"mine"


def test_a_written_file_replaces_the_old_one_and_leaves_others_alone(tmp_path):
    (tmp_path / "report.json").write_text("old")
    (tmp_path / "mine.txt").write_text("keep")
    assert sevenbar("analyze", "rssr", "--samples", 12, "--out", tmp_path, "--force").returncode == 0
    assert json.loads((tmp_path / "report.json").read_text())["format"] == 1
    assert (tmp_path / "mine.txt").read_text() == "keep"
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_a_linkage_that_does_not_close_is_an_answer(tmp_path):
    text = (EXAMPLES / "rssr.toml").read_text().replace("D = 0", "D = 0\nL2 = 10")
    (tmp_path / "short.toml").write_text(text)
    run = sevenbar("analyze", "short.toml", "--out", "out", cwd=tmp_path)
    assert run.returncode == 0
    assert "cannot-assemble" in run.stdout
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"report.md", "report.json", "motion.csv"}
    # nothing is known of constraints where no pose is
    assert "redundant" not in run.stdout
    film = sevenbar("analyze", "short.toml", "--out", "film", "--animate", "short.gif", cwd=tmp_path)
    assert film.returncode == 2
    assert film.stderr.strip().endswith(
        "--animate: cannot-assemble, there is no motion to draw; leave it out, the report says why"
    )
    assert not (tmp_path / "film").exists()


def test_animation_goes_where_it_is_told(tmp_path):
    run = sevenbar("analyze", "rssr", "--samples", 36, "--animate", tmp_path / "move.gif", "--seconds", 0.4)
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "move.gif").read_bytes()[:6] == b"GIF89a"
    again = sevenbar(
        "analyze", "rssr", "--samples", 36, "--json", "--animate", tmp_path / "again.gif", "--seconds", 0.4
    )
    assert json.loads(again.stdout)["samples"] == 36
    assert (tmp_path / "again.gif").exists()


def test_an_animation_goes_into_the_folder_that_is_made_for_the_report(tmp_path):
    asked = [
        "analyze", "rssr", "--samples", 36, "--figures", "svg", "--out", "new/report", "--seconds", 0.4
    ]  # fmt: skip
    run = sevenbar(*asked, "--animate", "new/../new/report/move.gif", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    folder = tmp_path / "new" / "report"
    made = {"report.md", "report.json", "motion.csv", "configuration.svg", "motion.svg", "move.gif"}
    assert {path.name for path in folder.iterdir()} == made
    assert (folder / "move.gif").read_bytes()[:6] == b"GIF89a"
    assert "new/report/move.gif" in run.stdout
    assert "move.gif" not in (folder / "report.md").read_text(encoding="utf-8")
    for name in made:
        (folder / name).write_text("mine")
    assert "exists already" in mistake(*asked, "--animate", "new/report/move.gif", cwd=tmp_path)
    assert {(folder / name).read_text() for name in made} == {"mine"}
    run = sevenbar(*asked, "--animate", "new/report/move.gif", "--force", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert all((folder / name).read_bytes() != b"mine" for name in made)
    assert {path.name for path in folder.iterdir()} == made


def test_an_animation_that_fails_leaves_no_report_in_its_folder(tmp_path):
    broken = (
        "import sevenbar.drawing.animate as a\n"
        "def fails(*_):\n    yield from ()\n    raise a.OutputError('no picture')\n"
        "a._pictures = fails"
    )
    asked = ["analyze", "rssr", "--samples", 36, "--out", "new/report", "--animate", "new/report/move.gif"]
    run = sevenbar(*asked, cwd=tmp_path, before=broken)
    assert run.returncode == 2
    assert run.stderr.splitlines()[-1] == "sevenbar: no picture"
    # the report comes first
    assert run.stdout.startswith("RSSR of Sun and Zhou")
    assert list(tmp_path.iterdir()) == []


def test_the_gallery_lists_its_linkages_with_their_titles_in_line():
    lines = sevenbar("gallery").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(names())
    (start,) = {len(line) - len(line.split(maxsplit=1)[1]) for line in lines}
    assert {line[start:] for line in lines} == {sb.load(name).name for name in names()}


def test_the_report_of_a_general_loop_says_how_it_moves():
    run = sevenbar("analyze", "bennett")
    assert run.returncode == 0, run.stderr
    for words in (
        "1 (Gruebler 4 - 6 = -2, rank 3, 3 redundant constraints)",
        "all modes over the complex numbers",
        "joint before it",
        "R theta_4 (ground)",
    ):
        assert words in run.stdout
    assert "transmission" not in run.stdout
    assert "idle" not in run.stdout


def test_eight_circuits_are_one_table_where_those_that_agree_share_a_row():
    run = sevenbar("analyze", "seven_r")
    lines = run.stdout.splitlines()
    assert max(len(line) for line in lines) <= 80
    assert "…" not in run.stdout
    motion = sb.load("seven_r").motion()
    told = []
    for place, line in enumerate(lines):
        if not re.match(r"\s+\d, \d  ", line):
            continue
        indices = [int(word) for word in re.findall(r"\d+", line)[:2]]
        told += indices
        for circuit in (motion.circuits[i] for i in indices):
            for low, high in (
                (circuit.velocity.lowest, circuit.velocity.highest),
                (circuit.acceleration.lowest, circuit.acceleration.highest),
            ):
                assert f" {low:.6g} @ " in line
                assert f" {high:.6g} @ " in lines[place + 1]
    assert told == list(range(8))
    assert run.stdout.count("double-crank") == 1
    (row,) = [line.split() for line in lines if "R theta_4" in line and line.split()[0] == "4"]
    assert row == ["4", "R", "theta_4", "-115", "10", "0"]


def test_a_slide_is_told_in_the_length_unit():
    text = sevenbar("analyze", "rssp").stdout
    circuit = sb.load("rssp").motion().circuits[0]
    assert re.search(rf"swing of slider \[mm\] +{circuit.swing:.6g}\b", text)
    assert "slider position max [mm]" in text
    assert f"{circuit.velocity.highest:.6g} @ {math.degrees(circuit.velocity.highest_at):.3f}°" in text
    text = sevenbar("analyze", "rssp", "--input", "slider", "--speed", "12 mm/s", "--output", "crank").stdout
    assert "slider at 12 mm/s, output crank" in text
    assert "value @ position of" in text
    assert "crank velocity" in text
    assert "no bound at limits" in text


def test_json_tells_mobility_and_how_the_circuits_were_found():
    report = json.loads(sevenbar("analyze", "bennett", "--json").stdout)
    assert report["mobility"] == {"gruebler": -2, "freedoms": 4, "rank": 3, "finite": 1}
    assert "modes" in report["how_found"]
    assert len(report["redundant"]) == 3
    assert report["linkage"]["columns"][0] == {"name": "theta_1", "kind": "turn"}


def test_the_modes_of_a_loop_are_a_table():
    run = sevenbar("modes", "seven_r", "--at", "0.5rad")
    assert (run.returncode, run.stderr) == (0, "")
    modes = sb.load("seven_r").assembly_modes(0.5)
    assert f"8 assembly modes at theta_1 = {math.degrees(0.5):.3f}°, algebraic" in run.stdout
    for index, q in enumerate(modes.q):
        (row,) = [
            line.split() for line in run.stdout.splitlines() if line.split()[:2] == [str(index), "28.648"]
        ]
        assert [float(x) for x in row[1:8]] == pytest.approx(np.degrees(q), abs=5.1e-4)
    assert max(len(line) for line in run.stdout.splitlines()) <= 80


@pytest.mark.parametrize(
    ("at", "value"),
    [
        ("30", math.pi / 6),
        ("30.000\u00b0", math.pi / 6),
        ("30deg", math.pi / 6),
        ("-0.25 rad", -0.25),
        ("1e1", math.pi / 18),
        ("pi/6", math.pi / 6),
        ("2*15", math.pi / 6),
        ("60deg - pi/6", math.pi / 6),
    ],
)
def test_an_angle_is_given_in_degrees_or_with_its_unit(at, value):
    report = json.loads(sevenbar("modes", "seven_r", "--json", f"--at={at}").stdout)
    assert report["input"] == {"joint": "theta_1", "value": pytest.approx(value, rel=1e-14)}
    assert (report["count"], report["completeness"]) == (8, "algebraic")
    assert np.array(report["modes"][3]["q"]) == pytest.approx(
        sb.load("seven_r").assembly_modes(report["input"]["value"]).q[3]
    )


@pytest.mark.parametrize(
    ("at", "value"), [("-20", -20.0), ("-2cm", -20.0), ("-20mm", -20.0), ("-40*sin(30deg)", -20.0)]
)
def test_a_slide_is_given_in_lengths(at, value):
    report = json.loads(sevenbar("modes", "rssp", "--json", "--input", "slider", f"--at={at}").stdout)
    assert report["input"] == {"joint": "slider", "value": pytest.approx(value, rel=1e-14)}


def test_no_mode_is_an_answer():
    run = sevenbar("modes", "rssp", "--input", "slider", "--at", "5m")
    assert run.returncode == 0
    assert "no assembly modes at slider = 5000 mm" in run.stdout


def test_poses_that_redundant_constraints_alone_keep_open_are_told_beside_the_modes(tmp_path):
    rows = "\n".join(
        f'[[link]]\njoint = "R"\nlength = {length}\noffset = 0\ntwist = {twist}'
        for length, twist in ((1.0, 2e-7), (2.0, 0), (2.0, 0), (3.5, 0))
    )
    (tmp_path / "leans.toml").write_text(f"format = 1\n{rows}\n", encoding="utf-8")
    run = sevenbar("modes", str(tmp_path / "leans.toml"), "--at", "100")
    assert "no assembly modes" in run.stdout
    # the axis leans by 2e-7 deg
    assert "2 more poses close except for redundant constraints, which miss by 3.5e-09" in run.stdout
    report = json.loads(sevenbar("modes", str(tmp_path / "leans.toml"), "--at", "100", "--json").stdout)
    assert report["count"] == 0
    assert report["open_by"] == pytest.approx([np.radians(2e-7)] * 2, rel=1e-2)


def test_the_modes_are_drawn(tmp_path):
    assert sevenbar("modes", "bennett", "--out", tmp_path / "modes.svg").returncode == 0
    assert "</svg>" in (tmp_path / "modes.svg").read_text()


def test_each_kind_of_figure_is_written(tmp_path):
    run = sevenbar("plot", "rssp", "--samples", 24, "--out", tmp_path)
    assert run.returncode == 0, run.stderr
    kinds = {"motion.png", "joints.png", "modes.png", "configuration.png", "path_B.png", "transmission.png"}
    assert {p.name for p in tmp_path.iterdir()} == kinds
    more = ("--kind", "point", "--link", 2, "--at", "50,0,1", "--circuit", 1, "--figures", "svg")
    assert sevenbar("plot", "rssp", "--samples", 24, *more, "--out", tmp_path).returncode == 0
    assert {p.name for p in tmp_path.iterdir()} == {*kinds, "path_link_2_50_0_1.svg"}


def test_the_folder_of_a_general_loop_holds_joints_and_paths_too(tmp_path):
    assert sevenbar("analyze", "rssp", "--samples", 24, "--out", tmp_path).returncode == 0
    figures = {"configuration.png", "motion.png", "joints.png", "path_B.png"}
    assert {p.name for p in tmp_path.iterdir()} == {"report.md", "report.json", "motion.csv", *figures}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["modes", "rssp", "--at", "3mm"],
            "--at: '3mm' is no value of crank, which turns; give 30, 30deg or 0.5rad",
        ),
        (
            ["modes", "rssp", "--input", "slider", "--at", "9deg"],
            "--at: '9deg' is no value of slider, which slides; give 250 or 250mm",
        ),
        (
            ["modes", "rssp", "--input", "ball_a"],
            "--input: joint 'ball_a' is a ball; give a joint with one freedom: crank, slider",
        ),
        (
            ["plot", "rssp", "--kind", "path", "--out", "out"],
            "--kind: 'path' is not a figure; give curves, joints, modes, configuration, point, transmission, coupler, axodes, skeleton or all",
        ),
        (["plot", "rssp", "--point", "C", "--out", "out"], "--point: no point 'C'; this linkage has B"),
        (
            ["plot", "rssp", "--link", "2", "--out", "out"],
            "--at: missing; give --point NAME, or --link with --at",
        ),
        (
            ["plot", "rssp", "--link", "5", "--at", "1,2,3", "--out", "out"],
            "--link: 5 is not a link; give 1 to 4, the last is the ground",
        ),
        (
            ["plot", "rssp", "--link", "2", "--at", "1,2", "--out", "out"],
            "--at: '1,2' is not a place; give three numbers, as in '-100,-90,-80'",
        ),
        (
            ["plot", "bennett", "--kind", "point", "--out", "out"],
            "--kind: point needs a point; give --link and --at, as the linkage names none",
        ),
        (
            ["plot", "bennett", "--circuit", "3", "--out", "out"],
            "circuit: 3 is not a circuit of this motion; give 0",
        ),
    ],
)
def test_each_mistake_with_modes_and_figures_ends_with_its_message(tmp_path, arguments, message):
    assert mistake(*arguments, cwd=tmp_path) == message
    assert not list(tmp_path.iterdir())


def _report(motion, width=100):
    console = Console(width=width, file=io.StringIO())
    report.print_text(motion, console)
    return console.file.getvalue()


def test_each_way_not_to_move_is_told_in_a_sentence():
    def turning(twist):
        return sb.from_dh("R" * len(twist), length=[40.0, 60, 50, 70, 45, 55, 65, 50][: len(twist)],
                          twist=twist, offset=[5.0, 10, 15, 20, 5, 10, 15, 20][: len(twist)])  # fmt: skip

    two = turning([0.5, 1.0, -0.7, 0.9, 1.2, -0.4, 0.8, 1.1]).motion(samples=12)
    assert two.motion_type == "two-inputs"
    assert "moves with 2 freedoms, so one input does not determine it" in _report(two)
    short = sb.from_dh("RRRR", length=[1.0, 1.0, 1.0, 50.0], twist=[0.0] * 4, offset=[0.0] * 4)
    assert short.motion().motion_type == "cannot-assemble"
    told = _report(short.motion())
    assert "no values of the joints were found that close the loop" in told
    assert "turns fully" not in told


@pytest.mark.parametrize("name", loops())
def test_the_report_of_every_linkage_of_the_gallery_holds_its_extremes_within_a_page(name):
    motion = sb.load(name).motion(samples=36)
    told = _report(motion)
    assert told.startswith(motion.linkage.name)
    assert max(len(line) for line in told.splitlines()) <= 100
    for circuit in motion:
        for extremes in (circuit.velocity, circuit.acceleration):
            if extremes is not None:
                ends = [0.0 if abs(x) < 1e-12 else x for x in (extremes.lowest, extremes.highest)]
                # what is the same throughout is met at no place
                at = "" if ends[1] - ends[0] < 1e-12 else " @ "
                assert f"{ends[0]:.6g}{at}" in told
                assert f"{ends[1]:.6g}{at}" in told
        for centre in circuit.dead_centres:
            assert _places([math.degrees(centre.input) % 360], told)
    if len(motion.circuits) > 1:
        # a class by Grashof's rule has the same words
        once = re.sub(r"^Grashof.*\n(?: .*\n)*", "", told, flags=re.MULTILINE)
        assert once.count(motion.motion_type) == 1
    page = report.markdown(motion)
    assert _words(page) == _words(told)


def _places(angles, told):
    """Whether each angle [deg] is told, to the last digit shown but for rounding."""
    shown = np.array([float(word) for word in re.findall(r"(-?\d+\.\d{3})°", told)]) % 360
    return all(np.abs((shown - angle + 180) % 360 - 180).min() < 1e-3 for angle in angles)


def _words(told):
    """Numbers and words in order of the alphabet, whatever stands between them."""
    return sorted(set(re.findall(r"[\w.°²/]+", told.replace("\\", "").replace("<br>", " "))) - {"-"})


def test_a_dead_centre_that_no_range_ends_at_is_told_beside_it():
    told = _report(sb.load("six_bar").motion(samples=36, input="parallel_3"))
    assert "other dead" in told
    # the circuit's range goes from 213.747 to 265.829; these two lie between
    (row,) = [line.split() for line in told.splitlines() if line.split()[:2] == ["1", "213.747°"]]
    assert row[2] == "219.256°"


def test_a_circuit_drawn_at_a_dead_centre_has_it_once():
    told = _report(sb.load("rsur").motion(samples=36, input="cross.2"))
    assert "other dead" not in told
    (row,) = [line.split() for line in told.splitlines() if line.split()[:2] == ["0", "0.000°"]]
    assert row == ["0", "0.000°", "-7.001°", "@", "4.077°"]
    assert "360.000°" not in told


def test_circuits_of_two_kinds_tell_their_kind_and_narrow_consoles_fold_at_the_place():
    motion = sb.load("rscr").motion(samples=36)
    told = _report(motion)
    for words in ("crank-rocker", "double-rocker", "one turn", "to and fro", "no bound at limits"):
        assert words in told
    narrow = _report(motion, width=80)
    assert max(len(line) for line in narrow.splitlines()) <= 80
    assert all(cell in narrow for cell in (" 0.18743 ", "@ 306.021°", "-118.968°", "@ 47.539°"))


def test_the_page_for_people_shows_the_figures_beside_it(tmp_path):
    assert sevenbar("analyze", "rssp", "--samples", 24, "--out", tmp_path).returncode == 0
    page = (tmp_path / "report.md").read_text(encoding="utf-8")
    shown = re.findall(r"!\[(\w+)\]\((.*?)\)", page)
    assert shown == [(name, f"{name}.png") for name in ("configuration", "joints", "motion", "path_B")]
    assert all((tmp_path / target).is_file() for _, target in shown)
    tables = [
        [line.count("|") for line in part.splitlines()] for part in page.split("\n\n") if part[0] == "|"
    ]
    assert tables
    assert all(len(set(bars)) == 1 for bars in tables)
