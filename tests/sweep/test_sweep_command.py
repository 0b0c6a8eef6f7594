"""The command `sevenbar sweep` as a person calls it."""

from __future__ import annotations

import contextlib
import io
import json
import re
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from command_runs import mistake, sevenbar
from places import DOCS
from sevenbar.kinematics.measures import MEASURES


def test_a_sweep_prints_what_it_found_and_where_it_is(tmp_path: Path) -> None:
    run = sevenbar(
        "sweep", "rssr", "--over", "L1=200:600:5", "--over", "L3=400,45cm", "--measure", "motion_type,swing",
        "--out", "found", cwd=tmp_path,
    )  # fmt: skip
    assert run.returncode == 0
    lines = [" ".join(line.split()) for line in run.stdout.splitlines()]
    rows = pq.read_table(tmp_path / "found" / "part-000000.parquet").to_pylist()
    types = {row["linkage"]: row["motion_type"] for row in rows}
    swings = [(row["swing_deg"], row["linkage"]) for row in rows if row["swing_deg"] is not None]
    assert lines[0] == f"10 linkages (grid), {len(rows)} rows"
    for word in set(types.values()):
        count = list(types.values()).count(word)
        assert f"{word} {count} {100 * count / 10:.3g} %" in lines
    (low, first), (high, last) = min(swings), max(swings)
    assert f"swing_deg {low:.6g} {first} {high:.6g} {last} {len(swings)}" in lines
    assert lines[-1] == "written: found (sweep.json, 1 part)"
    again = sevenbar(
        "sweep", "rssr", "--over", "L1=200:600:5", "--over", "L3=400,45cm", "--measure", "motion_type,swing",
        "--out", "found", cwd=tmp_path,
    )  # fmt: skip
    assert again.stdout == run.stdout.replace("written:", "there already:")


def test_the_summary_in_json_has_the_description_and_the_totals() -> None:
    run = sevenbar("sweep", "rssr", "--over", "L1=200..600", "--count", "64", "--seed", "5", "--json")
    found = json.loads(run.stdout)
    assert found["sampling"] == {"method": "sobol", "count": 64, "seed": 5}
    assert sum(found["totals"]["words"]["motion_type"].values()) == found["totals"]["linkages"] == 64


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], "over: no dimension is given; give one or more, as in L1=200:300:51"),
        (
            ["--over", "L1"],
            "over: 'L1' names no values; give a name and LOW:HIGH:COUNT, a list V1,V2,V3, or LOW..",
        ),
        (
            ["--over", "L9=1,2"],
            "dimension: 'L9' is not a dimension of 'rssr'; give one of M, N, L1, L2, L3, D, ",
        ),
        (["--over", "L1=1", "--over", "L1=2"], "over: dimension 'L1' is given twice; leave one out"),
        (
            ["--over", "L1=300:200:5"],
            "L1: 300 to 200 is an empty range; give a low end below the high one, or",
        ),
        (["--over", "L1=1..2"], "count: missing; a sobol sample needs one, as in 1000"),
        (
            ["--over", "L1=1..2", "--count", "100001"],
            "out: missing; 100001 linkages are too many to be made for",
        ),
        (
            ["--over", "L1=1:2:5", "--measure", "swin"],
            "measure: 'swin' is not a measure; did you mean 'swing'? ",
        ),
        (["--over", "L1=1:2:5", "--threads", "0"], "threads: 0 is not a count of threads; give 1 to 4096"),
        (
            ["--over", "L1=1:2:5", "--input", "ball_a"],
            "input: joint 'ball_a' is a ball; give a joint with one ",
        ),
    ],
)
def test_a_mistake_is_one_line(given: list[str], message: str) -> None:
    told = mistake("sweep", "rssr", *given)
    assert told.startswith(message)
    assert "\n" not in told


def test_a_folder_with_parts_is_gone_on_with_where_that_is_asked_for(tmp_path: Path) -> None:
    sweep = ["sweep", "rssr", "--over", "L1=200:600:9", "--part-size", "2", "--out", "found"]
    assert sevenbar(*sweep, cwd=tmp_path).returncode == 0
    (tmp_path / "found" / "part-000003.parquet").unlink()
    assert mistake(*sweep, cwd=tmp_path) == (
        "found: 4 of 5 parts are there; give --resume to go on, or another folder"
    )
    run = sevenbar(*sweep, "--resume", cwd=tmp_path)
    assert run.stdout.endswith("written: found (sweep.json, 5 parts)\n")
    assert mistake(*sweep[:-4], "--part-size", "3", "--out", "found", cwd=tmp_path) == (
        "found: holds another sweep: part_size is 2 there and 3 here; give another folder, or the options of that sweep"
    )


def test_the_page_on_sweeps_shows_what_the_program_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (DOCS / "sweep.md").read_text(encoding="utf-8")
    first, second = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(first, {"__name__": "page"})
    assert printed.getvalue().splitlines() == re.findall(r"print\(.*\)  # (.*)", first)
    told = page[page.index("## What is measured") :]
    assert set(re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`.*?) \|", told, re.MULTILINE)))) >= set(
        MEASURES
    )
    monkeypatch.chdir(tmp_path)
    sweep = ["sweep", "rssr", "--over", "L1=200..600", "--count", "20", "--out", "crank_rockers"]
    assert sevenbar(*sweep).returncode == 0
    exec(second, {})
