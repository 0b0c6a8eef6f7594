"""The benchmarks: works take turns, ratios are those of known costs, no peer is dropped, the page has every number."""

import math
import re
import time
from types import SimpleNamespace

import numpy as np
import pytest

import sevenbar as sb
from evidence import ROOT
from evidence.benches import page, peers
from evidence.benches.cases import CASES, case
from evidence.benches.cases.arm import Arm, normal_form
from evidence.benches.cases.closure import CLOSED, Closure, different
from evidence.benches.cases.loops import drawn, paper, sixteen
from evidence.benches.cases.modes import scored
from evidence.benches.harness import OutOfTimeError, Work, at_most, compare, spread
from evidence.benches.outcome import Outcome, Plot, Series, Table, timed
from evidence.circumstances import circumstances


class Clock:
    """A clock that goes only when a work says so."""

    def __init__(self):
        self.now, self.order = 0.0, []

    def work(self, who, cost, **options):
        def call():
            self.order.append(who)
            self.now += cost

        return Work(who, call, **options)


def compared(clock, *works, rounds=6, shortest=0.0):
    return compare(works, rounds=rounds, clock=lambda: clock.now, shortest=shortest)


def test_the_ratio_of_two_known_costs_is_their_quotient():
    clock = Clock()
    ours, theirs = compared(clock, clock.work("ours", 2.0), clock.work("theirs", 7.0, items=2))
    assert (ours.median, ours.ratio) == (2.0, 1.0)
    assert (theirs.median, theirs.ratio, theirs.ratio_low, theirs.ratio_high) == (3.5, 1.75, 1.75, 1.75)


def test_each_round_is_begun_by_another_work():
    clock = Clock()
    compared(clock, *(clock.work(who, 1.0) for who in "abc"), rounds=4)
    # the first call of each is its trial
    assert "".join(clock.order) == "abc" + "abc" + "bca" + "cab" + "abc"


def test_a_ratio_is_that_of_the_same_round_so_a_machine_that_slows_down_does_not_change_it():
    clock = Clock()

    def slower(cost):
        def call():
            clock.now += cost * (1.0 + clock.now)

        return call

    works = [Work("ours", slower(0.001)), Work("theirs", slower(0.003))]
    _, theirs = compare(works, rounds=200, clock=lambda: clock.now, shortest=0.0)
    assert theirs.high > 1.5 * theirs.low
    assert theirs.ratio == pytest.approx(3.0, rel=0.01)


def test_a_short_call_is_repeated_until_the_clock_can_tell():
    clock = Clock()
    (timing,) = compared(clock, clock.work("ours", 0.01), rounds=1, shortest=1.0)
    # a trial, then 1, 2, 4 .. 128 calls to find out, then 128 timed ones
    assert len(clock.order) == 1 + 255 + 128
    assert timing.median == pytest.approx(0.01)


def test_a_peer_that_raises_or_disagrees_is_told_and_not_timed():
    clock = Clock()

    def fails():
        raise ValueError("no such arm\nand more")

    def refuses(answer):
        assert answer == 1, "another answer"

    works = [clock.work("ours", 1.0), Work("broken", fails), Work("wrong", lambda: 2, check=refuses)]
    ours, broken, wrong = compared(clock, *works)
    assert ours.failure == ""
    assert broken.failure == "ValueError: no such arm"
    assert wrong.failure.startswith("disagrees: another answer")
    assert math.isnan(wrong.ratio)
    rows = timed("", "ms", [ours, broken, wrong], [("gone", "not installed")]).rows
    assert [row[0] for row in rows] == ["ours", "broken", "wrong", "gone"]
    assert rows[3][-1] == "not installed"
    with pytest.raises(ValueError, match="no such arm"):
        compared(clock, Work("ours", fails))


def test_the_spread_leaves_out_one_in_ten_on_either_side():
    assert spread([*range(11)]) == (5, 1, 9)


