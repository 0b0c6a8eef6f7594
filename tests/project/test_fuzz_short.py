"""A short run of hard use, and that its watch sees what goes wrong: what `make fuzz` does by the million.

Source: `fuzz.checks` say what must hold; here they are also shown cases that must break them.
"""

from __future__ import annotations

import dataclasses
import json
import math
import os
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import sevenbar as sb
from evidence.fuzz import batches, checks, files, loops, messages, page, rssrs, summary, watch, ways, wild
from evidence.fuzz.tally import Finding, Tally
from evidence.fuzz.toml import written
from sevenbar.description import gallery
from sevenbar.description.forms import from_description
from sevenbar.errors import RequestError

#: Cases of each way: of loops three of each family, of their edges four, of RSSRs ten.
CASES = {
    "rssr batch": 24_000,
    "loop batch": 160,
    "rssr": 70,
    "loop": 63,
    "edge": 32,
    "screw": 2,
    "file": 3000,
    "table": 400,
}

#: A seed of its own, so that CI meets other cases than `make fuzz`.
SEED = 21


@pytest.mark.parametrize("way", list(ways.WAYS))
def test_nothing_is_found(way: str) -> None:
    count, size = CASES[way], ways.WAYS[way].size
    tally = Tally()
    for first in range(0, count, size):
        job = ways.Job(way, SEED, first, min(first + size, count))
        tally.merge(ways.run(job, lambda _: None).plain())
    assert tally.cases == count
    assert [finding.what for finding in tally.findings] == []
    # the cases are not all of one kind
    assert len(tally.seen) > 3


@pytest.mark.parametrize("way", list(ways.WAYS))
def test_a_case_follows_from_its_seed_and_number_alone(way: str) -> None:
    content = ways.WAYS[way].content
    assert content(5, 17) == content(5, 17)
    assert len({str(content(5, k)) for k in range(12)}) > 6
    assert content(5, 17) != content(6, 17)


def test_a_description_is_written_without_losing_a_digit() -> None:
    rng = np.random.default_rng(3)
    for draw in loops.FAMILIES.values():
        description = draw(rng)
        try:
            want = from_description(description).transforms
        except sb.errors.SevenbarError:
            continue
        np.testing.assert_array_equal(sb.loads(written(description)).transforms, want)


@pytest.mark.parametrize("name", gallery.loops())
def test_the_gallery_holds_what_must_hold(name: str) -> None:
    assert (
        checks.judged(sb.load(name), np.random.default_rng(1), Counter())
        == sb.load(name).motion(24).motion_type
    )


def broken(circuit: sb.Circuit, **changes: object) -> list[str]:
    motion = sb.load("seven_r").motion(24)
    try:
        checks.of_circuit(motion, dataclasses.replace(circuit, **changes))
    except checks.Broken as told:
        return [str(told)]
    return []


def test_what_must_hold_can_break() -> None:
    circuit = sb.load("seven_r").motion(24).circuits[0]
    assert broken(circuit) == []
    rates = circuit.dddq.copy()
    rates[3, 2] = np.nan
    assert broken(circuit, dddq=rates) == [
        "dddq: 1 numbers missing or infinite in rows whose status promises them"
    ]
    assert "closure error" in broken(circuit, residual=circuit.residual + 1e-6)[0]
    assert "times" in broken(circuit, time=-circuit.time)[0]
    assert "type" in broken(circuit, motion_type="double-winch")[0]
    assert "range" in broken(circuit, input_range=(0.0, 1.0))[0]
    assert circuit.velocity is not None
    lower = dataclasses.replace(circuit.velocity, highest=0.5 * circuit.velocity.highest)
    assert "above its extreme" in broken(circuit, _velocity=lower)[0]


