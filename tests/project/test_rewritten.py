"""One linkage written in twenty and more ways: every answer that must agree does (`python -m evidence.rewritten`)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import sevenbar as sb
from evidence.circumstances import circumstances
from evidence.rewritten.__main__ import compared
from evidence.rewritten.answers import Answers, differences
from evidence.rewritten.families import families, lattice
from evidence.rewritten.page import Compared, written
from evidence.rewritten.reasons import reason
from evidence.rewritten.ways import Way, ways
from sevenbar.errors import RequestError
from sevenbar.reporting.how_found import how_found
from sevenbar.reporting.report import as_dict

#: Some of each kind, those that have a like as proofs; the whole is evidence.
NAMES = (
    "planar R R R R, crank-rocker 40 100 80 90",
    pytest.param("planar R R R R, decimals 0.1 2.6 2.5 2.4", marks=pytest.mark.proof),
    "planar R R R R, square",
    pytest.param("planar R R R R, parallelogram 1 2", marks=pytest.mark.proof),
    "planar R R R R, kite 1 1 2 2",
    "planar R R R R, nearly a kite, 1e-3",
    pytest.param("planar R R R R, a step between planes", marks=pytest.mark.proof),
    "planar R S R R, kite 1 1 2 2",
    "planar R R S R, crank-rocker 40 100 80 90",
    pytest.param("planar R S S R, decimals 0.3 0.7 0.6 0.9", marks=pytest.mark.proof),
    "planar R S S R, a step between planes",
    pytest.param("planar R R U R, crank-rocker 40 100 80 90", marks=pytest.mark.proof),
    "slider-crank R R R P, offset 1 3 0.5",
    pytest.param("slider-crank R R R P, equal links 1 1 0", marks=pytest.mark.proof),
    "slider-crank R S S P, in line 1 3",
    "spherical R R R R in one point, crank-rocker 30 80 60 70",
    pytest.param("spherical R R R R, parallelogram 40 70 40 70", marks=pytest.mark.proof),
    "spherical R R R R, right angles 90 90 90 60",
    pytest.param("R S S R, decimals", marks=pytest.mark.proof),
    "R S S R, skew",
    "R S S P",
    "R S C R",
    "R S U R, at a dead centre",
    "7 R, decimals",
)


@pytest.mark.parametrize("name", NAMES)
def test_a_linkage_answers_alike_however_it_is_written(name: str) -> None:
    found = compared(families()[name](), seed=7)
    assert found.moves
    assert found.ways >= 20
    assert found.differences == []


def test_there_are_a_hundred_families_and_a_lattice() -> None:
    assert len(families()) >= 100


@pytest.mark.parametrize("index", [175, 156, 1198])
def test_a_loop_on_the_lattice_answers_alike(index: int) -> None:
    # 175: circuits of equal ranges; 156: two dead centres within a step, a sharp bend at a change point; 1198: two of the output in a step
    # that ends in one of them
    found = compared(lattice(index, seed=1), seed=1)
    assert found.moves
    assert found.ways >= 20
    assert found.differences == []


@pytest.mark.parametrize("written", ["as drawn", "turned and moved off", "mirrored and turned"])
def test_an_output_that_rocks_by_one_turn_is_a_rocker_to_rounding(written: str) -> None:
    # it turns back at -pi and at pi; the slides run off to infinity
    way = next(way for way in ways(lattice(2165, seed=1), np.random.default_rng(1)) if way.name == written)
    assert way.linkage.motion(36).motion_type == "double-rocker"


def test_the_circuit_through_a_pose_is_the_one_it_lies_on() -> None:
    # circuits that change points lead to from one another
    linkage = lattice(55, seed=1).linkage()
    motion = linkage.motion(36, input="j1", output="j7")
    turning_back = [circuit for circuit in motion.circuits if circuit.input_range is not None]
    assert len(turning_back) == 6
    for circuit in turning_back:
        row = int(np.nanargmin(np.where(np.isfinite(circuit.condition), circuit.condition, np.nan)))
        again = linkage.circuit(circuit.q[row], 36, input="j1", output="j7")
        assert again.input_range is not None
        lowest, highest = (
            np.unwrap([end, other])[1]
            for end, other in zip(circuit.input_range, again.input_range, strict=True)
        )
        assert (lowest, highest) == pytest.approx(circuit.input_range, abs=1e-9)


@pytest.mark.parametrize("loop", ["lattice", "held"])
def test_a_circuit_asked_for_again_at_other_inputs_has_the_rows_of_one_followed_anew(loop: str) -> None:
    # one that change points lead to, and one whose constraint is met twice over, followed with a joint held
    drawn = lattice(156, seed=1) if loop == "lattice" else families()["doubly met constraint that moves"]()
    again, anew = drawn.linkage(), drawn.linkage()
    ends = {"input": drawn.input, "output": drawn.output}
    first = again.motion(36, **ends).circuits[0]
    row = int(np.nanargmin(first.condition))
    again.circuit(first.q[row], 36, **ends)
    law = sb.Law.of(np.arange(4.0), first.input[row] + np.array([0.0, 0.01, 0.03, 0.02]), 1.0, 0.0)
    for asked in (ends | {"law": law}, ends | {"samples": 72}):
        one = again.circuit(first.q[row], **asked)
        other = anew.circuit(first.q[row], **asked)
        anew = drawn.linkage()
        assert np.array_equal(one.q, other.q, equal_nan=True)
        assert np.array_equal(one.dddq, other.dddq, equal_nan=True)
        assert (one.motion_type, one.input_range, one.output_range) == (
            other.motion_type,
            other.input_range,
            other.output_range,
        )


def test_a_search_that_stops_short_names_the_bound() -> None:
    motion = lattice(124, seed=1).linkage().motion(36, input="j1", output="j7")
    assert motion.search.bound == "change-points"
    assert motion.search.unfollowed > 0
    assert "stopped short after the most places that may be change points" in how_found(motion)


def test_a_search_that_went_to_its_end_names_no_bound() -> None:
    assert as_dict(sb.load("rssr").motion(12))["search_bound"] is None


def answers(
    extents: Sequence[float], *, closes: float = 1.0, dead_centres: int = 2, **more: object
) -> Answers:
    """Answers with a circuit of each extent."""
    circuits = [{"closes": closes, "extent of the input": extent} for extent in extents]
    words = {"circuits": len(circuits), "dead centres": dead_centres, "some not followed": False} | {
        name.replace("_", " "): value for name, value in more.items() if name not in ("runs_off", "is_change")
    }
    plain = circuits if closes else []
    return Answers(
        words, [], circuits, {}, bool(more.get("is_change")), bool(more.get("runs_off")), plain=plain
    )


ANEW = Way("anew", sb.load("rssr"), "crank", "rocker")


def unexplained(drawn: Answers, written: Answers, way: Way = ANEW) -> list[str]:
    return [
        line.partition(":")[0]
        for line in differences(way, drawn, written)
        if not reason(way, drawn, written, line)
    ]


def test_that_slides_run_off_explains_how_far_they_were_followed_and_nothing_else() -> None:
    drawn = answers([1.0, 2.0], closes=0.0, runs_off=True)
    assert unexplained(drawn, answers([1.0, 2.1], closes=0.0, runs_off=True)) == []
    assert unexplained(drawn, answers([1.0, 2.1], closes=0.0)) == ["open circuit, extent of the input"]
    more = answers([1.0, 2.0], closes=0.0, runs_off=True, dead_centres=4)
    assert unexplained(drawn, more) == ["dead centres"]
    assert unexplained(drawn, answers([1.0], closes=0.0, runs_off=True)) == ["circuits"]


def test_that_slides_run_off_explains_how_fast_the_output_gets_on_the_way_and_no_more() -> None:
    def slow(lowest: float, **more: object) -> Answers:
        one = answers([1.0], closes=0.0, **more)
        one.circuits[0]["lowest velocity"] = lowest
        return one

    assert unexplained(slow(0.93, runs_off=True), slow(0.85, runs_off=True)) == []
    assert unexplained(slow(0.93, runs_off=True), slow(0.85)) == ["open circuit, lowest velocity"]


def test_that_no_pose_moves_explains_what_an_rssr_is_called_and_no_more() -> None:
    def still(word: str, points: int = 1, extents: Sequence[float] = ()) -> Answers:
        return answers(extents, is_change=True, motion_type=word, change_points=points)

    rolled = replace(ANEW, same_ground=False)
    assert unexplained(still("change-point"), still("rigid"), rolled) == []
    assert unexplained(still("change-point"), still("rigid")) == ["motion type"]
    assert unexplained(still("change-point", 0), still("rigid", 0), rolled) == ["motion type"]
    assert unexplained(still("change-point", 1, [1.0]), still("rigid", 1, [1.0]), rolled) == ["motion type"]


def test_that_an_output_is_held_explains_its_refusal_from_another_joint_on_and_no_other() -> None:
    def refused(end: str, idle: int) -> Answers:
        return Answers({"refused": "RequestError", "idle": idle}, [], [], {}, False, refused=end)

    drawn = answers([1.0], idle=1)
    rolled = replace(ANEW, same_ground=False)
    assert unexplained(drawn, refused("output", 1), rolled) == []
    assert unexplained(drawn, refused("output", 1)) == ["refused"]
    assert unexplained(drawn, refused("input", 1), rolled) == ["refused"]
    assert unexplained(drawn, refused("output", 3), rolled) == ["refused"]


def test_that_not_all_was_followed_hides_no_circuit_away_from_change_points() -> None:
    drawn = answers([1.0, 2.0], is_change=True, some_not_followed=True)
    broken = answers([1.0, 2.0, 0.5], closes=0.0, is_change=True, some_not_followed=True)
    broken.plain.extend(drawn.plain)
    assert unexplained(drawn, broken) == []
    # one of those that close and pass no change point is lost
    broken.plain.pop()
    assert unexplained(drawn, broken) == ["circuits"]
    # one says so, and has one that the other has not
    whole = answers([1.0, 3.0, 4.0], is_change=True)
    assert unexplained(drawn, whole) == ["circuits", "some not followed"]
    assert unexplained(drawn, answers([1.0, 2.0, 4.0], is_change=True)) == []


def test_a_way_that_is_refused_differs() -> None:
    drawn = answers([1.0])
    assert unexplained(drawn, Answers({"refused": "RequestError", "idle": 0}, [], [], {}, False)) == [
        "refused"
    ]
    assert unexplained(drawn, drawn) == []


def test_a_search_explains_circuits_that_it_missed_and_none_that_it_has_alone() -> None:
    counted = answers([1.0, 2.0], completeness="counted")
    assert unexplained(counted, answers([2.0], completeness="searched")) == []
    other = answers([3.0], completeness="searched")
    assert set(unexplained(counted, other)) == {"completeness", "circuits"}


def test_that_two_inputs_move_it_explains_the_freedoms_of_curves_that_touch_those_poses_and_no_others() -> (
    None
):
    def moving(extents: Sequence[float], finite: int, kind: str = "change-point", **more: object) -> Answers:
        word = kind if extents else "two-inputs"
        kinds = [kind] * len(extents)
        more = {"some_not_followed": True, "is_change": True} | more
        one = answers(
            extents, finite=finite, redundant=finite, motion_type=word, types_of_circuits=kinds, **more
        )
        return replace(one, plain=[])

    more = moving([], 2)
    assert unexplained(moving([1.0], 1), more) == []
    assert {"finite", "redundant"} <= set(unexplained(moving([1.0], 1, "crank-rocker"), more))
    assert {"finite", "redundant"} <= set(unexplained(moving([1.0], 1), moving([], 3)))
    refused = Answers({"refused": "RequestError", "idle": 0}, [], [], {}, False, refused="input")
    assert unexplained(more, refused) == []
    assert unexplained(moving([1.0], 1), refused) == ["refused"]


def test_that_a_peak_is_narrow_explains_velocities_where_all_else_agrees() -> None:
    def fast(highest: float, extent: float = 1.0) -> Answers:
        one = answers([extent])
        one.circuits[0]["highest velocity"] = highest
        return one

    assert unexplained(fast(-2e4), fast(-12.0)) == []
    assert unexplained(fast(20.0), fast(12.0)) == ["circuit, highest velocity"]
    assert "circuit, highest velocity" in unexplained(fast(-2e4), fast(-12.0, 1.1))


def test_that_modes_on_a_surface_are_met_or_not_explains_an_open_count_and_no_circuit() -> None:
    counted = answers([1.0], completeness="counted", some_not_followed=True)
    assert unexplained(counted, answers([1.0], completeness="algebraic")) == []
    assert "circuits" in unexplained(counted, answers([1.0, 2.0], completeness="algebraic"))


@pytest.mark.parametrize(("index", "moving"), [(2344, "theta_2"), (2368, "theta_3")])
def test_as_rows_a_loop_moves_whose_input_and_output_stand_still(index: int, moving: str) -> None:
    # no value of either joint but one closes: another's are asked
    rows = next(
        way for way in ways(lattice(index, seed=1), np.random.default_rng(1)) if way.name == "as rows"
    )
    with pytest.raises(RequestError, match=rf"stands still while others move.*{moving}"):
        rows.linkage.motion(36, input=rows.input, output=rows.output)


def test_a_drawn_loop_has_all_circuits_where_the_joints_asked_first_stand_still() -> None:
    linkage = lattice(2344, seed=1).linkage()
    by_slide, by_turn = (linkage.motion(36, input=name).circuits for name in ("j2", "j4"))
    assert len(by_slide) == len(by_turn) == 4


def test_of_three_slides_in_one_direction_two_are_idle_from_both_ends() -> None:
    # turns about the direction stand between two of them
    written = {way.name: way.linkage for way in ways(lattice(2073, seed=1), np.random.default_rng(1))}
    for name in ("as drawn", "from the other end", "as rows"):
        if linkage := written.get(name):
            assert len(linkage.idle) == 2
            assert linkage.motion(36).motion_type == "rigid"


def test_of_three_turns_on_one_axis_two_are_idle() -> None:
    places = [(0, 0, 0), (1, 2, 0), (1, 2, 1), (1, 2, 2), (4, 2, 0), (4, 0, 0)]
    joints = [{"name": f"j{i}", "kind": "R", "at": at, "axis": (0, 0, 1)} for i, at in enumerate(places)]
    linkage = sb.from_axes(joints, name="pins")
    assert len(linkage.idle) == 2
    assert linkage.motion(36).mobility.finite == 1


def test_a_pose_from_which_nothing_moves_is_refused_as_input_of_a_circuit() -> None:
    # 78: one at a change point, asked for on the way to a transmission angle
    places = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]
    joints = [{"name": f"j{i}", "kind": "R", "at": at, "axis": (0, 0, 1)} for i, at in enumerate(places)]
    with pytest.raises(RequestError, match="no motion through it could be followed"):
        sb.from_axes(joints, name="triangle").circuit(np.zeros(3), 12)


def test_the_page_says_which_loops_of_the_lattice_were_compared() -> None:
    found = {"lattice": [Compared(f"lattice {k}", ways=24) for k in (7, 0, 1, 2999)]}
    page = written(found, circumstances() | {"seed": 1})
    assert (
        "4 random loops with places and axes in whole numbers (of 3,000, those numbered 0 to 1, 7, 2999;"
        in page
    )
