"""A design is refused where the ordinary analysis finds another circuit, a dead centre, another order, a limit."""

import math
import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import (
    Candidate,
    Claim,
    Refusal,
    checked,
    distinct,
)
from sevenbar.design.closure import draft_of
from sevenbar.design.files import design_files
from sevenbar.design.limits import Limits
from sevenbar.design.search import DesignSearch
from sevenbar.errors import OutputError, RequestError
from sevenbar.reporting.files import Report

#: A double-rocker, whose two branches meet at dead centres of the input, and the paper's crank-rocker.
ROCKER = np.array([300.0, 200.0, 450.0, 500.0, 350.0, 100.0])
CRANK = np.array([700.0, 700.0, 250.0, math.sqrt(450**2 + 550**2 + 700**2), 550.0, 0.0])
NOTHING = np.zeros(3)


def claim(row, inputs, branches, errors=NOTHING):
    """Poses of a linkage at inputs, each on one of the branches of its closed form."""
    linkage = draft_of(row, "design").linkage
    position = linkage.output(inputs).position
    return Claim(
        np.asarray(inputs), position[np.broadcast_to(branches, len(inputs)), np.arange(len(inputs))], errors
    )


def judged(row, claimed, limits=None):
    return checked(draft_of(row, "design"), claimed, limits)


@pytest.mark.parametrize("branch", [0, 1])
@pytest.mark.parametrize("row", [ROCKER, CRANK])
def test_a_design_that_does_what_is_claimed_is_kept_with_its_measures(row, branch):
    inputs = np.linspace(-0.8, 0.8, 9)
    found = judged(row, claim(row, inputs, branch, np.array([0.01, -0.03, 0.02])))
    assert isinstance(found, Candidate)
    assert found.error_greatest == pytest.approx(0.03)
    assert found.error_rms == pytest.approx(math.sqrt(0.0014 / 3))
    assert found.motion_type == found.draft.linkage.motion().motion_type
    # 90 deg less the angle between the coupler and the direction in which B moves, from the balls themselves
    least = math.pi
    for a in np.linspace(-0.8, 0.8, 721):
        b = found.draft.linkage.output([a]).position[branch, 0]
        ball_a = np.array([row[2] * math.cos(a), row[2] * math.sin(a), row[1]])
        ball_b = np.array([row[0], row[5] + row[4] * math.cos(b), row[4] * math.sin(b)])
        moves = np.array([0.0, -math.sin(b), math.cos(b)])
        least = min(least, math.asin(abs((ball_b - ball_a) @ moves) / row[3]))
    assert found.transmission_lowest == pytest.approx(least, abs=1e-5)


def test_points_on_two_circuits_are_refused():
    inputs = np.linspace(0.0, 1.5, 4)
    found = judged(CRANK, claim(CRANK, inputs, np.array([0, 0, 1, 1])))
    assert isinstance(found, Refusal)
    assert found.fault == "circuit"
    assert "point 3" in found.detail


def test_points_with_a_dead_centre_between_them_are_refused():
    inputs = np.linspace(-0.8, 0.8, 4)
    found = judged(ROCKER, claim(ROCKER, inputs, np.array([0, 0, 0, 1])))
    assert isinstance(found, Refusal)
    assert found.fault == "dead centre"
    assert "point 4" in found.detail


@pytest.mark.parametrize("row", [ROCKER, CRANK])
def test_points_in_the_wrong_order_are_refused_and_backwards_is_an_order_too(row):
    inputs = np.array([-0.8, -0.2, 0.3, 0.8])
    found = judged(row, claim(row, inputs[[0, 2, 1, 3]], 0))
    assert isinstance(found, Refusal)
    assert found.fault == "order"
    assert isinstance(judged(row, claim(row, inputs[::-1], 0)), Candidate)


def test_a_crank_may_begin_its_course_anywhere_but_not_go_round_twice():
    inputs = np.array([5.0, 6.0, 7.0, 8.0, 10.0])
    found = judged(CRANK, claim(CRANK, inputs, 0))
    assert isinstance(found, Candidate)
    refused = judged(CRANK, claim(CRANK, np.array([0.0, 2.0, 4.0, 1.0, 3.0]), 0))
    assert isinstance(refused, Refusal)
    assert refused.fault == "order"


def test_a_pose_that_the_linkage_does_not_take_is_refused():
    claimed = claim(CRANK, np.linspace(0, 1, 4), 0)
    moved = Claim(claimed.inputs, claimed.outputs + np.array([0, 0, 0.1, 0]), NOTHING)
    found = judged(CRANK, moved)
    assert isinstance(found, Refusal)
    assert (found.fault, found.detail) == ("assembly", "point 3 of 4 is reached by no circuit")


def test_what_is_no_linkage_is_a_refusal_not_an_error():
    row = CRANK.copy()
    row[3] = 1.0
    found = judged(row, claim(CRANK, np.linspace(0, 1, 4), 0))
    assert isinstance(found, Refusal)
    assert found.fault == "assembly"
    row[3] = -5.0
    assert isinstance(judged(row, claim(CRANK, np.linspace(0, 1, 4), 0)), Refusal)


