"""Velocity, acceleration and jerk against 80-digit numbers from the closure alone.

Source: `reference_rssr.PreciseRssr`: Newton's method on |A - B|^2 = L2^2 and central differences with a
step of 1e-20; no derivative is written out anywhere. That reference is itself held against mpmath's
derivative of the paper's eq. (8).

What is compared: the error of a k-th derivative over the exact value, or over 1 (the input's own rate, to
the power of the order) where the exact value is smaller: near an output dead centre a velocity passes zero
and has no relative error. The three turns of a ball and the three coordinates of a point are compared as
one vector, a point in units of the size. The condition is that of design.md's "away from dead centres", as
`Circuit.condition` gives it; no method that rounds its dimensions once can do better than 2^-53 times it,
and the tests below leave a small factor on that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_rssr import DIGITS, PreciseRssr
from evidence.fuzz.random_linkages import Dimensions, Drawing, assembled_square, nearly_parallel, skew

ROUNDING = 2.0**-53

#: Velocity, acceleration, jerk.
RELATIVE = (1e-12, 1e-11, 1e-10)


@pytest.fixture(autouse=True)
def eighty_digits() -> Iterator[None]:
    with mp.workdps(DIGITS):
        yield


def inputs_towards_limits(rng: np.random.Generator, linkage: sb.Linkage, driver: str) -> np.ndarray:
    """Rising inputs, some anywhere and some 1e-8 to 1e-1 from every limit."""
    inputs = [rng.uniform(0, 2 * np.pi, 2)]
    for limit in linkage.motion(samples=4, input=driver).limits:
        apart = 10 ** rng.uniform(-8, -1, size=2)
        inputs += [limit - apart, limit + apart]
    return np.unique(np.concatenate(inputs))


@dataclass(frozen=True)
class Error:
    """Relative errors of three derivatives of one quantity at one pose."""

    condition: float
    relative: tuple[float, ...]


def relative_errors(
    got: np.ndarray, exact: Sequence[Sequence[mp.mpf]], rates: tuple[float, ...]
) -> tuple[float, ...]:
    """Of each derivative of a vector: the greatest error over the greatest exact component."""
    unit = max(1.0, *map(abs, rates))
    errors = []
    for order in (1, 2, 3):
        want = [component[order] for component in exact]
        size = max(unit**order, *(abs(w) for w in want))
        errors.append(
            max(float(abs(mp.mpf(float(g)) - w) / size) for g, w in zip(got[:, order - 1], want, strict=True))
        )
    return tuple(errors)


def squared_axes(rng: np.random.Generator) -> Dimensions:
    return assembled_square(rng)


def drawn_axes(rng: np.random.Generator) -> Drawing:
    return skew(rng) if rng.random() < 0.5 else nearly_parallel(rng)


FORMS = {"square": squared_axes, "drawn": drawn_axes}


def output_errors(form: str, seed: int, linkages: int) -> list[Error]:
    """Both branches of `output`, both inputs, at constant speed and under a law."""
    rng = np.random.default_rng(seed)
    errors = []
    for _ in range(linkages):
        description = FORMS[form](rng)
        linkage, precise = description.linkage(), description.reference().precise()
        for driver in ("crank", "rocker"):
            inputs = inputs_towards_limits(rng, linkage, driver)
            for rates in ((1.0, 0.0, 0.0), tuple(rng.uniform(-2, 2, size=3))):
                speed, acceleration, jerk = rates
                constant = rates[1:] == (0.0, 0.0)
                law = {} if constant else {"acceleration": acceleration, "jerk": jerk}
                speeds = speed if constant else np.full(inputs.size, speed)
                output = linkage.output(inputs, 3, speeds, input=driver, **law)
                branch = rng.integers(2)
                got = np.stack([output.velocity, output.acceleration, output.jerk], axis=-1)[branch]
                for at, near, values in zip(inputs, output.position[branch], got, strict=True):
                    if np.isfinite(values).all():
                        exact = precise.output((at, *rates), near, driver)
                        condition = float(precise.condition(mp.mpf(float(at)), driver))
                        errors.append(Error(condition, relative_errors(values[None], [exact], rates)))
    return errors


def circuit_errors(seed: int, linkages: int, form: str) -> dict[str, list[Error]]:
    """All columns of the rows of every circuit under a law, and points of crank, coupler and rocker."""
    rng = np.random.default_rng(seed)
    errors: dict[str, list[Error]] = {"output": [], "turns": [], "points": []}
    for _ in range(linkages):
        description = FORMS[form](rng)
        linkage, reference = description.linkage(), description.reference()
        precise = reference.precise()
        driver = str(rng.choice(["crank", "rocker"]))
        inputs = inputs_towards_limits(rng, linkage, driver)
        rates = tuple(rng.uniform(-2, 2, size=3))
        law = sb.Law.of(np.arange(inputs.size), inputs, *rates)
        place = reference.size * rng.uniform(-1, 1, size=3)
        for circuit in linkage.motion(input=driver, law=law):
            row = _a_row(rng, circuit)
            if row is None:
                continue
            at, near = circuit.input[row], circuit.output[row]
            crank, rocker = (at, near) if driver == "crank" else (near, at)
            sine = precise.coupler_sine(mp.mpf(crank), mp.mpf(rocker))
            middle = precise.turns(mp.mpf(crank), mp.mpf(rocker))
            # where the coupler's spin or the split into three turns has no direction, another condition rules
            if sine < 0.2 or min(abs(mp.cos(middle[1])), abs(mp.cos(middle[4]))) < 0.2:
                continue
            condition = float(precise.condition(mp.mpf(float(at)), driver))
            exact = precise.along((at, *rates), near, driver, _everything(precise, place))
            got = np.stack([circuit.dq[row], circuit.ddq[row], circuit.dddq[row]], axis=-1)
            output = [7 if driver == "crank" else 0]
            compared = {"output": [(got[output], [exact[output[0]]])]}
            compared["turns"] = [(got[1:4], exact[1:4]), (got[4:7], exact[4:7])]
            compared["points"] = []
            for link in (1, 2, 3):
                trace = circuit.point(link, tuple(place))
                moved = np.stack([trace.velocity[row], trace.acceleration[row], trace.jerk[row]], axis=-1)
                first = 8 + 3 * (link - 1)
                scaled = [
                    [value / reference.size for value in component] for component in exact[first : first + 3]
                ]
                compared["points"].append((moved / reference.size, scaled))
            for name, vectors in compared.items():
                each = [relative_errors(values, want, rates) for values, want in vectors]
                errors[name].append(Error(condition, tuple(np.max(each, axis=0))))
    return errors


def _a_row(rng: np.random.Generator, circuit: sb.Circuit) -> int | None:
    rows = np.flatnonzero((circuit.status == "ok") & (circuit.condition < 1e10))
    return None if rows.size == 0 else int(rng.choice(rows))


def _everything(precise: PreciseRssr, place: np.ndarray) -> Callable[[mp.mpf, mp.mpf], list[mp.mpf]]:
    def measure(crank: mp.mpf, rocker: mp.mpf) -> list[mp.mpf]:
        points = [x for link in (1, 2, 3) for x in precise.point(link, place, crank, rocker)]
        return [crank, *precise.turns(crank, rocker), rocker, *points]

    return measure


def worst(errors: list[Error], below: float) -> np.ndarray:
    """The greatest errors of the three derivatives where the condition is below a bound."""
    chosen = [e.relative for e in errors if e.condition < below]
    assert len(chosen) > 10
    return np.max(chosen, axis=0)


def worst_over_condition(errors: list[Error]) -> np.ndarray:
    """The greatest errors in parts of what one rounding of the dimensions makes of them."""
    return np.max([np.array(e.relative) / (ROUNDING * e.condition) for e in errors], axis=0)


#: In parts of 2^-53 times the condition: what the roundings of one evaluation may come to, by the form of the description.
#: A drawing goes through more of them: its frames, the transforms between them, and the circles read back from those.
FACTORS = {"square": (4, 20, 120), "drawn": (25, 100, 400)}

#: Up to this condition the fixed tolerances hold.
TWELVE_DIGITS_BELOW = {"square": 1e4, "drawn": 1e3}


@pytest.fixture(scope="module", params=[12, pytest.param(70, marks=pytest.mark.proof)])
def amount(request: pytest.FixtureRequest) -> int:
    return request.param


@pytest.fixture(scope="module", params=["square", "drawn"])
def form(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def of_output(form: str, amount: int) -> list[Error]:
    with mp.workdps(DIGITS):
        return output_errors(form, seed=amount, linkages=amount)


@pytest.fixture(scope="module")
def of_circuits(form: str, amount: int) -> dict[str, list[Error]]:
    with mp.workdps(DIGITS):
        return circuit_errors(seed=amount, linkages=2 * amount, form=form)


def test_the_reference_agrees_with_the_derivatives_of_eq_8() -> None:
    M, N, L1, L3, D = map(mp.mpf, (700, 600, 250, 550, 40))
    L2 = mp.sqrt((L1 - M) ** 2 + L3**2 + N**2)
    description = Dimensions(700.0, 600.0, 250.0, 550.0, 40.0, float(L2))
    precise = description.reference().precise()
    square = mp.mpf(float(L2)) ** 2

    def eq_8(alpha: mp.mpf) -> mp.mpf:
        y = L1 * mp.sin(alpha) - D
        k = (
            (L1**2 + M**2 + D**2 + L3**2 + N**2 - square) / 2
            - L1 * M * mp.cos(alpha)
            - L1 * D * mp.sin(alpha)
        )
        return mp.asin(k / (L3 * mp.hypot(N, y))) - mp.atan2(y, N)

    for alpha in (mp.mpf("0.3"), mp.mpf("2.1"), mp.mpf("5.5")):
        got = precise.output((alpha, 1.0, 0.0, 0.0), float(eq_8(mp.mpf(float(alpha)))))
        want = [mp.diff(eq_8, mp.mpf(float(alpha)), order) for order in range(4)]
        assert all(abs(g - w) < mp.mpf(10) ** -18 for g, w in zip(got, want, strict=True))


def test_rates_of_the_output_hold_12_11_and_10_digits_away_from_dead_centres(
    of_output: list[Error], form: str
) -> None:
    assert (worst(of_output, TWELVE_DIGITS_BELOW[form]) < RELATIVE).all()
    assert (worst(of_output, 1e4) < 10 * np.array(RELATIVE)).all()


def test_rates_of_the_output_lose_no_more_than_their_condition_takes(
    of_output: list[Error], form: str
) -> None:
    assert max(e.condition for e in of_output) > 1e8
    assert (worst_over_condition(of_output) < FACTORS[form]).all()


@pytest.mark.parametrize("quantity", ["output", "turns", "points"])
def test_rates_along_a_circuit_hold_12_11_and_10_digits_away_from_dead_centres(
    of_circuits: dict[str, list[Error]], form: str, quantity: str
) -> None:
    assert (worst(of_circuits[quantity], TWELVE_DIGITS_BELOW[form]) < RELATIVE).all()
    assert (worst(of_circuits[quantity], 1e4) < 10 * np.array(RELATIVE)).all()


@pytest.mark.parametrize("quantity", ["output", "turns", "points"])
def test_rates_along_a_circuit_lose_no_more_than_their_condition_takes(
    of_circuits: dict[str, list[Error]], form: str, quantity: str
) -> None:
    assert (worst_over_condition(of_circuits[quantity]) < FACTORS[form]).all()


@pytest.mark.parametrize("form", ["square", "drawn"])
@pytest.mark.parametrize("driver", ["crank", "rocker"])
def test_angles_and_condition_along_a_circuit_are_those_of_the_closure(form: str, driver: str) -> None:
    rng = np.random.default_rng(5)
    compared = 0
    for _ in range(12):
        description = FORMS[form](rng)
        linkage, precise = description.linkage(), description.reference().precise()
        for circuit in linkage.motion(samples=36, input=driver):
            row = _a_row(rng, circuit)
            if row is None or circuit.condition[row] > 1e4:
                continue
            crank, rocker = (mp.mpf(float(circuit.q[row, k])) for k in (0, 7))
            at, near = (crank, rocker) if driver == "crank" else (rocker, crank)
            follower = precise.follower(at, near, driver)
            crank, rocker = (at, follower) if driver == "crank" else (follower, at)
            if precise.coupler_sine(crank, rocker) < 0.1:
                continue
            exact = np.array([float(x) for x in (crank, *precise.turns(crank, rocker), rocker)])
            apart = (circuit.q[row] - exact + np.pi) % (2 * np.pi) - np.pi
            assert np.max(np.abs(apart)) < 1e-12
            assert circuit.condition[row] == pytest.approx(float(precise.condition(at, driver)), rel=1e-6)
            compared += 1
    assert compared > 8


def test_the_ground_and_a_point_on_an_axis_stand_still() -> None:
    rng = np.random.default_rng(6)
    drawing = skew(rng)
    for circuit in drawing.linkage().motion(samples=24):
        moving = circuit.status == "ok"
        for link, at in ((4, (0.3, 0.2, -0.1)), (1, drawing.crank_at), (3, drawing.rocker_at)):
            trace = circuit.point(link, tuple(map(float, at)))
            np.testing.assert_allclose(trace.position, np.broadcast_to(at, trace.position.shape), atol=1e-14)
            # exactly still is more than rounded frames can give where the rates themselves are large
            scale = 1 + np.abs(circuit.dq[moving]).max(axis=1, keepdims=True)
            assert (np.abs(trace.velocity[moving]) < 1e-14 * scale).all()
