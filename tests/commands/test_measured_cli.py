"""`sevenbar compare` and `sevenbar calibrate` as a person meets them: what they print, write, and say of mistakes."""

import csv
import json
import math
import re
import shutil

import numpy as np
import pytest

import bench_curve
import sevenbar as sb
from command_runs import mistake, sevenbar
from places import EXAMPLES

BENCH = EXAMPLES / "rssr_bench.csv"


def rows(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def files(folder):
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_bench_curve_of_the_examples_is_the_one_its_program_makes():
    assert BENCH.read_text(encoding="utf-8") == bench_curve.text()


def test_table_1_is_one_command():
    run = sevenbar("compare", "rssr", EXAMPLES / "rssr_table1.csv")
    assert (run.returncode, run.stderr) == (0, "")
    told = [" ".join(line.split()) for line in run.stdout.splitlines()]
    for line in (
        "angle lowest [rad] -0.122185 -0.1266 -0.004415 -3.61 %",
        "angle range [rad] 1.31155 1.2652 -0.04635 -3.53 %",
        "velocity range [rad/s] 13.4052 12.9614 -0.4438 -3.31 %",
        "acceleration highest [rad/s²] 56.919 55.5197 -1.399 -2.46 %",
    ):
        assert line in told


def test_a_comparison_is_printed_written_and_told_as_json(tmp_path):
    options = ("--align", "phase,offset")
    out = tmp_path / "new" / "folder"
    run = sevenbar("compare", "rssr", BENCH, *options, "--out", out, "--figures", "svg")
    assert (run.returncode, run.stderr) == (0, f"writing {out} ..\n")
    for words in ("explained by  circuit 0, branch 0", "not by        circuit 1", "phase         1.2128°"):
        assert words in run.stdout
    assert set(files(out)) == {"comparison.json", "table.csv", "rows.csv", "comparison.svg"}
    report = json.loads(sevenbar("compare", "rssr", BENCH, *options, "--json").stdout)
    assert report == json.loads((out / "comparison.json").read_text(encoding="utf-8"))
    assert report["phase"] == pytest.approx(math.radians(1.2128), abs=1e-6)
    written = rows(out / "rows.csv")
    assert list(written[0]) == ["line", "input_rad", "angle_measured_rad", "angle_computed_rad"]
    assert len(written) == report["rows"] == bench_curve.ROWS
    # a row stands beside the value that the closed form has at its input
    computed = sb.load("rssr").output([float(row["input_rad"]) for row in written]).position[0]
    np.testing.assert_allclose([float(row["angle_computed_rad"]) for row in written], computed, atol=1e-13)
    apart = [float(row["angle_measured_rad"]) - float(row["angle_computed_rad"]) for row in written]
    assert report["differences"]["angle"]["rms"] == pytest.approx(
        math.sqrt(np.mean(np.square(apart))), rel=1e-9
    )
    lines = {row["value"]: row for row in rows(out / "table.csv")}
    assert float(lines["range"]["error"]) == pytest.approx(report["table"][0]["range"]["error"], rel=1e-12)


def test_a_calibration_is_printed_written_and_told_as_json(tmp_path):
    options = ("--offset", "input", "--offset", "output", "--hold", "D")
    run = sevenbar("calibrate", "rssr", BENCH, *options, "--out", tmp_path)
    assert (run.returncode, run.stderr) == (
        0,
        f"calibrating RSSR of Sun and Zhou ..\nwriting {tmp_path} ..\n",
    )
    assert "M, held at 700 mm: changes of L2, L3 would hide a change of it" in run.stdout
    names = {"calibrated.toml", "calibration.json", "parameters.csv", "rows.csv", "calibration.png"}
    assert set(files(tmp_path)) == names
    report = json.loads(sevenbar("calibrate", "rssr", BENCH, *options, "--json").stdout)
    assert report == json.loads((tmp_path / "calibration.json").read_text(encoding="utf-8"))
    found = {p["name"]: p for p in report["parameters"]}
    real = {name: getattr(bench_curve.REAL, name) for name in ("L1", "L2", "L3")}
    real |= {"input_offset": bench_curve.INPUT_ZERO, "output_offset": bench_curve.OUTPUT_ZERO}
    for name, value in real.items():
        assert found[name]["low"] <= value <= found[name]["high"]
    assert (found["D"]["status"], found["M"]["status"], found["M"]["low"]) == ("fixed", "unidentified", None)
    assert report["noise"]["angle"] == pytest.approx(bench_curve.NOISE, rel=0.15)
    linkage = sb.load(tmp_path / "calibrated.toml")
    assert linkage.dimensions["L1"] == found["L1"]["value"]
    assert linkage.name == sb.load("rssr").name
    again = json.loads(sevenbar("compare", tmp_path / "calibrated.toml", BENCH, "--align", "phase", "--align",
                                "offset", "--json").stdout)  # fmt: skip
    assert again["differences"]["angle"]["rms"] == pytest.approx(
        report["rms"]["angle"]["calibrated"], rel=1e-6
    )
    told = {row["parameter"]: row for row in rows(tmp_path / "parameters.csv")}
    assert told["input_offset"]["unit"] == "deg"
    assert float(told["input_offset"]["value"]) == pytest.approx(math.degrees(found["input_offset"]["value"]))


@pytest.mark.parametrize("command", ["compare", "calibrate"])
def test_nothing_is_overwritten_without_force(tmp_path, command):
    arguments = (command, "rssr", BENCH, "--out", tmp_path / "out")
    assert sevenbar(*arguments).returncode == 0
    (tmp_path / "out" / "mine.txt").write_text("keep")
    (tmp_path / "out" / "rows.csv").write_text("mine too")
    before = files(tmp_path)
    assert mistake(*arguments).endswith("exists already; give another path, or --force to replace it")
    assert files(tmp_path) == before
    assert sevenbar(*arguments, "--force").returncode == 0
    after = files(tmp_path)
    assert after["mine.txt"] == b"keep"
    assert after["rows.csv"] != b"mine too"
    assert set(after) == set(before)


@pytest.mark.parametrize("command", ["compare", "calibrate"])
def test_a_folder_that_cannot_be_made_leaves_nothing(tmp_path, command):
    (tmp_path / "taken").write_text("a file")
    assert "taken" in mistake(command, "rssr", BENCH, "--out", tmp_path / "taken" / "out")
    (tmp_path / "out" / "rows.csv").mkdir(parents=True)
    message = mistake(command, "rssr", BENCH, "--out", tmp_path / "out")
    assert "rows.csv: is a folder where a file should go" in message
    assert set(files(tmp_path)) == {"taken"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["compare", "rssr", "no.csv"], "no.csv: no such file; give the path of a table of measured values"),
        (["compare", "rssr", "empty.csv"], "empty.csv: is empty; give a table with a header and rows of numbers"),
        (
            ["calibrate", "rssr", "cut.csv"],
            "cut.csv: line 4: 1 cell where line 2 has 2; the file is cut or damaged there, or holds a second table: "
            "mend it",
        ),
        (
            ["compare", "rssr", "nan.csv"],
            "nan.csv: line 3: no number in column 'rocker [deg]' ('nan'); mend it, or leave such rows out with --skip-nan",
        ),
        (
            ["compare", "rssr", "unsorted.csv"],
            "unsorted.csv: line 4: time 0.1 after 0.2 in line 3; times must rise: sort the rows, and keep one run only",
        ),
        (
            ["compare", "rssr", "bare.csv"],
            "bare.csv: column 'time': has no unit; write it as in 'time [s]', or give --unit time=s",
        ),
        (
            ["compare", "rssr", "bare.csv", "--unit", "time=s", "--unit", "rocker=deg"],
            "--unit: 'rocker=deg' is not understood; give one of time, input, angle, velocity, acceleration and its unit, "
            "as in angle=deg",
        ),
        (
            ["compare", "rssr", "good.csv", "--align", "both"],
            "align: 'both' is not offered; give phase or offset",
        ),
        (["compare", "rssr", "good.csv", "--start", "3mm"],
         "--start: '3mm' is no value of crank, which turns; give 30, 30deg or 0.5rad"),
        (["compare", "rssr", "good.csv", "--output", "crank"],
         "output: joint 'crank' is the input; give another: rocker"),
        (["compare", "rssr", "good.csv", "--figures", "bmp"],
         "--figures: 'bmp' is not a figure format; give png, svg, pdf or eps"),
        (["compare", "rssr", "extremes.csv", "--align", "phase"],
         "--align: extremes.csv has lowest and highest values of a circuit, no rows; leave it out"),
        (["compare", "rssr", "extremes.csv", "--branch", "0"],
         "--branch: extremes.csv has lowest and highest values of a circuit, no rows; leave it out"),
        (["calibrate", "rssr", "extremes.csv"],
         "extremes.csv: lowest and highest values are too few to tell dimensions; give the measured rows"),
        (["calibrate", "rssr", "good.csv", "--free", "L4"],
         "free: no dimension 'L4'; this linkage has M, N, L1, L2, L3, D"),
    ],
)  # fmt: skip
def test_each_mistake_ends_with_its_message_and_writes_nothing(tmp_path, arguments, message):
    header = "time [s],rocker [deg]\n"
    for name, text in {
        "good": header + "0,0\n0.1,4\n0.2,30\n0.3,50\n",
        "empty": "",
        "cut": header + "0,0\n0.1,4\n0.2",
        "nan": header + "0,0\n0.1,nan\n0.2,30\n",
        "unsorted": header + "0,0\n0.2,4\n0.1,30\n",
        "bare": "time,rocker\n0,0\n0.1,4\n",
        "extremes": "quantity,lowest,highest\nangle [deg],-7,68\n",
    }.items():
        (tmp_path / f"{name}.csv").write_text(text)
    before = files(tmp_path)
    assert mistake(*arguments, "--out", "out", cwd=tmp_path) == message
    assert files(tmp_path) == before
    assert not (tmp_path / "out").exists()