@pytest.mark.parametrize(
    ("limits", "fault"),
    [
        (Limits(transmission_lowest=math.radians(60)), "transmission"),
        (Limits(size=(251.0, 2000.0)), "size"),
        (Limits(size=(1.0, 990.0)), "size"),
        (Limits(motion_type="double-crank"), "motion type"),
    ],
)
def test_limits_are_kept_to(limits, fault):
    claimed = claim(CRANK, np.linspace(0, 1, 4), 0)
    found = judged(CRANK, claimed, limits)
    assert isinstance(found, Refusal)
    assert found.fault == fault
    easy = Limits(math.radians(20), (250.0, 1000.0), "crank-rocker")
    assert isinstance(judged(CRANK, claimed, easy), Candidate)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"transmission_lowest": math.pi / 2}, "transmission: 90 deg is no limit"),
        ({"size": (10.0, 5.0)}, "size: 10:5 is no range of lengths"),
        ({"motion_type": "crank-rockr"}, "did you mean 'crank-rocker'?"),
    ],
)
def test_limits_that_are_none_are_told(wrong, words):
    with pytest.raises(RequestError, match=r"^[^\n]*$") as told:
        Limits(**wrong)
    assert words in str(told.value)


def test_designs_that_are_one_but_for_their_scale_count_once_where_the_scale_is_free():
    claimed = claim(CRANK, np.linspace(0, 1, 4), 0)
    designs = [judged(factor * CRANK, claimed) for factor in (1.0, 2.0, 1.001)]
    assert len(distinct(designs, scale_free=True)) == 1
    assert len(distinct(designs, scale_free=False)) == 2


def test_mirror_images_are_one_design_where_the_senses_of_turning_do_not_matter():
    image = CRANK * [1, -1, 1, 1, 1, 1]
    inputs = np.linspace(0, 1, 4)
    designs = [judged(row, claim(row, inputs, 0)) for row in (CRANK, image)]
    assert len(distinct(designs, scale_free=True)) == 2
    assert len(distinct(designs, scale_free=True, mirrored=True)) == 1


def searched(errors, count, stop=math.inf):
    """A search whose starts are errors, negative where a start is refused; it is stopped at a start."""
    rows = [CRANK * [1, 1, 1, 1, 1 + 0.2 * i, 1] for i in range(len(errors))]

    def solve(start):
        place, error = start
        if place == stop:
            raise KeyboardInterrupt
        if error < 0:
            return -error, Refusal("error", f"off by {-error}")
        found = Candidate(
            draft_of(rows[place], "design"),
            Claim(NOTHING, NOTHING, np.array([error])),
            "",
            None,
            0,
            0,
            NOTHING,
        )
        return error, found

    search = DesignSearch(len(errors), count=count)
    with search.until_stopped(search.checked):
        search.over(enumerate(errors), solve, lambda found: f"{len(found)}", enough=lambda: search.enough)
    return search.result("wish")


def test_the_best_stands_first_and_names_follow_the_rank():
    found = searched([0.3, 0.1, -0.7, 0.2, -0.4], 5)
    assert [c.error_greatest for c in found.designs] == [0.1, 0.2, 0.3]
    assert [c.name for c in found.designs] == ["wish, design 1", "wish, design 2", "wish, design 3"]
    assert [refusal.detail for refusal in found.refusals] == ["off by 0.4", "off by 0.7"]
    assert (found.refused, found.unfinished) == ("2 by error", "")


def test_a_search_ends_with_as_many_as_are_wanted_and_a_stop_gives_what_is_there():
    assert [c.error_greatest for c in searched([0.3, 0.1, 0.2], 2).designs] == [0.1, 0.3]
    stopped = searched([0.3, 0.1, 0.2], 3, stop=1)
    assert [c.error_greatest for c in stopped.designs] == [0.3]
    assert stopped.unfinished == "stopped after 1 of 3 steps; these are the best so far"
    with pytest.raises(KeyboardInterrupt):
        searched([-1.0, 0.1], 1, stop=1)


def test_written_designs_open_and_tell_what_they_are_for(tmp_path):
    design = judged(CRANK, claim(CRANK, np.linspace(0, 1, 4), 0))
    found = SimpleNamespace(candidates=[design, design])
    head = ["wanted: a test", "made by: a\ncommand"]
    files = design_files(
        3, (), head=lambda _: head, figure=lambda *_: None, as_dict=lambda found: len(found.candidates)
    )
    report = Report(str, vars, files)
    written = report.write(found, tmp_path / "out")
    # no third one was found
    assert [path.name for path in written] == [
        *("design_1.toml", "design_2.toml", "summary.csv", "summary.json")
    ]
    text = written[0].read_text(encoding="utf-8")
    assert text.startswith("# wanted: a test\n# made by: a command\n")
    # as the studio opens it
    assert Draft.of(text, "design_1.toml").linkage.dimensions["L1"] == 250.0
    assert tomllib.loads(text)["rssr"]["M"] == 700.0
    assert sb.load(written[0]).motion().motion_type == "crank-rocker"
    before = text
    with pytest.raises(OutputError, match="exists already"):
        report.write(found, tmp_path / "out")
    assert written[0].read_text(encoding="utf-8") == before
