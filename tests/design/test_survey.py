"""Surveys: each measure is that of the ordinary analysis, the answer is the same however the work is divided."""

import json
import math
import random
import re
from functools import reduce
from operator import add
from typing import Any, NamedTuple

import numpy as np
import pytest

import sevenbar as sb
from command_runs import killed, mistake, sevenbar
from sevenbar import _core
from sevenbar.curves.least_cone import half_angle
from sevenbar.design.survey import SurveyTally, SurveyTask, SwingWish, Travel, survey
from sevenbar.design.survey.journal import JOURNAL
from sevenbar.design.survey.polish import Polish, draft_of
from sevenbar.design.survey.skew_closure import L2, poses, reach
from sevenbar.design.survey.task import drawn_numbers
from sevenbar.design.wish import wish_of_function, wish_of_pairs
from sevenbar.errors import OutputError, RequestError
from sevenbar.kinematics.solvers.batches import VERDICTS, WORDS

#: A flap drive: a quarter turn of the motor, 23.75 deg of the flap, rod ends that take 15 deg.
FLAP = Travel(math.radians(90), math.radians(23.75))


def parabola():
    quarter = (0.0, math.pi / 2)
    return wish_of_function(np.square, (0.0, 1.0), quarter, quarter, title="y = x^2")


def drawn(count: int, seed: int = 0):
    task = SurveyTask(FLAP, count=count, seed=seed)
    return drawn_numbers(task, range(count))


def pose_of(numbers):
    """The numbers with an input at which the linkage closes, as far from its limits as any of 720."""
    inputs = np.arange(720) * math.tau / 720
    w = reach(np.append(numbers, 0.0), inputs)[3]
    return np.append(numbers, inputs[w.argmax()]) if w.max() > 0 else None


def around(angles, start):
    return np.sort(np.mod(np.asarray(angles) - start, math.tau))


class Figures(NamedTuple):
    """What the core's survey measures linkages by, one row each; NaN where there is nothing."""

    types: Any
    limits: Any
    swing: Any
    time_ratio: Any
    transmission: Any


def survey_figures(rows):
    codes, *figures = _core.survey_figures(np.ravel(rows))
    return Figures(WORDS[codes], *figures)


def assert_measured_alike(rows):
    """The figures of the core's survey are those of `motion()` of the linkage drawn in a pose."""
    found = survey_figures(rows)
    compared = 0
    for place, numbers in enumerate(rows):
        at = pose_of(numbers)
        if at is None:
            assert found.types[place] in ("cannot-assemble", "change-point"), numbers
            continue
        motion = draft_of(at, 0, 1.0, "drawn").linkage.motion(90)
        assert motion.motion_type == found.types[place], numbers
        if motion.motion_type == "change-point":
            continue
        compared += 1
        limits = found.limits[place][~np.isnan(found.limits[place])]
        wanted, got = around(motion.limits, 0.0), around(limits, at[-1])
        assert len(wanted) == len(got), numbers
        apart = np.abs(np.exp(1j * wanted) - np.exp(1j * got))
        assert apart.max(initial=0.0) < 1e-7, numbers
        circuits = motion.circuits
        for name, column in (("swing", found.swing), ("time_ratio", found.time_ratio)):
            own = column[place][~np.isnan(column[place])]
            values = [value for c in circuits if (value := getattr(c, name)) is not None]
            assert np.allclose(np.sort(own), np.sort(values), rtol=1e-6, atol=1e-7), (numbers, name)
        if motion.motion_type in ("crank-rocker", "double-crank"):
            least = min(c.transmission.lowest for c in circuits)
            assert abs(math.sin(least) - math.sin(found.transmission[place])) < 1e-6, numbers
    return compared


def test_measures_are_those_of_the_ordinary_analysis():
    rows = drawn(120)
    assert assert_measured_alike(rows) > 40
    square, parallel, meeting, equal = rows[:40].copy(), rows[:40].copy(), rows[:40].copy(), rows[:40].copy()
    square[:, 6], parallel[:, 6] = math.pi / 2, 0.0
    meeting[:, 5], equal[:, 2:5] = 0.0, 1.0
    for special in (square, parallel, meeting, equal, np.round(rows[:40], 1)):
        assert assert_measured_alike(special) >= 5