def test_rows_without_numbers_are_left_out_where_asked(tmp_path):
    text = BENCH.read_text(encoding="utf-8").splitlines()
    text[20] = text[20].partition(",")[0] + ","
    (tmp_path / "gap.csv").write_text("\n".join(text))
    run = sevenbar("compare", "rssr", tmp_path / "gap.csv", "--skip-nan", "--json")
    report = json.loads(run.stdout)
    assert report["rows"] == bench_curve.ROWS - 1
    assert "1 rows without a number were left out" in report["notes"]


def test_circuits_that_a_page_does_not_list_are_counted(tmp_path):
    (tmp_path / "speeds.csv").write_text("quantity,lowest,highest\nvelocity [rad/s],-7,8\n")
    page = " ".join(sevenbar("compare", "seven_r", tmp_path / "speeds.csv").stdout.split())
    assert len(re.findall(r"circuit \d \(residual", page)) == 5
    assert "; 3 more residual:" in page


def test_a_table_of_another_program_is_compared_by_naming_its_columns(tmp_path):
    source = np.loadtxt(BENCH, delimiter=",", skiprows=4)
    np.savetxt(tmp_path / "ascii.txt", source)  # as save -ascii leaves it
    options = ("--column", "time=1", "--column", "angle=2", "--unit", "time=s", "--unit", "angle=deg")
    run = sevenbar("compare", "rssr", tmp_path / "ascii.txt", *options, "--json")
    assert run.returncode == 0, run.stderr
    named = json.loads(sevenbar("compare", "rssr", BENCH, "--json").stdout)
    assert json.loads(run.stdout)["differences"]["angle"]["rms"] == pytest.approx(
        named["differences"]["angle"]["rms"], rel=1e-12
    )


def test_a_linkage_of_a_file_keeps_its_comments_when_calibrated(tmp_path):
    shutil.copy(EXAMPLES / "rssr.toml", tmp_path / "mine.toml")
    with (tmp_path / "mine.toml").open("a", encoding="utf-8") as file:
        file.write(
            '\n[[point]]      # the middle of the coupler\nname = "middle"\nlink = 2\nat = [498, 0, 0]\n'
        )
    run = sevenbar("calibrate", "mine.toml", BENCH, "--free", "L1", "--out", "out", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    written = (tmp_path / "out" / "calibrated.toml").read_text(encoding="utf-8")
    assert "[[point]]      # the middle of the coupler" in written
    assert sb.loads(written).points[-1] == sb.load(tmp_path / "mine.toml").points[-1]
