"""`sevenbar design function` and `sevenbar design swing` as a person meets them."""

import csv
import json

import pytest

import sevenbar as sb
from commands import mistake, sevenbar

PAIRS = "input_deg,output_deg\n0,0\n20,31\n40,50\n60,64\n"


def test_a_function_is_printed_written_and_told_as_json(tmp_path):
    out = tmp_path / "new" / "folder"
    words = ("design", "function", "--y", "x^2", "--points", "7", "--designs", "2")
    run = sevenbar(*words, "--out", out, "--figures", "svg")
    assert (run.returncode, run.stderr) == (0, "")
    for told in ("wanted    y = x^2", "transmission angle >= 30 deg", "L1 [mm]"):
        assert told in run.stdout
    names = {path.name for path in out.iterdir()}
    assert names == {"design_1.toml", "design_1.svg", "summary.csv", "summary.json"}
    report = json.loads(sevenbar(*words, "--json").stdout)
    assert report == json.loads((out / "summary.json").read_text(encoding="utf-8"))
    with (out / "summary.csv").open(encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert float(row["error_greatest_deg"]) == report["designs"][0]["error_greatest_deg"] < 0.0054
    assert "# made by: sevenbar design function --y 'x^2'" in (out / "design_1.toml").read_text(
        encoding="utf-8"
    )
    assert sb.load(out / "design_1.toml").dimensions["L1"] == report["designs"][0]["L1_mm"]
    again = mistake(*words, "--out", out)
    assert again.endswith("exists already; give another path, or --force to replace it")


@pytest.mark.slow
def test_pairs_of_a_table_are_met(tmp_path):
    table = tmp_path / "pairs.csv"
    table.write_text(PAIRS, encoding="utf-8")
    run = sevenbar("design", "function", "--table", table, "--designs", "1", "--json")
    (design,) = json.loads(run.stdout)["designs"]
    assert design["error_greatest_deg"] < 1e-10


@pytest.mark.slow
def test_a_swing_is_printed_and_written(tmp_path):
    out = tmp_path / "out"
    run = sevenbar(
        "design", "swing", "--swing", "60deg", "--time-ratio", "1.2", "--designs", "1", "--out", out
    )
    assert (run.returncode, run.stderr) == (0, "")
    assert {path.name for path in out.iterdir()} == {
        "design_1.toml",
        "design_1.png",
        "summary.csv",
        "summary.json",
    }
    circuits = sb.load(out / "design_1.toml").motion().circuits
    assert min(abs(circuit.time_ratio - 1.2) for circuit in circuits) < 1e-9


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("function",),
            "--y: give a function, as in --y 'x^2', or pairs of angles by --table; one of the two",
        ),
        (
            ("function", "--y", "foo(x)"),
            "y: 'foo(x)': no function 'foo' is known; give a function of x, as in",
        ),
        (
            ("function", "--y", "x", "--x", "1-2"),
            "--x: '1-2' is not a range; give two values, as in 0:1 or 1:10",
        ),
        (
            ("function", "--y", "x", "--input-range", "0:90furlong"),
            "--input-range: '0:90furlong' is not a range",
        ),
        (
            ("function", "--y", "x", "--points", "2"),
            "points: 2 precision points are not offered; give 3 to 7",
        ),
        (("function", "--y", "x", "--transmission", "95"), "transmission: 95 deg is no limit"),
        (
            ("function", "--y", "x", "--size", "9"),
            "--size: '9' is not a range; give two values, as in 50:1000",
        ),
        (("function", "--y", "x", "--motion-type", "crank"), "motion type: 'crank' is not offered"),
        (("function", "--y", "x", "--designs", "0"), "--designs: 0 designs are not offered; give 1 to 50"),
        (("function", "--y", "x", "--seed", "-1"), "--seed: -1 is no seed; give a number >= 0"),
        (("function", "--y", "x", "--tolerance", "little"), "--tolerance: 'little' is not an angle"),
        (
            ("function", "--table", "none.csv"),
            "none.csv: no such file; give the path of a table of pairs of angles",
        ),
        (("swing", "--swing", "60", "--time-ratio", "0.5"), "time ratio: 0.5 is not offered"),
        (("swing", "--swing", "none"), "--swing: 'none' is not an angle; give one as in 30, 30deg or 0.5rad"),
    ],
)
def test_a_mistake_is_told_in_a_line_and_nothing_is_written(words, message, tmp_path):
    told = mistake("design", *words, "--out", "out", cwd=tmp_path)
    assert told.startswith(message)
    assert "\n" not in told
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_wish_that_cannot_be_met_writes_nothing(tmp_path):
    told = mistake("design", "swing", "--swing", "340", "--designs", "1", "--out", "out", cwd=tmp_path)
    assert told.startswith("design: no linkage found for swing 340 deg, time ratio 1")
    assert "nearest: swing" in told
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n0,0\n20,31\n40,50\n", "column 'a': has no unit; write it as in 'a [deg]'"),
        (
            "input_deg,output_mm\n0,0\n20,31\n40,50\n",
            "column 'output_mm': 'mm' is not a unit of the angle; give one like deg",
        ),
        ("input_deg,output_deg,c\n0,0,0\n20,31,0\n", "3 columns; give two"),
        ("input_deg,output_deg\n0,0\n20,\n40,50\n", "no number in column 'output_deg'"),
    ],
)
def test_a_wrong_table_is_told_with_its_place(text, message, tmp_path):
    table = tmp_path / "pairs.csv"
    table.write_text(text, encoding="utf-8")
    assert message in mistake("design", "function", "--table", table)


@pytest.mark.slow
def test_without_scipy_the_extra_is_named():
    hide = "import sys; sys.modules['scipy.optimize'] = None"
    told = mistake("design", "function", "--y", "x^2", before=hide)
    assert told == "design needs scipy and tomlkit; install them with: pip install 'sevenbar[design]'"