def test_measures_of_a_thousand_are_those_of_the_ordinary_analysis():
    assert assert_measured_alike(drawn(1000, seed=1)) > 400


@pytest.mark.parametrize("way", [0.0, math.pi / 2, 1.0])
def test_near_a_change_point_types_are_those_of_the_ordinary_analysis(way):
    # at some length of the rod the crank begins to turn fully
    numbers = np.array([0.4, 0.3, 0.5, 1.6, 1.0, 0.8, way])
    inputs = np.linspace(0.0, math.tau, 20001)

    def least(rod):
        moved = np.append(numbers, 0.0)
        moved[L2] = rod
        return reach(moved, inputs)[3].min()

    low, high = 0.3, 1.0
    assert least(low) < 0 < least(high)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if least(middle) < 0 else (low, middle)
    rows = []
    for power in range(3, 13):
        for sign in (-1, 1):
            row = numbers.copy()
            row[L2] = low * (1 + sign * 10.0**-power)
            rows.append(row)
    found = survey_figures(np.array(rows))
    for row, own in zip(rows, found.types, strict=True):
        assert draft_of(pose_of(row), 0, 1.0, "near").linkage.motion(90).motion_type == own
    assert {"crank-rocker", "double-rocker"} <= set(found.types) | {"double-crank"}


@pytest.mark.parametrize("want", [FLAP, parabola()])
def test_what_is_kept_does_what_is_said_of_it(want):
    task = SurveyTask(want, count=20000, tolerance=math.radians(2), ball_angle=math.radians(30))
    tally = SurveyTally.of(task.core().tally(0, task.count))
    kept = [*tally.best[:20], *tally.nearest.values()]
    assert len(kept) > 20
    inputs, wanted = task.readings
    for one, numbers in zip(kept, drawn_numbers(task, [k.index for k in kept]), strict=True):
        row = np.append(numbers, one.start)
        now = poses(row, inputs, one.branch)
        off = one.sense * (now.output - now.output[0]) - wanted
        error = abs(off[-1]) if isinstance(want, Travel) else np.ptp(off)
        assert abs(error / 2 - one.error) < 1e-10
        assert abs(math.asin(math.sqrt(now.square.min())) - one.transmission) < 1e-9
        if not math.isnan(one.balls[0]):
            angles = [half_angle(directions) for directions in (now.crank, now.rocker)]
            assert np.allclose(angles, one.balls, atol=1e-7)


def test_no_start_of_a_dense_scan_is_much_better_than_the_one_that_was_found():
    task = SurveyTask(parabola(), count=400, tolerance=math.radians(90), transmission_lowest=0.0)
    core, (inputs, wanted) = task.core(), task.readings
    checked = 0
    for index, numbers in enumerate(drawn_numbers(task, range(60))):
        tally = SurveyTally.of(core.tally(index, 1))
        entry = [*tally.best, *tally.nearest.values()]
        best = math.inf
        for start in np.arange(180) * math.tau / 180:
            for branch in (0, 1):
                now = poses(np.append(numbers, start), inputs, branch)
                if now is not None:
                    best = min(best, *(np.ptp(s * now.output - wanted) / 2 for s in (1, -1)))
        if entry and math.isfinite(best):
            checked += 1
            # starts of the survey are 7.5 deg apart, those of the scan 2 deg
            assert entry[0].error < best + math.radians(8)
            assert best < entry[0].error + math.radians(2)
    assert checked > 15


def test_the_smallest_cone_is_that_of_a_search_over_seats():
    rng = np.random.default_rng(3)
    for count in (2, 3, 7, 30):
        directions = rng.normal([0, 0, 2], 0.5, (count, 3))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        seats = rng.normal([0, 0, 2], 0.5, (20000, 3))
        seats /= np.linalg.norm(seats, axis=1)[:, None]
        searched = np.arccos((seats @ directions.T).min(axis=1)).min()
        found = half_angle(directions)
        assert found <= searched + 1e-12
        assert searched - found < 0.05
    # six along the axes leave eight gaps, in whose middle no cone need be
    widest = half_angle(np.vstack([np.eye(3), -np.eye(3)]))
    assert widest == pytest.approx(math.pi - math.acos(1 / math.sqrt(3)), abs=1e-15)


