"""The rows of a sweep are the numbers of the ordinary analysis, one linkage after the other."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.kinematics.measures import MEASURES
from sevenbar.sweep import grid, run, span
from sevenbar.sweep.batches import batched
from sevenbar.sweep.ordinary import analysed as analysed_by_themselves
from sevenbar.sweep.plan import SweepPlan
from sevenbar.sweep.rows import part_table

#: A crank too long, a drive that stands still, a linkage that cannot be assembled, crank-rockers, others.
AXES = {"L1": [-1.0, 0.0, 1.0, 250.0, 400.0, 900.0], "L2": [20.0, 1000.0], "speed": [0.0, -10.0, 3.0]}


def analysed(measures: list[str], *, input: str | None = None) -> list[dict[str, object]]:
    """Rows as a person would make them: each linkage analysed, each circuit asked."""
    rows: list[dict[str, object]] = []
    for index, (L1, L2, speed) in enumerate(itertools.product(*AXES.values())):
        row: dict[str, object] = {"linkage": index, "L1_mm": L1, "L2_mm": L2, "speed_rad_s": speed}
        try:
            motion = sb.rssr(M=700, N=700, L1=L1, L3=550, D=0, L2=L2, speed=speed).motion(90, input=input)
        except sb.errors.SevenbarError:
            rows.append(row | {"circuit": None} | dict.fromkeys(measures))
            continue
        shared = {name: MEASURES[name].value(motion) for name in measures if MEASURES[name].per == "linkage"}
        for circuit in motion.circuits or [None]:
            own = {
                name: None if circuit is None else MEASURES[name].value(circuit)
                for name in measures
                if MEASURES[name].per == "circuit"
            }
            rows.append(row | {"circuit": None if circuit is None else circuit.index} | shared | own)
    return rows


@pytest.mark.parametrize("input", [None, "rocker"])
def test_every_measure_of_every_linkage_is_that_of_its_analysis(input: str | None) -> None:
    measures = list(MEASURES)
    table = run(sb.load("rssr"), AXES, measures, input=input, part_size=7, threads=2).table()
    names = ["linkage", "L1_mm", "L2_mm", "speed_rad_s", "circuit", *measures]
    output = "crank" if input else "rocker"
    linkage = sb.load("rssr")
    columns = [*names[:5], *(MEASURES[name].column(linkage, output) for name in measures)]
    expected = analysed(measures, input=input)
    found = table.select(columns).to_pylist()
    assert len(found) == len(expected)
    for row, wanted in zip(found, expected, strict=True):
        for column, name in zip(columns, names, strict=True):
            assert row[column] == (
                pytest.approx(wanted[name], rel=1e-9, abs=1e-9)
                if isinstance(wanted[name], float)
                else wanted[name]
            ), (row["linkage"], name)
    assert {row["motion_type"] for row in expected} >= {None, "cannot-assemble"}


def test_a_linkage_that_cannot_be_keeps_its_row_and_says_why() -> None:
    table = run(
        sb.load("rssr"), {"L1": [-1.0, 250.0], "speed": [0.0, 1.0]}, ["motion_type", "limits"]
    ).table()
    assert table["status"].to_pylist() == [
        "drive.speed: '0 rad/s' moves nothing; give a finite speed other than 0, as in '10 rad/s'; "
        "rssr.L1: -1 is not a length; give a number > 0",
        "rssr.L1: -1 is not a length; give a number > 0",
        "drive.speed: '0 rad/s' moves nothing; give a finite speed other than 0, as in '10 rad/s'",
        "ok",
    ]
    assert table["motion_type"].to_pylist() == [None, None, None, "crank-rocker"]
    assert table["limits"].to_pylist() == [None, None, None, 0]


def test_limits_are_where_the_coupler_is_stretched_or_folded() -> None:
    table = run(
        sb.load("rssr"), {"M": span(300, 900), "L1": span(100, 900), "L2": span(400, 1200), "D": span(-90, 90)},
        ["limits"], method="random", count=300, seed=4,
    ).table()  # fmt: skip
    assert set(table["limits"].to_pylist()) >= {0, 2}
    for row in table.to_pylist():
        angles = [row[f"limit_{place}_deg"] for place in range(1, 5)]
        given = [angle for angle in angles if angle is not None]
        assert len(given) == row["limits"]
        assert angles[len(given) :] == [None] * (4 - len(given))
        assert given == sorted(given)
        for angle in map(math.radians, given):
            M, N, L1, L2, L3, D = row["M_mm"], 700.0, row["L1_mm"], row["L2_mm"], 550.0, row["D_mm"]
            A = np.array([L1 * math.cos(angle), L1 * math.sin(angle), N]) - (M, D, 0)
            # the rocker's ball goes round in the plane x = M; from A the nearest and farthest of its places
            across = math.hypot(A[1], A[2])
            reach = [math.hypot(A[0], across - L3), math.hypot(A[0], across + L3)]
            assert min(abs(r - L2) for r in reach) < 1e-6


@pytest.mark.parametrize("follow", [(), ("L2",)])
@pytest.mark.parametrize("measure", ["limits", lambda motion: len(motion.limits)])
def test_a_length_that_the_file_leaves_out_is_held_or_follows_from_the_others(follow, measure) -> None:
    axes = {"L1": grid(100, 400, 9), "N": [600, 700], "D": [0.0, 30.0]}
    found = run(sb.load("rssr"), axes, ["motion_type", measure], follow=follow)
    table = found.table()
    rod = None if follow else math.sqrt(450**2 + 550**2 + 700**2)
    explicit = [
        sb.rssr(M=700, N=N, L1=L1, L3=550, D=D, L2=rod).motion()
        for L1, N, D in zip(*(table[name].to_pylist() for name in ("L1_mm", "N_mm", "D_mm")), strict=True)
    ]
    assert table["motion_type"].to_pylist() == [motion.motion_type for motion in explicit]
    limits = table[table.column_names[table.column_names.index("motion_type") + 1]].to_pylist()
    assert limits == [len(motion.limits) for motion in explicit]
    assert found.description["follow"] == list(follow)
    assert found.description["held"] == {"M": 700, "L3": 550} | ({} if follow else {"L2": rod})


def test_the_linkages_of_a_sweep_differ_where_the_rod_follows() -> None:
    axes = {"L1": grid(100, 400, 9)}
    held, following = (run(sb.load("rssr"), axes, follow=follow).description for follow in ((), ["L2"]))
    assert held["mark"] != following["mark"]
    assert "L2 = 997.49" in held["toml"]
    assert "L2" not in following["toml"]


def test_what_is_swept_cannot_follow() -> None:
    with pytest.raises(RequestError, match="follow: L2 is swept itself; leave one of the two out"):
        run(sb.load("rssr"), {"L2": [900, 1000]}, follow=["L2"])


def test_a_general_loop_is_swept_with_angles_in_degrees() -> None:
    table = run(sb.load("seven_r"), {"twist_1": [40.0, 75.0]}, ["motion_type", "circuits", "swing"]).table()
    draft = Draft.of_linkage(sb.load("seven_r"))
    for index, twist in enumerate([40.0, 75.0]):
        motion = draft.with_values({"twist_1": twist}).linkage.motion(90)
        own = [row for row in table.to_pylist() if row["linkage"] == index]
        assert [row["circuit"] for row in own] == [circuit.index for circuit in motion]
        assert {row["circuits"] for row in own} == {len(motion.circuits)}
        for row, circuit in zip(own, motion, strict=True):
            swing = None if circuit.swing is None else pytest.approx(math.degrees(circuit.swing), rel=1e-9)
            assert row["swing_deg"] == swing


def residual(motion: sb.Motion) -> float | None:
    """The greatest closure error."""
    return max((float(circuit.residual.max()) for circuit in motion), default=None)


def test_a_function_of_the_motion_is_a_column() -> None:
    found = run(sb.load("rssr"), {"L2": [20.0, 1000.0]}, ["motion_type", residual])
    assert found.table()["residual"].to_pylist()[0] is None
    assert 0 < found.table()["residual"].to_pylist()[1] < 1e-9
    assert found.description["measures"][1]["function"] == "test_sweep_rows:residual"


def fails(motion: sb.Motion) -> float:
    return 1 / len(motion.circuits)


def word(_motion: sb.Motion) -> float:
    return "ten"  # type: ignore[return-value]


def status(_motion: sb.Motion) -> float:
    return 1.0


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (
            fails,
            "measure: fails fails for linkage 1: ZeroDivisionError: division by zero; give a function of",
        ),
        (word, "measure: word gives 'ten' for linkage 0; give a number or None"),
        (status, "measure: column 'status' would appear twice in the table; give the function another name"),
    ],
)
def test_a_function_that_does_not_fit_is_told_with_the_linkage(function: object, message: str) -> None:
    with pytest.raises(RequestError) as caught:
        run(sb.load("rssr"), {"L2": [1000.0, 20.0]}, ["motion_type", function])  # type: ignore[list-item]
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"measures": ["swng"]}, "measure: 'swng' is not a measure; did you mean 'swing'?"),
        ({"samples": 1}, "samples: 1 is not a count; give 4 to 1000000"),
        ({"input": "ball_a"}, "input: joint 'ball_a' is a ball"),
        ({"part_size": 0}, "part_size: 0 is not a count of linkages; give 1 to 1048576"),
        ({"threads": 0}, "threads: 0 is not a count of threads; give 1 to 4096"),
        ({"threads": 1, "scheduler": "tcp://x:1"}, "threads: workers of a scheduler have their own; leave"),
        (
            {"count": 10**8, "method": "random"},
            "out: missing; 100000000 linkages are more than memory should",
        ),
    ],
)
def test_a_wrong_request_is_told_before_anything_is_made(asked: dict, message: str) -> None:
    with pytest.raises(RequestError) as caught:
        run(sb.load("rssr"), {"L1": [250.0]}, **asked)
    assert str(caught.value).startswith(message)


def test_totals_are_those_of_the_rows() -> None:
    found = run(
        sb.load("rssr"), {"L1": grid(-100, 900, 60), "L3": [300, 550]}, ["motion_type", "swing"], part_size=11
    )
    frame = found.frame()
    totals = found.totals
    assert (totals.linkages, totals.rows) == (120, len(frame))
    firsts = frame.drop_duplicates("linkage")
    assert totals.invalid == int((firsts["status"] != "ok").sum()) > 0
    assert totals.words == {"motion_type": firsts["motion_type"].value_counts().to_dict()}
    extent = totals.ranges["swing_deg"]
    assert extent is not None
    assert (extent.lowest, extent.highest, extent.rows) == (
        frame["swing_deg"].min(), frame["swing_deg"].max(), frame["swing_deg"].count(),
    )  # fmt: skip
    assert extent.highest_at == frame["linkage"][frame["swing_deg"].idxmax()]


@pytest.mark.parametrize("measures", [["motion_type", "limits"], ["motion_type", "circuits"], list(MEASURES)])
@pytest.mark.parametrize("input", ["crank", "rocker"])
def test_linkages_measured_all_at_once_have_the_rows_of_linkages_one_by_one(
    measures: list[str], input: str
) -> None:
    places = {
        "M": span(-900, 900),
        "N": span(-900, 900),
        "L1": span(-20, 900),
        "L3": span(20, 900),
        "D": span(-90, 90),
    }
    # the same lengths and offsets again and again make change points; some sizes are refused, some are lost
    even = {
        "M": [0.0, 300.0],
        "L1": [0.0, 1e-120, 1e-40, 300.0, 600.0],
        "L2": [300.0, 600.0, 1e101],
        "D": [0.0, 300.0],
    }
    draft = Draft.of_linkage(sb.rssr(M=300, N=300, L1=300, L3=300, D=0, L2=300, speed=-3.0))
    for linkage, axes, asked in (
        (sb.load("rssr"), places, {"method": "random", "count": 250, "seed": 1}),
        (draft, even, {}),
    ):
        plan = SweepPlan.of(linkage, axes, measures, input=input, part_size=300, **asked)
        found = part_table(plan, 0).to_pylist()
        values = plan.space.values(0, plan.space.count)
        assert len(batched(plan, values, 1)[1]) < plan.space.count
        wanted = analysed_by_themselves(plan, values, 0, np.arange(plan.space.count))
        assert [row["linkage"] for row in found] == wanted.linkage.tolist()
        assert [row["status"] for row in found] == wanted.status.tolist()
        for name, column in wanted.columns.items():
            key = next(field for field in found[0] if field == name or field.startswith(f"{name}_"))
            for row, value in zip(found, column.tolist(), strict=True):
                if value is None or isinstance(value, str):
                    assert row[key] == value
                else:
                    near = None if math.isnan(value) else pytest.approx(value, rel=1e-8, abs=1e-8)
                    assert row[key] == near, (row["linkage"], name)


@pytest.mark.parametrize("given", [grid(-5, -1, 3), span(-5, 0), [-1.0, 0.0]])
def test_values_of_a_length_of_which_none_is_one_are_refused(given):
    with pytest.raises(
        RequestError, match=r"over: L1: no value is a length, the highest is (-1|0); give values above 0"
    ):
        SweepPlan.of(sb.load("rssr"), {"L1": given}, ["limits"], count=3)
