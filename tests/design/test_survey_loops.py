"""Surveys of any loop: what is said of a linkage is what the analysis has, however the work is divided."""

import json
import math
from functools import reduce
from operator import add

import numpy as np
import pytest

import sevenbar as sb
from command_runs import killed, mistake, sevenbar
from sevenbar.description.draft import Draft
from sevenbar.design.survey import LoopSurvey, survey
from sevenbar.design.survey.journal import JOURNAL
from sevenbar.design.task import DesignTask, FigureMust, FreeNumber, FunctionWant, InRange, Most, read_task

TASK = """
linkage = "rscr"
[free]
"ball.[xy]" = "-40:60"
"cylinder.[xyz]" = "40:160"
[[want]]
kind = "function"
pairs = [[0, 0], [20, 3], [40, 12], [60, 27], [80, 40]]
[[must]]
kind = "most"
want = 1
most = "20deg"
"""


@pytest.fixture
def task_file(tmp_path):
    path = tmp_path / "task.toml"
    path.write_text(TASK, encoding="utf-8")
    return path


def about(name: str, spread: float, *musts) -> DesignTask:
    """A task whose want the linkage of the gallery meets itself, its lengths free within a spread."""
    linkage = sb.load(name)
    draft = Draft.of_linkage(linkage)
    free = [
        FreeNumber(d.name, d.value - spread, d.value + spread)
        for d in draft.dimensions
        if d.kind == "length" and d.place[0] != "point" and (name, d.name[:3]) != ("planar_4r", "off")
    ]
    rows = linkage.motion(72).circuits[0]
    return DesignTask(draft, tuple(free), (FunctionWant(rows.input[4:20:3], rows.output[4:20:3]),), musts)


@pytest.mark.parametrize("name", ["seven_r", "rscr", "rssr", "planar_4r", "rsur"])
def test_linkages_next_to_one_that_does_it_do_it_nearly(name):
    spread = 1e-3
    tally = LoopSurvey(about(name, spread, Most(0, 0.01)), 6).tally(0)
    assert tally.found == tally.count == 6
    assert 0 < tally.best[0].error <= tally.best[-1].error < spread
    assert sum(tally.types.values()) == sum(tally.limits.values()) == 6


def test_each_verdict_is_that_of_the_analysis():
    task = about("rscr", 40.0, InRange("rocker", -2.0, 2.0), FigureMust("swing", least=60.0))
    asked = LoopSurvey(task, 40, 5)
    tally = asked.tally(0)
    swings = []
    for values in asked.values(0, 40):
        named = dict(zip(task.names, map(float, values), strict=True))
        motion = task.draft.with_values(named).linkage.motion(72)
        swings.append([c.swing for c in motion.circuits if c.swing is not None])
    most = max(math.degrees(max(own)) for own in swings if own)
    assert tally.count == 40
    assert tally.verdicts["figure"] or tally.verdicts["range"]
    # of what is kept the swing is one that the analysis has
    counts = tally.spreads["swing"][1]
    assert 0 <= max(np.flatnonzero(counts)) * 10 <= most


def test_the_answer_is_the_same_however_the_work_is_divided(tmp_path, monkeypatch):
    whole = LoopSurvey(about("planar_4r", 30.0, Most(0, 0.05)), 60, 2).tally(0)
    monkeypatch.setattr(LoopSurvey, "part_size", 25)
    asked = LoopSurvey(about("planar_4r", 30.0, Most(0, 0.05)), 60, 2)
    tallies = [asked.tally(part) for part in range(3)]
    for order in ((0, 1, 2), (2, 0, 1)):
        assert reduce(add, (tallies[part] for part in order)).line() == whole.line()
    first = survey(asked, designs_wanted=0, threads=1, out=tmp_path / "a")
    assert first.tally.line() == whole.line()
    assert 0 < whole.found < 60
    journal = tmp_path / "a" / JOURNAL
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(lines[0] + lines[1][:9])
    again = survey(asked, designs_wanted=0, threads=1, out=tmp_path / "a", resume=True)
    assert again.tally.line() == whole.line()


def test_two_processes_give_the_answer_of_one_and_a_killed_run_goes_on(tmp_path, task_file):
    asked = LoopSurvey(read_task(task_file), 600)
    words = ["design", "survey", str(task_file), "--count", "600", "--threads", "2"]
    journal = tmp_path / "a" / JOURNAL
    killed(
        *words, "--journal", tmp_path / "a", once=lambda: journal.exists() and b"\n" in journal.read_bytes()
    )
    again = survey(asked, designs_wanted=0, out=tmp_path / "a", resume=True, threads=2)
    assert again.tally.line() == survey(asked, designs_wanted=0, threads=1).tally.line()


def test_designs_are_better_than_what_was_drawn():
    found = survey(LoopSurvey(about("planar_4r", 20.0, Most(0, 0.2)), 40, 1), designs_wanted=1, threads=1)
    assert found.found is not None
    (design,) = found.found.designs
    assert design.met[0].greatest < 1e-9 < found.tally.best[0].error
    assert found.answer == f"{found.tally.found} of 40 do it"


def test_that_none_does_it_is_an_answer_with_what_comes_nearest(task_file):
    text = (
        TASK.replace('most = "20deg"', 'most = "0.001deg"').replace("ball.[xy]", "ball.x").replace("z]", "y]")
    )
    task_file.write_text(text.replace("cylinder.[xyy]", "cylinder.x"), encoding="utf-8")
    words = ["design", "survey", task_file, "--count", "20", "--designs", "1", "--threads", "1"]
    run = sevenbar(*words)
    assert run.returncode == 0, run.stderr
    for part in ("none of 20 does it", "musts lack", "linkage", "error:"):
        assert part in run.stdout
    plain = json.loads(sevenbar(*words, "--json").stdout)
    assert plain["survey"]["tally"]["verdicts"]["found"] == 0
    assert plain["designs"] == []


def test_a_survey_of_a_task_is_written(task_file, tmp_path):
    words = ["--count", "20", "--designs", "1", "--threads", "1", "--out", tmp_path / "out"]
    run = sevenbar("design", "survey", task_file, *words)
    assert run.returncode == 0, run.stderr
    assert "20 linkages, seed 0" in run.stdout
    assert sb.load(tmp_path / "out" / "design_1.toml").motion().circuits
    assert "answer: " in (tmp_path / "out" / "design_1.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--y", "x^2"], "--y: is of an RSSR"),
        (["--bound", "L1=1:2"], "--bound: is of an RSSR"),
        (["--count", "2e9"], "is not a number of linkages; give 1 to 1073741824"),
        (["--resume"], "--resume: of no folder"),
    ],
)
def test_what_does_not_fit_a_task_is_refused_before_long_work(task_file, words, says):
    assert says in mistake("design", "survey", task_file, *words)
