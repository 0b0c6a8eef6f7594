"""The circuits of any loop: they close, they hold every mode, and no step jumps from one to another.

Source: the definition of a circuit as a connected set of closed poses, `Linkage.assembly_modes` (judged on its own
in test_loops_modes.py), and the closed form of the RSSR.

The set of circuits is established at 24 values of the input and 24 of another joint. A circuit that is narrower in both
may lie between: such misses are counted, have to be rare, and each missed circuit has to be narrow indeed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.random_linkages import Dimensions, mixed
from evidence.fuzz.random_loops import OVERCONSTRAINED, SPECIAL, Case, bennett, drawn, general
from gallery_sample import sampled
from sevenbar.errors import RequestError
from strategies import wrapped

#: Random linkages whose circuits are compared under half the step.
HALVED = {"few": 12, "many": 1_000}
LINKAGES = {"few": 6, "many": 60}

#: Rows that are the same pose: radians, places in parts of the size; what a well-conditioned row keeps of 1e-12.
SAME = 1e-7

#: Condition up to which rows are compared to that.
WELL = 1e4

#: The widest circuit [rad of the input] that the 24 values may miss, and the share of loops in which it may happen.
NARROW = np.radians(15)
RARE = 0.05

#: Kinds of answers that have no circuits to compare.
STILL = {"rigid", "not-followed", "two-inputs", "cannot-assemble"}

FAMILIES: dict[str, Callable[[np.random.Generator], Case]] = {
    "general": general,
    "drawn": drawn,
    **{
        name: SPECIAL[name]
        for name in (
            "three parallel axes",
            "right twists",
            "zero lengths",
            "spherical wrist",
            "one slide",
            "compound joints",
        )
    },
    **OVERCONSTRAINED,
}


@pytest.fixture(params=["few", pytest.param("many", marks=pytest.mark.proof)])
def amount(request: pytest.FixtureRequest) -> str:
    return request.param


def family_members(family: str, count: int) -> Iterator[tuple[int, sb.Linkage]]:
    for seed in range(count):
        yield seed, FAMILIES[family](np.random.default_rng([11, seed])).linkage()


def idle_links(loop: Loop, q: np.ndarray, column: int) -> np.ndarray:
    """The moving links (links,) that an idle freedom carries at rows (n, m)."""
    values = loop.stiffness(q, column)
    # a row far from dead centres: only what is idle is free there
    free = int((values < 1e-6).sum(axis=1).min())
    return loop.idle(q[np.argmax(values[:, values.shape[1] - free - 1])], column)[2]


def places(loop: Loop, q: np.ndarray, column: int, idle: np.ndarray | None = None) -> np.ndarray:
    """Where the links stand at rows (n, m), those that an idle freedom carries left out, (n, numbers)."""
    if len(q) == 0:
        return np.empty((0, 1))
    left = idle_links(loop, q, column) if idle is None else idle
    chosen = loop.poses(q)[:, ~left].reshape(len(q), -1)
    # an input that turns tells poses apart in which no other link moves
    angle = q[:, [column]] if loop.periodic[column] else q[:, [column]] / loop.size
    own = np.concatenate([np.cos(angle), np.sin(angle)], axis=1) if loop.periodic[column] else angle
    return np.concatenate([chosen, own], axis=1)


def distances(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(n, k) greatest differences of places."""
    return np.array([np.abs(second - row).max(axis=1) for row in first]).reshape(len(first), len(second))


def well(circuit: sb.Circuit) -> np.ndarray:
    return (circuit.status == "ok") & (circuit.condition < WELL)


# Each row


@pytest.mark.parametrize("family", FAMILIES)
def test_every_row_closes_and_rows_follow_each_other_without_a_jump(family: str, amount: str) -> None:
    judged = 0
    for seed, linkage in family_members(family, LINKAGES[amount]):
        loop = Loop.of(linkage)
        for circuit in linkage.motion(samples=180):
            assert len(circuit.q), (seed, circuit.index)
            assert np.isin(circuit.status, ["ok", "dead-centre", "change-point"]).all(), seed
            assert loop.errors(circuit.q).max() < 1e-10, seed
            assert circuit.residual.max() < 1e-10 * loop.size, seed
            judged += _steps_agree_with_rates(circuit, loop, seed)
    assert judged > 50 * LINKAGES[amount]


