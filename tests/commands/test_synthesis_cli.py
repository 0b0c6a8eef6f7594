"""`sevenbar design function` and `sevenbar design swing` as a person meets them."""

import csv
import json
import math
import re
import sys

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from places import EXAMPLES
from sevenbar.commands.given import numbers
from sevenbar.design.synthesis.function import generation, swing
from sevenbar.design.synthesis.function.generation import USUAL, Synthesis
from sevenbar.design.wish import wish_of_pairs
from sevenbar.errors import RequestError

PAIRS = "input_deg,output_deg\n0,0\n20,31\n40,50\n60,64\n"


def test_a_function_is_printed_written_and_told_as_json(tmp_path):
    out = tmp_path / "new" / "folder"
    words = ("design", "function", "--y", "x^2", "--points", "7", "--designs", "2")
    run = sevenbar(*words, "--out", out, "--figures", "svg")
    assert (run.returncode, run.stderr) == (0, f"searching RSSRs for y = x^2 ..\nwriting {out} ..\n")
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


def test_pairs_of_a_table_are_met(tmp_path):
    table = tmp_path / "pairs.csv"
    table.write_text(PAIRS, encoding="utf-8")
    run = sevenbar("design", "function", "--table", table, "--designs", "1", "--json")
    (design,) = json.loads(run.stdout)["designs"]
    assert design["error_greatest_deg"] < 1e-10


def test_a_swing_is_printed_and_written(tmp_path):
    out = tmp_path / "out"
    run = sevenbar(
        "design", "swing", "--swing", "60deg", "--time-ratio", "1.2", "--designs", "1", "--out", out
    )
    assert (run.returncode, run.stderr) == (
        0,
        f"searching crank-rockers with a swing of 60deg ..\nwriting {out} ..\n",
    )
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
            "--x: '1-2' is not a range; give two values, as in 0:1, 0:pi/2 or 0:90deg",
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
        (("function", "--y", "x", "--seed", "-1"), "--seed: -1 is not a seed; give 0 or more"),
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


@pytest.mark.parametrize(
    ("text", "low", "high"),
    [
        ("0:90deg", 0.0, math.pi / 2),
        ("0:90\u00b0", 0.0, math.pi / 2),
        ("-30deg..0.5rad", -math.pi / 6, 0.5),
        ("0:pi/2", 0.0, math.pi / 2),
        ("-pi:2*pi", -math.pi, math.tau),
        ("1:10", 1.0, 10.0),
        ("0.1:2.6", 0.1, 2.6),
        ("sqrt(2):1e2", math.sqrt(2), 100.0),
    ],
)
def test_a_range_of_x_may_have_a_unit_or_be_a_formula(text, low, high):
    assert numbers("--x", text) == pytest.approx((low, high), rel=1e-15)


@pytest.mark.parametrize("text", ["0:90mm", "0:x", "0:1/0", "0:", "a:b", "0:__import__('os')", "0:1:2"])
def test_a_range_of_x_that_is_none_is_refused(text):
    with pytest.raises(RequestError, match=r"--x: .* is not a range; give two values, as in 0:1, 0:pi/2 or"):
        numbers("--x", text)


def test_degrees_are_not_taken_twice():
    told = mistake("design", "function", "--y", "sind(x)", "--x", "0:90deg")
    assert told == (
        "--x: '0:90deg' counts in radians, and sind takes degrees; write sin, or leave the unit of x out"
    )


@pytest.mark.parametrize(("y", "x"), [("sin(x)", "0:90deg"), ("sind(x)", "0:90"), ("sin(x)", "0:pi/2")])
def test_a_sine_of_degrees_is_found(y, x, tmp_path):
    out = tmp_path / "out"
    run = sevenbar("design", "function", "--y", y, "--x", x, "--designs", "1", "--out", out)
    assert run.returncode == 0, run.stderr
    (design,) = json.loads((out / "summary.json").read_text(encoding="utf-8"))["designs"]
    assert design["error_greatest_deg"] < 0.003
    # as the written file says, it is used: the sine comes out at the rocker
    text = (out / "design_1.toml").read_text(encoding="utf-8")
    assert "# readings: input 0 to 90 deg for x from 0 to " in text
    zero = {side: float(re.search(rf"# {side}_zero_deg = (\S+)", text)[1]) for side in ("input", "output")}
    linkage = sb.load(out / "design_1.toml")
    for reading in (0.0, 17.5, 30.0, 90.0):
        rockers = np.degrees(linkage.output([math.radians(zero["input"] + reading)]).position[:, 0])
        wanted = 90 * math.sin(math.radians(reading))
        off = (rockers - zero["output"] - wanted + 180) % 360 - 180
        assert np.abs(off).min() < 0.003