@pytest.mark.parametrize("want", [FLAP, parabola(), SwingWish(math.radians(60), 1.2)])
@pytest.mark.parametrize("rank", ["error", "transmission", "ball angle"])
def test_the_answer_is_the_same_in_any_parts_and_any_order(want, rank):
    task = SurveyTask(want, count=30000, tolerance=math.radians(4), rank=rank)
    core = task.core()
    whole = SurveyTally.of(core.tally(0, 30000))
    sizes = [1, 4095, 10000, 15904]
    firsts = np.cumsum([0, *sizes[:-1]])
    parts = [SurveyTally.of(core.tally(int(f), n)) for f, n in zip(firsts, sizes, strict=True)]
    assert reduce(add, parts) == reduce(add, parts[::-1])
    # a ball angle that was not measured is NaN, which equals nothing
    assert reduce(add, parts).line() == whole.line()
    assert SurveyTally.of_dict(json.loads(whole.line())).line() == whole.line()
    assert whole.count == 30000
    assert whole.found > 0


def test_any_number_of_threads_gives_the_same_answer(tmp_path, monkeypatch):
    monkeypatch.setattr(SurveyTask, "part_size", 5000)
    task = SurveyTask(FLAP, count=23456)
    answers = [
        survey(task, designs_wanted=0, threads=threads, out=out)
        for threads, out in ((1, None), (2, tmp_path / "two"), (3, tmp_path / "three"))
    ]
    assert len({answer.tally.line() for answer in answers}) == 1
    assert answers[0].tally.count == 23456