def test_motions_that_contradict_themselves_break() -> None:
    motion = sb.load("rssr").motion(24, input="rocker")
    checks.of_motion(motion)
    for changes, told in (
        ({"limits": motion.limits[::-1]}, "do not rise"),
        ({"limits": motion.limits + 6.2}, "outside a turn"),
        ({"limits": np.array([])}, "0 limits"),
        ({"motion_type": "rigid"}, "rigid with circuits"),
        ({"motion_type": "double-crank"}, "double-crank of circuits"),
        ({"circuits": ()}, "without a circuit"),
    ):
        with pytest.raises(checks.Broken, match=told):
            checks.of_motion(dataclasses.replace(motion, **changes))
    with pytest.raises(checks.Broken, match="in common"):
        checks.circuits_are_distinct(dataclasses.replace(motion, circuits=motion.circuits[:1] * 2))
    motion = sb.load("planar_4r").motion(checks.SAMPLES)
    modes = motion.linkage.assembly_modes(math.tau / checks.SAMPLES)
    checks.modes_are_on_circuits(motion, modes)
    with pytest.raises(checks.Broken, match="1 of 2 modes lie on no circuit"):
        checks.modes_are_on_circuits(dataclasses.replace(motion, circuits=motion.circuits[:1]), modes)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "empty"),
        ("f.toml: rssr.M: 3 is wrong.", "full stop"),
        ("rssr.M: 3 is not a number", "without the file's name"),
        ("f.toml: rssr.M: Input should be a valid number", "words for programmers"),
        ("f.toml: \x1b[1m is not a number", "not printed"),
        ("f.toml: " + "x" * 900, "characters in a message"),
    ],
)
def test_a_message_that_helps_nobody_is_found(text: str, told: str) -> None:
    with pytest.raises(checks.Broken, match=told):
        messages.look_at(RequestError(text), "f.toml")


def test_messages_of_one_kind_are_one_family() -> None:
    errors = [
        RequestError(f"f.toml: rssr.{key}: {value!r} is not a number; give a number")
        for key, value in (("M", "7"), ("L1", "x y"))
    ]
    assert {messages.family(error, "f.toml") for error in errors} == {"~ is not a number"}


# The watch


def test_a_worker_that_dies_or_hangs_costs_its_case_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(ways.WAYS, "file", dataclasses.replace(ways.WAYS["file"], limit=5.0))
    heard: list[tuple[ways.Job, Tally]] = []
    run = watch.Watch(lambda job, tally, _: heard.append((job, tally)), threads=1)
    monkeypatch.setattr(watch, "_work", _faulty_work)
    run.over([ways.Job("file", 1, 0, 20)])
    found = {finding.index: finding.what for _, tally in heard for finding in tally.findings}
    assert found == {7: "died with 3", 12: "took longer than 5 s"}
    # every case came back, and once
    assert sum(tally.cases for _, tally in heard) == 20
    assert sorted(k for job, _ in heard for k in range(job.first, job.last)) == list(range(20))
    assert run.lost == 4


def _faulty_work(jobs: object, slot: list[float]) -> None:
    """A worker for which case 7 ends the process and case 12 never ends."""
    while (job := jobs.recv()) is not None:  # type: ignore[attr-defined]
        _, _, first, last = job
        for index in range(first, last):
            slot[1], slot[0] = index, time.monotonic()
            if index == 7:
                os._exit(3)
            while index == 12:
                time.sleep(0.01)
        slot[1] = watch.NOTHING
        jobs.send((Tally(cases=last - first).plain(), 1))  # type: ignore[attr-defined]


def test_a_batch_that_takes_the_process_with_it_is_halved_until_one_case_is_left() -> None:
    heard: list[tuple[ways.Job, Tally]] = []
    run = watch.Watch(lambda job, tally, _: heard.append((job, tally)), threads=1)
    blamed = [ways.Job("rssr batch", 1, 0, 64)]
    while blamed:
        job = blamed.pop()
        if not job.first <= 41 < job.last:
            continue
        run._blame(job, -1, "died with -11")
        blamed = list(run._jobs)
        run._jobs.clear()
    ((job, tally),) = heard
    assert (job.first, tally.findings[0].index) == (41, 41)
    assert sb.loads(tally.findings[0].content.partition("\n")[2]).kind == "RSSR"


# A run and its page