def test_a_sine_of_degrees_taken_for_radians_is_hinted_at(monkeypatch):
    # each of the fits takes seconds, and of sixteen all end alike
    monkeypatch.setattr(generation, "FITTED_LEAST", 2)
    monkeypatch.setattr(generation, "FITTED_EACH", 2)
    told = mistake("design", "function", "--y", "sin(x)", "--x", "0:90", "--designs", "1")
    assert "sin takes radians; x goes to 90: write sind(x) or x = 0:90deg if these are degrees" in told
    assert told.index("sin takes radians") < told.index("searching RSSRs")
    for way in ("a smaller least transmission angle", "a greater tolerance", "a narrower range of the input"):
        assert way in told


def test_a_search_in_which_nothing_closes_says_that_its_limit_led_it():
    wish = wish_of_pairs(np.radians([0, 10, 20, 30, 40]), np.radians([0, 3, 9, 20, 35]), title="pairs")
    nothing = Synthesis((), wanted="pairs", limits=USUAL, searched=16384, fitted=16, seed=0, wish=wish)
    with pytest.raises(
        RequestError, match=r"none closes .* try a smaller least transmission angle \(0 for none\)"
    ):
        nothing.required()


STOPPED = """
import sevenbar.design.synthesis.function.generation as module
own, seen = module.least_error, []
def interrupted(kept):
    seen.append(len(kept))
    if len(seen) == {calls}:
        raise KeyboardInterrupt
    return own(kept)
module.least_error = interrupted
"""


def test_ctrl_c_leaves_the_best_so_far_and_says_so(tmp_path):
    words = ("design", "function", "--y", "x^2", "--designs", "5", "--out", "out")
    run = sevenbar(*words, cwd=tmp_path, before=STOPPED.format(calls=3))
    assert run.returncode == 130, run.stderr
    assert "unfinished  stopped after 3 of 21 steps; these are the best so far" in " ".join(
        run.stdout.split("\n")
    )
    text = (tmp_path / "out" / "design_1.toml").read_text(encoding="utf-8")
    assert "# unfinished: stopped after 3 of 21 steps; these are the best so far" in text
    assert json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["unfinished"]
    # figures would take longer than the half second in which a command ends
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".toml", ".csv", ".json"}
    assert run.stderr.splitlines()[-1] == "figures are left out: the search was stopped"


def test_ctrl_c_before_anything_is_found_leaves_nothing(tmp_path):
    words = ("design", "function", "--y", "sin(x)", "--x", "0:90", "--out", "out")
    run = sevenbar(*words, cwd=tmp_path, before=STOPPED.format(calls=2))
    assert run.returncode == 130
    assert run.stderr.splitlines()[-1] == "sevenbar: stopped; nothing is written"
    assert (run.stdout, list(tmp_path.iterdir())) == ("", [])


def test_a_wish_that_cannot_be_met_writes_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(swing, "FITTED_LEAST", 4)
    told = mistake("design", "swing", "--swing", "340", "--designs", "1", "--out", "out", cwd=tmp_path)
    told = told.splitlines()[-1].removeprefix("sevenbar: ")
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


def test_without_scipy_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    examples = EXAMPLES
    task = examples / "design" / "steering_task.toml"
    curve = examples / "coupler_curve.csv"
    for asked in (
        ("function", "--y", "x^2"),
        ("task", task),
        ("path", "planar_4r", "--path", curve, "--link", 2, "--at", "0,-50,20"),
    ):
        told = mistake("design", *asked)
        assert told == "design needs scipy and tomlkit; install them with: pip install 'sevenbar[design]'"