def test_python_that_takes_too_long_is_ended():
    def spin():
        while time.process_time() - start < 5.0:
            pass

    start = time.process_time()
    # one that is not ended comes back and raises nothing
    with at_most(0.05), pytest.raises(OutOfTimeError, match=r"not done after 0\.05 s"):
        spin()


def test_a_missing_peer_is_told_with_its_reason():
    gone = peers.looked_at("no-such-distribution")
    assert gone.reason.startswith("not installed")
    found = peers.of_text(peers.to_text([gone, peers.Peer("numpy", "2")]))
    assert found.module("numpy") is np
    with pytest.raises(peers.AbsentError, match="not installed"):
        found.module("no-such-distribution")


def test_a_peer_that_crashes_in_its_import_or_cannot_be_imported_is_told(tmp_path, monkeypatch):
    (tmp_path / "crashing_peer.py").write_text("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    (tmp_path / "broken_peer.py").write_text("raise RuntimeError('built for another NumPy')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert peers.import_failure("crashing_peer") == "the import ends by signal 11"
    assert peers.import_failure("broken_peer").endswith("RuntimeError: built for another NumPy")
    assert peers.import_failure("json") == ""


def test_the_extra_names_the_peers_that_the_cases_ask_for():
    sources = "".join(path.read_text() for path in (ROOT / "evidence" / "benches" / "cases").glob("*.py"))
    asked = set(re.findall(r'peers\.module\(\s*"([\w-]+)"', sources))
    assert len(asked) >= 7
    assert asked <= set(peers.requirements())


def results(*outcomes):
    made = circumstances() | {"date": "2026-01-02", "commit": "0123456789", "kind": "full"}
    cases = {f"case_{k}": outcome.to_json() | {"made": "2026-01-02"} for k, outcome in enumerate(outcomes)}
    gone = {"name": "gone", "version": "", "reason": "not installed: no wheel | for this machine"}
    return {"made": made, "peers": [gone], "cases": cases}


def test_the_page_has_every_row_and_every_reason_and_its_figures(tmp_path):
    table = Table("inputs", ["", "ns a pose", "note"], [["ours", 12.345, ""], ["theirs", None, "refuses"]])
    curves = [
        Series("ours", [1.0, 10.0, 1e4], [5.0, 4.0, 3.5]),
        Series("copy", [1.0, 1e4], [1.0, 1.0], yardstick=True),
    ]
    plot = Plot("bench_some", "A title", "inputs", "ns", curves)
    whole, broken = (
        Outcome("One", "About.", [table], [plot]),
        Outcome("Two", "", failure="ended by signal 11"),
    )
    page.write(results(whole, broken), tmp_path / "benchmarks.md")
    text = (tmp_path / "benchmarks.md").read_text(encoding="utf-8")
    assert "| gone | – | not installed: no wheel / for this machine |" in text
    assert "| ours | 12.3 |  |" in text
    assert "| theirs | – | refuses |" in text
    assert "ended by signal 11" in text
    assert "2026-01-02, commit 0123456789" in text
    for target in re.findall(r"\]\((images/[^)]+)\)", text):
        picture = (tmp_path / target).read_bytes()
        assert picture.startswith(b"<?xml")
        assert len(picture) < 100_000
    assert Outcome.of_json(whole.to_json()) == whole


@pytest.mark.parametrize(
    ("value", "told"),
    [(None, "–"), (0.0, "0"), (1.0, "1"), (12345.6, "12,346"), (0.12345, "0.123"), (1.2345e-5, "1.2e-05")],
)
def test_cells_have_three_digits(value, told):
    assert page.cell(value) == told


def test_numbers_that_are_none_are_null_in_the_json():
    outcome = Outcome("", "", [Table("", ["a"], [[math.nan, math.inf, 1.0]])])
    assert outcome.to_json()["tables"][0]["rows"] == [[None, None, 1.0]]


def test_every_case_has_a_title_and_tells_what_it_does():
    for name in CASES:
        module = case(name)
        assert module.TITLE
        assert len(module.ABOUT) > 100
        assert callable(module.run)


def general():
    return drawn(np.random.default_rng(1))


@pytest.mark.parametrize("make", [general, sixteen, lambda: next(paper())])
def test_the_arm_of_a_loop_reaches_its_target_in_every_mode(make):
    problem = make()
    arm = Arm(problem.linkage.transforms)
    target, screwed = arm.target(problem.theta), arm.screwed(problem.theta)
    modes = problem.linkage.assembly_modes(problem.theta).q
    assert len(modes) > 0
    for pose in modes:
        assert by_rows(arm, pose[1:]) == pytest.approx(target, abs=1e-9 * arm.size)
        assert by_exponentials(arm, pose[1:]) == pytest.approx(screwed, abs=1e-9 * arm.size)


def by_rows(arm, angles):
    """The product of Denavit-Hartenberg rows."""
    end = np.eye(4)
    for a, twist, d, zero, angle in zip(*arm.rows, angles, strict=True):
        end = end @ turn(2, angle + zero) @ shift(0, 0, d) @ shift(a, 0, 0) @ turn(0, twist)
    return end


def by_exponentials(arm, angles):
    """The product of turns about the axes as they lie at zero, by Rodrigues' formula."""
    end = np.eye(4)
    for axis, offset, angle in zip(arm.axes, arm.offsets, angles, strict=False):
        k = np.cross(np.eye(3), axis)
        step = shift(*offset)
        step[:3, :3] = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
        end = end @ step
    return end @ shift(*arm.offsets[6])


def turn(axis, angle):
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[i, j], matrix[j, i] = -np.sin(angle), np.sin(angle)
    return matrix


def shift(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


@pytest.mark.parametrize("twist", [0.7, 0.0, np.pi])
def test_the_normal_form_of_a_link_gives_the_link(twist):
    link = (
        turn(2, 0.3) @ shift(0, 0, 2.0) @ shift(1.5, 0, 0) @ turn(0, twist) @ shift(0, 0, -0.4) @ turn(2, 1.1)
    )
    b, c, a, alpha, d, e = normal_form(link)
    again = turn(2, b) @ shift(0, 0, c) @ shift(a, 0, 0) @ turn(0, alpha) @ shift(0, 0, d) @ turn(2, e)
    assert again == pytest.approx(link, abs=1e-12)


def test_the_search_that_judges_finds_the_modes_known_in_forty_digits():
    for problem in paper():
        closure = Closure(problem.linkage.transforms)
        assert closure.error(problem.known).max() < CLOSED
        found = closure.searched(problem.theta, 2000, seed=0)
        assert len(found) == len(problem.known)
        assert len(different(np.concatenate([found, problem.known]))) == len(problem.known)


def test_answers_are_counted_as_found_false_or_told_twice():
    problem = next(paper())
    true = problem.known
    off = np.array([0, 1, 1, -1, 1, 1, -1])
    answers = np.concatenate([true[:3] + 1e-5 * off, true[:1], true[:1] + off])
    found, of, false, error = scored(problem, true, answers)
    assert (found, of, false) == (3, len(true), 1)
    assert 1e-6 < error < 1e-3
    assert scored(problem, true, np.empty((0, 7)))[:3] == (0, len(true), 0)


def test_the_half_turn_of_a_loop_is_no_closure():
    links = np.tile(np.eye(4), (7, 1, 1))
    links[0, 0, 3] = 1.0
    links[1, 0, 3] = -1.0
    pose = np.zeros((1, 7))
    pose[0, 6] = np.pi
    assert Closure(links).error(pose)[0] > 1.0


def test_a_quick_look_at_an_array_of_rssrs_agrees_with_numpy_and_tells_of_numba():
    gone = peers.Peer("numba", reason="not installed")
    from evidence.benches.setting import Setting

    outcome = case("rssr_array").run(Setting(peers.Peers([gone]), quick=True))
    for table in outcome.tables:
        assert [row[0] for row in table.rows] == ["Sevenbar", "NumPy", "numba"]
        assert table.rows[1][4] > 0
        assert table.rows[2][-1] == "not installed"


def test_rows_of_nets_are_timed_without_pylinkage_too_and_the_reason_is_in_its_rows():
    from evidence.benches.cases import nets_pylinkage
    from evidence.benches.setting import Setting

    gone = peers.Peers([peers.Peer("pylinkage", reason="not installed")])
    table = nets_pylinkage.compared(Setting(gone, quick=True), "watt")
    assert [row[0] for row in table.rows] == ["Sevenbar", "pylinkage, places", "pylinkage, with rates"]
    assert table.rows[0][1] > 0
    assert [row[-1] for row in table.rows[1:]] == ["not installed"] * 2


def test_places_of_nets_are_those_that_dyads_of_their_drawn_lengths_have():
    from evidence.benches.cases import nets_pylinkage

    for name, plan in nets_pylinkage.PLANS.items():
        drawn = nets_pylinkage.drawn(name)
        (places, *_), _ = nets_pylinkage.true_rows(sb.load(name), name, 24)
        own = dict(zip(nets_pylinkage.moving(name), places.transpose(1, 0, 2), strict=True))
        for label, at in drawn.places.items():
            own.setdefault(label, np.array([at]))
        for label, _, *anchors in plan:
            for anchor in anchors:
                length = math.dist(drawn.places[label], drawn.places[anchor])
                assert np.abs(np.linalg.norm(own[label] - own[anchor], axis=1) - length).max() < 1e-12


def test_a_change_in_the_studio_is_timed_by_what_it_sends_itself(monkeypatch):
    """Also where its last message comes so late that the page seemed to be at rest before."""
    from evidence.benches.cases import studio
    from evidence.benches.cases.studio_client import updates
    from sevenbar.description.files import toml_text
    from sevenbar.studio import tab as tab_module
    from sevenbar.studio.server import StudioServer

    late, verdict, works, starts, told = 0.06, tab_module.verdict, [], [], {}

    def late_verdict(session):
        time.sleep(late)
        # of the change in hand, how long after its start
        told[len(starts)] = 1e3 * (time.perf_counter() - starts[-1]) if starts else 0.0
        return verdict(session)

    server = StudioServer(toml_text("rssr"), "rssr", "127.0.0.1", 0)
    try:
        listener, tab = studio.connected(server)
        change, begun = tab.session.change, len(listener.frames)

        def timed_change(place, value):
            starts.append(time.perf_counter())
            change(place, value)
            works.append(1e3 * (time.perf_counter() - starts[-1]))

        monkeypatch.setattr(tab.session, "change", timed_change)
        monkeypatch.setattr(tab_module, "verdict", late_verdict)
        drawn, all_sent = studio.changed(tab, listener, 8)
        sent = [update for _, frame in listener.frames[begun:] for update in updates(frame)]
    finally:
        server.stop()
    # every change is done, none overtaken by the next
    assert len(works) == len(drawn) == len(all_sent) == 8
    # the curves come behind the change, and all is sent behind the verdict, whenever that comes
    assert all(time > work for time, work in zip(drawn, works, strict=True))
    assert all(end > told[k] for k, end in enumerate(all_sent, start=1))
    first = sb.load("rssr").dimensions["L1"]
    boxes = [f"{first * (1 + 0.0005 * (k + 1) * (-1) ** k):.12g}" for k in range(8)]
    assert [update["value"] for update in sent if update.get("value") in boxes] == boxes


def test_a_dimension_at_which_nothing_moves_is_no_timing():
    from evidence.benches.cases import studio

    dimension = SimpleNamespace(label="L1", value=250.0, place=("rssr", "L1"), key="rssr.L1")
    session = SimpleNamespace(
        draft=SimpleNamespace(dimensions=[dimension]), problem="it does not close", change=lambda *_: None
    )
    tab = SimpleNamespace(session=session, worker=SimpleNamespace(ask=lambda _, action: action()))
    with pytest.raises(ValueError, match=r"rssr\.L1 = 250\.125: it does not close"):
        studio.changed(tab, SimpleNamespace(frames=[]), 1)