def test_a_run_that_was_stopped_goes_on_and_comes_to_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(summary, "JOURNALS", tmp_path)
    monkeypatch.setattr(summary, "ROOT", tmp_path)
    first = summary.Run(linkages=100, files=900, seed=3, threads=1)
    assert sum(first.counts().values()) == 1000
    first.go(lambda _: None)
    lines = first.journal.read_text().splitlines()
    # the journal of a run that was stopped in the middle of a line
    first.journal.write_text("\n".join(lines[:2]) + "\n" + lines[2][:40])
    again = summary.Run(linkages=100, files=900, seed=3, threads=1)
    told: list[str | None] = []
    again.go(told.append)
    assert told[0] is not None
    assert told[0].startswith("2 jobs are done already")
    for way, tally in first.tallies.items():
        assert again.tallies[way].cases == tally.cases == first.counts()[way]
        assert again.tallies[way].seen == tally.seen
    # one way anew, as after a change of what it looks at
    monkeypatch.setattr(summary, "commit", lambda: "later")
    anew = summary.Run(linkages=100, files=900, seed=3, threads=1)
    anew.forget(["rssr"])
    anew.go(lambda _: None)
    assert anew.tallies["rssr"].cases == first.counts()["rssr"]
    assert {way for way, commits in anew.commits.items() if commits == {"later"}} == {"rssr"}
    assert "later" not in anew.commits["file"]
    assert "`rssr` at commit later." in page.written(anew.plain() | {"commit": "now"})


def test_the_page_tells_what_the_summary_counts() -> None:
    run = summary.Run(linkages=10, files=10, seed=3, threads=1)
    for way, count in run.counts().items():
        tally = Tally(cases=count, seen=Counter({"type rigid": count, "refused ~ is text": 2}))
        tally.add(Finding(way, 1, f"{way} went wrong 3 times", "", ""))
        row = {"commit": "abc", "tally": tally.plain(), "peak": 5_000_000, "seconds": 60.0}
        run.take(ways.Job(way, 3, 0, count), json.loads(json.dumps(row)))
    told = page.written(run.plain())
    assert f"{len(run.counts())} minutes" in told
    for way, count in run.counts().items():
        assert f"| {way} | {count} | 1 |" in told
    assert "| screw | screw went wrong times | 1 |" in told
    assert "5 MB" in told
    assert set(page.TOLD) == set(ways.WAYS)


def test_a_finding_is_kept_and_judged_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(summary, "FINDINGS", tmp_path)
    for way, content in (("file", "bytes:\xff\xfe = \x00"), ("rssr", written(rssrs.description(np.ones(6))))):
        kept = summary.keep(vars(Finding(way, 4, "what", "", content)), 9)
        found = Finding(
            **{key: value for key, value in json.loads(kept.read_text()).items() if key != "seed"}
        )
        assert found.content == content
        assert ways.again(found).findings == []


def test_batches_that_contradict_the_motion_are_found() -> None:
    linkage = sb.load("seven_r")
    motions = batches.of_loops([linkage])
    batches.loop_crossed(linkage, motions, 0)
    for changes in ({"circuits": motions.circuits + 1}, {"types": np.array(["rigid"], object)}):
        with pytest.raises(checks.Broken):
            batches.loop_crossed(linkage, dataclasses.replace(motions, **changes), 0)


@pytest.mark.filterwarnings("ignore::sevenbar.errors.AngleUnitWarning")
def test_mutations_reach_every_stage_of_the_loader() -> None:
    seen: Counter[str] = Counter()
    for index in range(1, 1500):
        files.judge(files.drawn(4, index), index, seen)
    total = seen.total()
    broken_toml = sum(n for word, n in seen.items() if "TOML" in word or "expected" in word)
    assert 0.03 < seen["loaded"] / total < 0.6
    assert 0.1 < broken_toml / total < 0.7
    assert len(seen) > 40


def test_a_loop_in_a_process_of_its_own_says_what_it_took(capsys: pytest.CaptureFixture[str]) -> None:
    one = wild.taken(2, 3)
    assert (one.family, one.index) == ("lattice again", 2)
    assert one.time > 0
    assert one.memory > 1e6
    wild.main(["--loops", "9"])
    words = capsys.readouterr().out
    assert "9 loops, " in words
    assert "ended with" not in words
    assert [wild.drawn(k, 3) for k in range(8)] == [wild.drawn(k, 3) for k in range(8)]