def _steps_agree_with_rates(circuit: sb.Circuit, loop: Loop, seed: int) -> int:
    """The corrected trapezium rule on velocities and accelerations at both ends of a step gives the step."""
    column = circuit.input_column
    _, idle, _ = loop.idle(circuit.q[len(circuit.q) // 2], column)
    kept = np.flatnonzero(~idle)
    speed = circuit.dq[circuit.status == "ok"][:, column]
    if speed.size == 0:
        return 0
    h = np.diff(circuit.q[:, column]) / speed[0]
    q, dq, ddq = (values[:, kept] for values in (circuit.q, circuit.dq, circuit.ddq))
    rule = h[:, None] / 2 * (dq[:-1] + dq[1:]) - h[:, None] ** 2 / 12 * (ddq[1:] - ddq[:-1])
    error = np.abs(np.diff(q, axis=0) - rule) / loop.scales[kept]
    # where a step is a small part of the way that rates change over, the rule's next term is small beside
    bend = np.abs(h[:, None] ** 3 * np.maximum(np.abs(circuit.dddq[:-1]), np.abs(circuit.dddq[1:]))[:, kept])
    calm = (bend / loop.scales[kept]).max(axis=1) < 1e-3
    calm &= well(circuit)[:-1] & well(circuit)[1:]
    assert error[calm].max(initial=0.0) < 2e-3, seed
    return int(calm.sum())


@pytest.mark.parametrize("family", FAMILIES)
def test_a_closed_circuit_returns_to_its_first_row_and_holds_no_row_twice(family: str, amount: str) -> None:
    met = 0
    for seed, linkage in family_members(family, LINKAGES[amount]):
        loop = Loop.of(linkage)
        for circuit in linkage.motion(samples=120):
            if not circuit.closed or len(circuit.q) < 8:
                continue
            met += 1
            at = places(loop, circuit.q, circuit.input_column)
            steps = np.abs(np.roll(at, -1, axis=0) - at).max(axis=1)
            assert steps[-1] < 3 * steps[:-1].max(), seed
            if circuit.goes_round:
                # once or twice round, on the grid
                turned = (circuit.q[-1] - circuit.q[0])[circuit.input_column]
                assert abs(abs(turned) + 2 * np.pi / 120 - 2 * np.pi * circuit.turns) < 1e-9, seed
                assert len(circuit.q) == 120 * circuit.turns, seed
            chosen = at[well(circuit)]
            between = distances(chosen, chosen) + np.eye(len(chosen))
            assert between.min(initial=1.0) > 1e-9, seed
    assert met > LINKAGES[amount] / 3


# All modes lie on circuits


@pytest.mark.parametrize("family", FAMILIES)
def test_each_mode_at_an_input_lies_on_exactly_one_row_of_one_circuit(family: str, amount: str) -> None:
    samples = 36
    compared = 0
    lacking: dict[object, float] = {}
    for seed, linkage in family_members(family, LINKAGES[amount]):
        loop = Loop.of(linkage)
        motion = linkage.motion(samples=samples)
        if motion.motion_type in STILL or motion.motion_type == "change-point":
            continue
        rng = np.random.default_rng(seed)
        if loop.periodic[0]:
            inputs = 2 * np.pi * rng.choice(samples, 6, replace=False) / samples
        else:
            inputs = np.array([q[rng.integers(len(q)), 0] for q in (c.q for c in motion)][:6])
        for theta in inputs:
            rows = []
            for circuit in motion:
                apart = circuit.q[:, 0] - theta
                apart = wrapped(apart) if loop.periodic[0] else apart / loop.size
                rows.append(circuit.q[(np.abs(apart) < 1e-9) & (circuit.status == "ok")])
            lying = np.concatenate(rows)
            modes = linkage.assembly_modes(theta).q
            firm = loop.stiffness(np.concatenate([lying, modes]), 0)
            count = _idle_count(loop, lying, modes)
            if len(firm) == 0 or firm[:, firm.shape[1] - count - 1].min() < 1e-4:
                continue  # a pose at a dead centre, or so near that two are one
            idle = idle_links(loop, np.concatenate([lying, modes]), 0)
            apart = distances(places(loop, lying, 0, idle), places(loop, modes, 0, idle))
            assert apart.min(axis=1, initial=np.inf).max(initial=0.0) < SAME, (seed, theta)
            # each circuit of a sliding input has its own grid
            if loop.periodic[0]:
                assert len(set(apart.argmin(axis=1))) == len(lying) if len(lying) else True, (seed, theta)
                for q in modes[apart.min(axis=0, initial=np.inf) > SAME]:
                    lacking[seed] = max(lacking.get(seed, 0.0), loop.span(q, 0))
            compared += len(modes)
    assert compared > LINKAGES[amount]
    _only_narrow_circuits_are_missed(lacking, LINKAGES[amount])


def _only_narrow_circuits_are_missed(lacking: Mapping[object, float], loops: int) -> None:
    """`lacking` holds the widest missed circuit [rad] of each loop that lacks one."""
    # shown with -rP: how often it happens
    print(f"{len(lacking)} of {loops} loops lack a circuit, spans {np.degrees(list(lacking.values()))}")  # noqa: T201
    assert all(span < NARROW for span in lacking.values()), lacking
    assert len(lacking) <= max(1, RARE * loops), lacking


def _idle_count(loop: Loop, *rows: np.ndarray) -> int:
    q = np.concatenate(rows)
    return min((loop.idle(row, 0)[0] for row in q[:4]), default=0)


@pytest.mark.parametrize("family", ["general", "drawn", "right twists", "compound joints"])
def test_modes_come_or_go_at_each_limit_and_nowhere_else(family: str, amount: str) -> None:
    met = 0
    lacking: dict[object, float] = {}
    for seed, linkage in family_members(family, LINKAGES[amount]):
        loop = Loop.of(linkage)
        motion = linkage.motion(samples=36)
        if motion.motion_type in STILL or not loop.periodic[0] or len(motion.change_points):
            continue
        # where slides run to infinity circuits end at no limit
        if not all(circuit.closed for circuit in motion):
            continue
        limits = np.asarray(motion.limits)
        assert (np.diff(limits) > 0).all()
        assert ((limits >= 0) & (limits < 2 * np.pi)).all()
        ends = np.concatenate([limits, limits[:1] + 2 * np.pi]) if limits.size else np.array([0.0, 2 * np.pi])
        counts = []
        for low, high in zip(ends[:-1], ends[1:], strict=True):
            if high - low > 1e-4:
                inside = low + (high - low) * np.array([1e-2, 0.37, 0.81, 1 - 1e-2])
                every = [linkage.assembly_modes(theta).q for theta in inside]
                numbers = {len(q) for q in every}
                if len(numbers) > 1:
                    spans = [loop.span(q, 0) for rows in every for q in rows]
                    assert min(spans) < NARROW, (seed, low, high)
                    lacking[seed] = min(spans)
                    break
                counts.append(numbers.pop())
        if limits.size and len(counts) == limits.size:
            steps = np.abs(np.diff([counts[-1], *counts]))
            # two circuits may have a limit in common, never an odd number of modes
            assert (steps[steps > 0] % 2 == 0).all(), seed
            assert (steps > 0).sum() >= limits.size - 1, seed
        met += limits.size
    assert met > LINKAGES[amount] / 2
    _only_narrow_circuits_are_missed(lacking, LINKAGES[amount])


@pytest.mark.parametrize("family", ["general", "drawn", "zero lengths", "one slide", "compound joints"])
def test_the_input_stands_still_at_a_dead_centre(family: str, amount: str) -> None:
    met = 0
    for seed, linkage in family_members(family, LINKAGES[amount]):
        loop = Loop.of(linkage)
        for circuit in linkage.motion(samples=36):
            rows = np.flatnonzero(circuit.status == "dead-centre")
            firm = np.flatnonzero(circuit.status == "ok")
            for row in rows:
                assert np.isnan(circuit.dq[row]).all()
                count = (
                    loop.idle(circuit.q[firm[len(firm) // 2]], circuit.input_column)[0] if firm.size else 0
                )
                held = loop.stiffness(circuit.q[row], circuit.input_column)[0]
                # the square of the angle that is left over is the error of the input
                assert held[len(held) - count - 1] < 1e-6, seed
                met += 1
            ends = [d.input for d in circuit.dead_centres if d.kind == "input"]
            assert len(ends) >= len(rows), seed
            if circuit.goes_round:
                assert rows.size == 0, seed
    assert met > LINKAGES[amount] / 2


# No silent change of mode


def same_circuits(linkage: sb.Linkage, samples: int, name: object, input: str | None = None) -> None:
    """Twice the samples give the same circuits, and the same rows at inputs that both have."""
    coarse, fine = (linkage.motion(samples=n, input=input) for n in (samples, 2 * samples))
    assert coarse.motion_type == fine.motion_type, name
    assert len(coarse.circuits) == len(fine.circuits), name
    np.testing.assert_allclose(coarse.limits, fine.limits, rtol=0, atol=1e-8, err_msg=str(name))
    if coarse.motion_type in STILL:
        return
    loop = Loop.of(linkage)
    column = coarse.circuits[0].input_column if coarse.circuits else 0
    idle = idle_links(loop, np.concatenate([circuit.q for circuit in fine]), column)
    every = [places(loop, circuit.q, column, idle) for circuit in fine]
    partners = []
    for circuit in coarse:
        chosen = np.flatnonzero(well(circuit))
        if chosen.size == 0:
            continue
        rows = places(loop, circuit.q[chosen], column, idle)
        apart = [distances(rows, other).min(axis=1) for other in every]
        on = int(np.argmin([a.max() for a in apart]))
        partner = fine.circuits[on]
        if loop.periodic[column]:
            assert apart[on].max() < 1e-6, (name, circuit.index, apart[on].max())
        assert partner.motion_type == circuit.motion_type, name
        assert partner.closed == circuit.closed, name
        assert partner.turns == circuit.turns, name
        assert len(partner.dead_centres) == len(circuit.dead_centres), name
        for ours, theirs in (
            (circuit.input_range, partner.input_range),
            (circuit.output_range, partner.output_range),
        ):
            assert (ours is None) == (theirs is None), name
        partners.append(on)
    assert len(set(partners)) == len(partners), name


@pytest.mark.parametrize("name", sampled())
def test_half_the_step_gives_the_same_circuits_of_the_gallery(name: str) -> None:
    for samples in (45, 180, 360):
        same_circuits(sb.load(name), samples, name)


def test_half_the_step_gives_the_same_circuits_of_random_loops(amount: str) -> None:
    families = list(FAMILIES.values())
    for seed in range(HALVED[amount]):
        # half of them general, the other half special in turn
        family = general if seed % 2 else families[seed // 2 % len(families)]
        linkage = family(np.random.default_rng([12, seed])).linkage()
        same_circuits(linkage, 90, seed, input_that_moves(linkage))


def input_that_moves(linkage: sb.Linkage) -> str | None:
    """Another input where the usual one stands still while other joints move; else `None`."""
    try:
        linkage.motion(samples=8)
    except RequestError as refused:
        _, _, others = str(refused).partition("cannot drive; give another: ")
        assert others, refused
        return others.split(", ")[0]
    return None


# Any joint can be the input


@pytest.mark.parametrize(
    "family", ["general", "drawn", "right twists", "Bennett", "planar 4R", "spherical 4R"]
)
def test_driven_from_the_other_end_it_runs_through_the_same_circuits(family: str, amount: str) -> None:
    compared = 0
    for seed, linkage in family_members(family, LINKAGES[amount] // 2 or 1):
        loop = Loop.of(linkage)
        first, last = linkage.columns[0], linkage.columns[-1]
        there = linkage.motion(samples=240, input=first, output=last)
        back = linkage.motion(samples=240, input=last, output=first)
        if there.motion_type in STILL or "change-point" in (there.motion_type, back.motion_type):
            continue
        assert len(there.circuits) == len(back.circuits), seed
        lines = [_cyclic(circuit.q, loop) for circuit in back]
        partners = set()
        for circuit in there:
            rows = circuit.q[well(circuit)][::5]
            near = [_to_line(_cyclic(rows, loop), line) for line in lines]
            on = {int(k) for k in np.argmin(near, axis=0)}
            # rows of two circuits that pass close by may be nearer to the other's chords
            share = [np.mean(np.argmin(near, axis=0) == k) for k in on]
            assert max(share, default=1.0) > 0.9, seed
            if on:
                partners.add(max(on, key=lambda k: np.mean(np.argmin(near, axis=0) == k)))
            for q in rows[:: max(1, len(rows) // 3)]:
                held = loop.stiffness(q, loop.count - 1)[0]
                if held.min() > 1e-3:
                    modes = linkage.assembly_modes(q[-1], input=last).q
                    assert distances(places(loop, q[None], 0), places(loop, modes, 0)).min() < SAME, seed
                    compared += 1
        assert len(partners) == len(there.circuits), seed
    assert compared > LINKAGES[amount] / 2


def _cyclic(q: np.ndarray, loop: Loop) -> np.ndarray:
    turning = loop.periodic
    return np.concatenate([np.cos(q[:, turning]), np.sin(q[:, turning]), q[:, ~turning] / loop.size], axis=1)


def _to_line(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance of each point to the closed polygon."""
    start, along = line, np.roll(line, -1, axis=0) - line
    length = np.maximum((along * along).sum(axis=1), 1e-300)
    result = np.empty(len(points))
    for k, point in enumerate(points):
        share = np.clip(((point - start) * along).sum(axis=1) / length, 0, 1)
        result[k] = np.linalg.norm(start + share[:, None] * along - point, axis=1).min()
    return result


# The RSSR as a case of the general loop


def rssrs(count: int) -> Iterator[tuple[object, sb.Linkage]]:
    yield "paper", sb.rssr(M=700, N=700, L1=250, L3=550, D=0)
    for seed, description in enumerate(mixed(np.random.default_rng(21), count)):
        yield (seed, isinstance(description, Dimensions)), description.linkage()


def test_the_rssr_by_the_general_path_equals_its_closed_form(amount: str) -> None:
    compared = 0
    lacking: dict[object, float] = {}
    for name, linkage in rssrs(2 * LINKAGES[amount]):
        for driver in ("crank", "rocker"):
            exact = linkage.motion(samples=72, input=driver)
            got = linkage.motion(samples=72, input=driver, method="general")
            if len(exact.change_points):
                continue
            spans = sorted(np.ptp(c.input_range) for c in exact if c.input_range is not None)
            few = len(exact.circuits) - len(got.circuits)
            if 0 < few <= len(spans) and spans[few - 1] < NARROW:
                lacking[name] = spans[few - 1]
                continue
            assert got.motion_type == exact.motion_type, (name, driver)
            assert len(got.circuits) == len(exact.circuits), (name, driver)
            np.testing.assert_allclose(got.limits, exact.limits, rtol=0, atol=1e-9)
            for circuit in got:
                compared += _rows_agree(circuit, exact, name)
    assert compared > 100 * LINKAGES[amount]
    _only_narrow_circuits_are_missed(lacking, 2 * LINKAGES[amount])


def _rows_agree(circuit: sb.Circuit, exact: sb.Motion, name: object) -> int:
    compared = 0
    partners = set()
    for row in np.flatnonzero(well(circuit)):
        best, at, where = np.inf, 0, exact.circuits[0]
        for other in exact:
            same = np.abs(wrapped(other.input - circuit.input[row])) < 1e-9
            apart = np.abs(wrapped(other.output - circuit.output[row]))
            apart[~same] = np.inf
            if apart.min() < best:
                best, at, where = float(apart.min()), int(apart.argmin()), other
        condition = max(1.0, float(where.condition[at]))
        if condition > WELL:
            continue
        partners.add(where.index)
        # what a rounding of the dimensions makes of the angle, and no more
        assert best < 1e-12 * max(1.0, condition / 100), (name, best, condition)
        column = circuit.output_column
        for order, values in enumerate(("dq", "ddq", "dddq"), 1):
            ours, theirs = getattr(circuit, values)[row, column], getattr(where, values)[at, column]
            tolerance = 1e-12 * 10.0 ** (order - 1) * max(1.0, condition / 100)
            assert abs(ours - theirs) <= tolerance * max(1.0, abs(theirs)), (name, values, condition)
        compared += 1
    assert len(partners) <= 1, name
    return compared


def test_extremes_of_rates_stand_where_the_closed_form_has_them_though_values_hide_the_place() -> None:
    # within 1e-8 rad of an extreme all values are equal but for rounding
    compared = 0
    for name, linkage in rssrs(20):
        exact, got = linkage.motion(samples=72), linkage.motion(samples=24, method="general")
        if len(exact.change_points) or len(exact.circuits) != len(got.circuits):
            continue
        for circuit in got:
            partner = min(exact, key=lambda c: np.abs(wrapped(c.output[0] - circuit.output[0])))
            for rate in ("velocity", "acceleration", "jerk"):
                ours, theirs = getattr(circuit, rate), getattr(partner, rate)
                if ours is None or theirs is None or partner.condition.max() > 1e3:
                    continue
                for end in ("lowest", "highest"):
                    value, want = getattr(ours, end), getattr(theirs, end)
                    assert value == pytest.approx(want, rel=1e-10, abs=1e-10), (name, rate, end)
                    apart = wrapped(np.array(getattr(ours, f"{end}_at") - getattr(theirs, f"{end}_at")))
                    assert abs(apart) < 1e-11, (name, rate, end)
                    compared += 1
    assert compared > 20


# Formulas of overconstrained loops


def test_bennetts_half_angle_tangents_have_a_constant_product() -> None:
    for seed in range(20):
        case = bennett(np.random.default_rng(seed))
        motion = case.linkage().motion(samples=72)
        want = np.tan(case.pose[0] / 2) * np.tan(case.pose[1] / 2)
        assert len(motion.circuits) == 1
        for circuit in motion:
            first, second = circuit.q[:, 0] / 2, circuit.q[:, 1] / 2
            # cross-multiplied: the tangents themselves pass through infinity
            numbers = np.sin(first) * np.sin(second) - want * np.cos(first) * np.cos(second)
            assert np.abs(numbers).max() < 1e-13 * (1 + abs(want)), seed


# One circuit through a pose


@pytest.mark.parametrize("name", ["seven_r", "rssr", "rccc", "rsur", "rssp", "bennett", "six_bar"])
def test_the_circuit_through_a_pose_is_the_one_that_the_motion_has_there(name: str) -> None:
    linkage = sb.load(name)
    for whole in linkage.motion(samples=36, method="general"):
        pose = whole.q[np.flatnonzero(whole.status == "ok")[5]]
        one = linkage.circuit(pose, samples=36)
        assert (one.motion_type, len(one.q), one.closed) == (whole.motion_type, len(whole.q), whole.closed)
        # the same rows, though another may come first
        gap = [np.nanmin(np.nanmax(np.abs(wrapped(whole.q - q)), axis=1)) for q in one.q[one.status == "ok"]]
        assert max(gap) < 1e-8


def test_a_rough_pose_is_closed_and_one_that_does_not_close_is_refused() -> None:
    linkage = sb.load("seven_r")
    pose = linkage.assembly_modes(0.3).q[2]
    rough = pose + np.array([0, 1, -1, 1, -1, 1, -1]) * 1e-3
    near = linkage.circuit(rough, samples=36)
    assert np.abs(wrapped(near.q - pose)).max(axis=1).min() < 0.2
    with pytest.raises(RequestError, match="does not close near it"):
        linkage.circuit(pose + 0.5)
    with pytest.raises(RequestError, match="3 values where the linkage has 7 columns"):
        linkage.circuit(pose[:3])
