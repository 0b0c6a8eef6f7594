"""The command line as a person meets it: what it prints, what it writes, what it says of mistakes."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest

import sevenbar as sb

EXAMPLES = Path(__file__).parent.parent / "examples"
TABLE_1 = json.loads((Path(__file__).parent / "references" / "rssr_table1.json").read_text(encoding="utf-8"))


def sevenbar(*arguments, cwd=None):
    command = [sys.executable, "-m", "sevenbar.cli", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=120, check=False)


def mistake(*arguments, cwd=None):
    """The one message of a call that must end with exit 2 and print nothing else."""
    run = sevenbar(*arguments, cwd=cwd)
    assert (run.returncode, run.stdout) == (2, "")
    assert "Traceback" not in run.stderr
    return run.stderr.removeprefix("sevenbar: ").rstrip("\n")


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
    assert all(name.endswith(units) for name in list(rows[0])[4:])
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


def test_a_written_file_replaces_the_old_one_and_leaves_others_alone(tmp_path):
    (tmp_path / "report.json").write_text("old")
    (tmp_path / "mine.txt").write_text("keep")
    assert sevenbar("analyze", "rssr", "--samples", 12, "--out", tmp_path).returncode == 0
    assert json.loads((tmp_path / "report.json").read_text())["format"] == 1
    assert (tmp_path / "mine.txt").read_text() == "keep"
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_a_linkage_that_does_not_close_is_an_answer(tmp_path):
    text = (EXAMPLES / "rssr.toml").read_text().replace("D = 0", "D = 0\nL2 = 10")
    (tmp_path / "short.toml").write_text(text)
    run = sevenbar("analyze", "short.toml", "--out", "out", cwd=tmp_path)
    assert run.returncode == 0
    assert "cannot-assemble" in run.stdout
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"report.json", "motion.csv"}


def test_animation_goes_where_it_is_told(tmp_path):
    run = sevenbar("analyze", "rssr", "--samples", 36, "--animate", tmp_path / "move.gif")
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "move.gif").read_bytes()[:6] == b"GIF89a"
    assert not sevenbar(
        "analyze", "rssr", "--samples", 36, "--json", "--animate", tmp_path / "move.gif"
    ).stdout.startswith("w")


def test_the_gallery_lists_its_linkages():
    assert sevenbar("gallery").stdout.split() == ["rssr", "RSSR", "of", "Sun", "and", "Zhou"]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "junk.toml").write_bytes(bytes(range(256)) * 20)
    (tmp_path / "nested.toml").write_text("a = " + "[" * 5_000_000 + "]" * 5_000_000)
    (tmp_path / "deep.toml").write_text("a = " + "[\n" * 30_000)
    (tmp_path / "dotted.toml").write_text(".".join("a" * 900) + " = 1\n")
    (tmp_path / "empty.toml").write_text("")
    (tmp_path / "taken").write_text("a file")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no.toml"], "no.toml: no such file; give the path of a TOML file or a gallery name: rssr"),
        (
            ["rsrs"],
            "rsrs: no such file; did you mean 'rssr'? give the path of a TOML file or a gallery name: rssr",
        ),
        (["."], ".: is a folder; give the path of a TOML file in it"),
        (["junk.toml"], "junk.toml: not text: byte 128 is not UTF-8; give a TOML file of format 1"),
        (
            ["nested.toml"],
            "nested.toml: larger than 100000 bytes, so it is no linkage file; give a TOML file of format 1",
        ),
        (["deep.toml"], "deep.toml: nested too deep; a linkage file has tables of plain keys only"),
        (["rssr", "--samples", "3"], "samples: 3 is not a count; give 4 to 1000000"),
        (
            ["rssr", "--speed", "0 rpm"],
            "speed: '0 rpm' moves nothing; give a finite speed other than 0, as in '10 rad/s'",
        ),
        (["rssr", "--figures", "bmp"], "--figures: 'bmp' is not a figure format; allowed: png, svg, pdf"),
        (
            ["rssr", "--out", "taken"],
            "taken: cannot be written: file exists; give a folder that can be made or written",
        ),
        (
            ["rssr", "--out", "taken/more"],
            "taken/more: cannot be written: not a directory; give a folder that can be made or written",
        ),
    ],
)
def test_each_mistake_ends_with_its_message_and_exit_2(folder, arguments, message):
    before = sorted(p.name for p in folder.iterdir())
    assert mistake("analyze", *arguments, cwd=folder) == message
    assert sorted(p.name for p in folder.iterdir()) == before


def test_a_name_nested_a_thousand_times_is_one_short_message(folder):
    lines = mistake("analyze", "dotted.toml", cwd=folder).splitlines()
    assert lines[1].startswith("sevenbar: dotted.toml: a: is not known here; ")
    assert all(len(line) < 300 for line in lines)


def test_words_that_the_command_line_does_not_know_end_with_exit_2():
    assert sevenbar("analyze", "rssr", "--samples", "many").returncode == 2
    assert sevenbar("analyse", "rssr").returncode == 2
    assert sevenbar("analyze").returncode == 2


def test_a_figure_in_a_place_that_cannot_be_written_leaves_nothing(folder):
    before = sorted(p.name for p in folder.iterdir())
    for place in ("taken/move.gif", "nowhere/move.gif", "move.avi"):
        message = mistake("analyze", "rssr", "--out", "out", "--animate", place, cwd=folder)
        assert place in message or "avi" in message
    assert sorted(p.name for p in folder.iterdir()) == before