def test_a_journal_cut_anywhere_is_gone_on_with(tmp_path, monkeypatch):
    monkeypatch.setattr(SurveyTask, "part_size", 2000)
    task = SurveyTask(FLAP, count=9000)
    whole = survey(task, designs_wanted=0, out=tmp_path / "a", threads=1).tally.line()
    journal = tmp_path / "a" / JOURNAL
    content = journal.read_bytes()
    for length in (len(content) - 1, len(content) // 2, 10, 0):
        journal.write_bytes(content[:length])
        if content[:length].count(b"\n"):
            with pytest.raises(OutputError, match="--resume"):
                survey(task, designs_wanted=0, out=tmp_path / "a")
        again = survey(task, designs_wanted=0, out=tmp_path / "a", resume=True, threads=2)
        assert again.tally.line() == whole
        assert journal.read_bytes().count(b"\n") == 5
    with pytest.raises(OutputError, match="another survey: seed is 0 there and 1 here"):
        survey(SurveyTask(FLAP, count=9000, seed=1), out=tmp_path / "a", resume=True)
    for line in (b'{"part":0}\n', content.replace(b'"part":0', b'"part":-1')):
        journal.write_bytes(line)
        with pytest.raises(OutputError, match="is no part of this survey"):
            survey(task, out=tmp_path / "a", resume=True)


def test_a_line_of_a_journal_is_taken_as_the_part_it_was_written_for_or_not_at_all(tmp_path, monkeypatch):
    monkeypatch.setattr(SurveyTask, "part_size", 2000)
    task = SurveyTask(FLAP, count=9000)
    whole = survey(task, designs_wanted=0, out=tmp_path / "a", threads=1).tally.line()
    journal = tmp_path / "a" / JOURNAL
    # by their parts, in whichever order they were done
    first, second, *rest = sorted(journal.read_bytes().splitlines(keepends=True))
    flipped, chance = [], random.Random(5)
    for place in [chance.randrange(8 * (len(second) - 1)) for _ in range(50)]:
        line = bytearray(second)
        line[place // 8] ^= 1 << place % 8
        flipped.append(bytes(line))
    wrong = (
        first.replace(b'"part":0', b'"part":1'),
        re.sub(rb',"check":"\w+"', b"", second),
        b"[" * 100_000 + b"\n",
        *flipped,
    )
    for line in wrong:
        journal.write_bytes(b"".join([first, line, *rest]))
        with pytest.raises(OutputError, match=r"journal.jsonl: line 2 is no part of this survey, or damaged"):
            survey(task, designs_wanted=0, out=tmp_path / "a", resume=True)
    # in another order, and one twice
    journal.write_bytes(b"".join([*rest, second, first, second]))
    assert survey(task, designs_wanted=0, out=tmp_path / "a", resume=True).tally.line() == whole


def test_a_survey_that_was_killed_goes_on(tmp_path):
    words = [
        "design",
        "survey",
        "--output-range",
        "0:23.75deg",
        "--count",
        "1.2e6",
        "--threads",
        "1",
        "--json",
    ]
    journal = tmp_path / "a" / JOURNAL
    killed(
        *words, "--journal", tmp_path / "a", once=lambda: journal.exists() and b"\n" in journal.read_bytes()
    )
    lines = journal.read_bytes().count(b"\n")
    assert 1 <= lines < 5
    kept = journal.read_bytes()
    kept = kept[: kept.rfind(b"\n") + 1]
    task = SurveyTask(FLAP, count=1_200_000)
    again = survey(task, designs_wanted=0, out=tmp_path / "a", resume=True, threads=2)
    assert journal.read_bytes().startswith(kept)
    assert again.tally.line() == survey(task, designs_wanted=0, threads=2).tally.line()


def test_workers_of_a_cluster_give_the_same_answer(workers):
    task = SurveyTask(FLAP, count=600_000)
    there = survey(task, designs_wanted=0, scheduler=workers(2).scheduler_address)
    assert there.tally.line() == survey(task, designs_wanted=0, threads=1).tally.line()


def test_designs_are_better_than_what_was_drawn_and_keep_what_must_hold():
    task = SurveyTask(parabola(), count=30000, tolerance=math.radians(5), ball_angle=math.radians(40))
    tally = SurveyTally.of(task.core().tally(0, task.count))
    found = survey(task, designs_wanted=5, threads=1)
    assert found.tally.line() == tally.line()
    assert found.candidates[0].error_greatest < tally.best[0].error / 5
    for candidate in found.candidates:
        figures = candidate.claim.figures
        assert candidate.error_greatest <= task.tolerance
        assert candidate.transmission_lowest >= task.transmission_lowest - 1e-9
        assert max(figures["ball_crank_deg"], figures["ball_rocker_deg"]) < 40 + 1e-6
        # the file says so, too: the drawn pose is that of the first readings
        linkage = candidate.draft.linkage
        inputs = np.radians([0.0, 30.0, 60.0, 90.0])
        outputs = np.unwrap(linkage.output(inputs).position, axis=1)
        off = np.ptp(outputs - np.square(inputs / (math.pi / 2)) * math.pi / 2, axis=1) / 2
        assert off.min() < candidate.error_greatest + 1e-9


def test_a_swing_and_a_travel_are_met_exactly():
    for want in (FLAP, SwingWish(math.radians(60), 1.2)):
        task = SurveyTask(want, count=40000, tolerance=math.radians(4))
        found = survey(task, designs_wanted=1, threads=1)
        assert found.candidates[0].error_greatest < 1e-9
        assert found.candidates[0].transmission_lowest > math.radians(40)


def test_a_swing_as_quick_one_way_as_back_is_met_though_change_points_are_near():
    square = {"angle": (math.pi / 2, math.pi / 2)}
    task = SurveyTask(SwingWish(math.radians(60), 1.0), square, count=40000, tolerance=math.radians(4))
    found = survey(task, designs_wanted=3, threads=1)
    assert found.polished > 6
    for candidate in found.candidates:
        assert candidate.error_greatest < 1e-9
        assert candidate.transmission_lowest > math.radians(70)


def test_pairs_are_met_as_well_as_can_be():
    want = wish_of_pairs(np.radians([0, 20, 40, 60]), np.radians([0, 31, 50, 64]))
    found = survey(SurveyTask(want, count=40000, tolerance=math.radians(4)), designs_wanted=1, threads=1)
    assert found.candidates[0].error_greatest < 1e-6


def test_that_none_does_it_is_an_answer_with_what_comes_nearest():
    task = SurveyTask(Travel(math.radians(90), math.radians(170)), count=20000, ball_angle=0.05)
    found = survey(task, threads=1)
    assert (found.tally.found, found.candidates) == (0, ())
    assert found.answer == "none of 20 000 does it"
    assert "near enough, ball angles" in found.nearest["ball angle"]
    assert sum(found.tally.refused.values()) == 20000
    assert list(found.tally.refused) == list(VERDICTS[1:])


def test_a_survey_is_printed_written_and_given_as_json(tmp_path):
    words = ["design", "survey", "--output-range", "0:23.75deg", "--count", "4e2", "--ball-angle", "30deg"]
    words += ["--bound", "angle=90deg", "--designs", "2", "--threads", "1"]
    run = sevenbar(*words, "--out", tmp_path / "out")
    assert run.returncode == 0, run.stderr
    for part in ("90 deg in, 23.75 deg out", "ball angles <= 30 deg", "of 400 do it", "at 90 deg"):
        assert part in run.stdout
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"design_1.toml", "design_2.toml", "summary.csv", "summary.json"}
    report = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert report == json.loads(sevenbar(*words, "--json").stdout)
    linkage = sb.load(tmp_path / "out" / "design_1.toml")
    turn = np.unwrap(linkage.output(np.radians([0.0, 45.0, 90.0])).position, axis=1)
    assert np.abs(turn[:, -1] - turn[:, 0] - math.radians(23.75)).min() < 1e-9
    assert report["tally"]["verdicts"]["found"] > 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--bound", "L9=1:2"], "bounds: 'L9' is no number of an RSSR"),
        (["--bound", "L1=2:1"], "L1: 2:1 is no range; give two numbers that rise"),
        (["--bound", "L1=2..1"], "L1: 2:1 is no range; give two numbers that rise"),
        (["--bound", "L1=-1:1"], "L1: -1:1 holds no length only; give numbers > 0"),
        (["--bound", "L1"], "--bound: 'L1' is not a range of a number; give one as in"),
        (["--bound", "D=0", "--bound", "D=1"], "--bound: 'D' is given twice"),
        (["--swing", "60deg", "--y", "x"], "--y: a function, a --table or a --swing; give one"),
        (["--swing", "60deg", "--motion-type", "double-crank"], "motion type: a double-crank has no swing"),
        (["--rank", "best"], "rank: 'best' is not offered"),
        (["--resume"], "--resume: of no folder; give --journal too"),
        (["--output-range", "0:400deg"], "output range: 400 deg is no part of a turn"),
        (["--count", "0"], "count: 0 is not a number of linkages"),
        (["--ball-angle", "0deg"], "ball angle: 0 deg is no limit"),
    ],
)
def test_what_makes_no_survey_has_one_message(words, message):
    assert message in mistake("design", "survey", *words)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"count": 1e6}, "count: 1000000.0 is not a number of linkages; give 1 to "),
        ({"count": True}, "count: True is not a number of linkages"),
        ({"seed": 1.5}, "seed: 1.5 is not a seed; give 0 to "),
        ({"seed": -1}, "seed: -1 is not a seed"),
        ({"bounds": None}, "bounds: None are none; give ranges by name"),
        ({"bounds": {3: (0, 1)}}, "bounds: 3 is no number of an RSSR"),
        ({"bounds": {"M": 1.0}}, "M: 1.0 is no range; give two numbers that rise"),
        ({"bounds": {"M": (0, 1, 2)}}, "M: (0, 1, 2) is no range"),
        ({"bounds": {"M": ("a", "b")}}, "M: ('a', 'b') is not an array of numbers"),
        ({"bounds": {"M": (math.nan, 1)}}, "M: nan:1 is no range"),
    ],
)
def test_what_is_no_survey_in_python_is_a_request_error(wrong, message):
    with pytest.raises(RequestError) as told:
        SurveyTask(FLAP, **wrong)
    assert message in str(told.value)


def test_counts_and_seeds_of_numpy_are_numbers():
    plain, given = (SurveyTask(FLAP, count=kind(10), seed=kind(3)) for kind in (int, np.int64))
    assert plain.digest() == given.digest()


def test_bounds_must_be_of_a_linkage():
    with pytest.raises(RequestError, match="are no linkage to build"):
        SurveyTask(FLAP, bounds={"M": (0.0, 1e9)})


def test_a_stop_while_polishing_gives_the_designs_there_are_and_says_so(monkeypatch):
    polished, calls = Polish.polished, []

    def stopped(polish):
        calls.append(polish)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return polished(polish)

    monkeypatch.setattr(Polish, "polished", stopped)
    task = SurveyTask(Travel(math.radians(90), math.radians(23.75)), count=3000)
    found = survey(task, designs_wanted=2, threads=1)
    assert (found.tally.count, len(found.candidates)) == (3000, 1)
    assert found.unfinished == "stopped after 1 of 8 steps; these are the best so far"
