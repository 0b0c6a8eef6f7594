"""Velocity, acceleration and jerk of joints, points and links of any loop against 60-digit numbers.

Source: `precise_loops.PreciseLoop`: Newton's method on the product round the loop and central differences with a
step of 1e-14; no derivative is written out anywhere. That reference is itself held against the derivatives of
tests/references/seven_r_modes.json, worked out elsewhere in 40 digits.

What is compared: the error of a k-th derivative over the exact value, or over the input's own rate to the power
of the order where the exact value is smaller; slides and points in units of the size. Columns that an idle freedom
moves, and links that it carries, have the values that a convention gives them and are left out; so are the turns of
a ball near the pose where they have no direction.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence

import mpmath as mp
import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.precise_loops import DIGITS, PreciseLoop
from evidence.accuracy.reference_loops import Loop
from evidence.fuzz.random_loops import OVERCONSTRAINED, SPECIAL, Case, Drawn, Rows, drawn, general, screws
from places import REFERENCES

#: Of velocity, acceleration, jerk where the condition is below `WELL`.
RELATIVE = (1e-10, 1e-9, 1e-8)
WELL = 1e4

#: The cosine of a ball's second turn below which its first and third have no direction.
TURNS_DEFINED = 0.2

#: Linkages of each family, and rows of each circuit.
LINKAGES = {"few": (3, 1), "many": (60, 3)}

FAMILIES: dict[str, Callable[[np.random.Generator], Case]] = {
    "general": general,
    "drawn": drawn,
    "screws": screws,
    **{
        name: SPECIAL[name]
        for name in (
            "three parallel axes",
            "right twists",
            "spherical wrist",
            "two slides",
            "compound joints",
        )
    },
    **OVERCONSTRAINED,
}


@pytest.fixture(autouse=True)
def many_digits() -> Iterator[None]:
    with mp.workdps(DIGITS):
        yield


@pytest.fixture(
    params=[
        "few",
        pytest.param("many", marks=pytest.mark.proof),
    ]
)
def amount(request: pytest.FixtureRequest) -> tuple[int, int]:
    return LINKAGES[request.param]


def test_the_reference_agrees_with_derivatives_worked_out_elsewhere() -> None:
    path = REFERENCES / "seven_r_modes.json"
    reference = json.loads(path.read_text(encoding="utf-8"))
    linkage = sb.from_dh(
        "RRRRRRR",
        length=reference["length"],
        twist=np.radians(reference["twist_deg"]),
        offset=reference["offset"],
    )
    precise = PreciseLoop(Loop.of(linkage))
    point = precise.point(4, (-100.0, -90.0, -80.0))
    for mode in reference["modes"]:
        q = np.array(mode["theta"])
        exact = np.array(precise.along((q[0], 1, 0, 0), q, lambda q: [*q, *point(q)]), dtype=np.float64)
        for order, (joints, place) in enumerate((("theta", "r4"), ("dtheta", "v4"), ("ddtheta", "a4"))):
            np.testing.assert_allclose(exact[:7, order], mode[joints], rtol=0, atol=2e-15)
            np.testing.assert_allclose(exact[7:, order], mode[place], rtol=0, atol=2e-13)


def test_third_derivatives_of_the_reference_are_the_differences_of_its_second_ones() -> None:
    loop = Loop.of(general(np.random.default_rng(1)).linkage())
    q = loop.polished(general(np.random.default_rng(1)).pose, 0)[0]
    precise = PreciseLoop(loop)
    here = precise.along((q[0], 1.0, 0.0, 0.0), q)
    step = 2.0**-30
    there = precise.along((q[0] + step, 1.0, 0.0, 0.0), q)
    back = precise.along((q[0] - step, 1.0, 0.0, 0.0), q)
    for now, after, before in zip(here, there, back, strict=True):
        slope = (after[2] - before[2]) / (2 * mp.mpf(step))
        assert abs(slope - now[3]) < mp.mpf(10) ** -12 * (1 + abs(now[3]))


class Comparison:
    """Errors of the rows of one circuit."""

    def __init__(self, linkage: sb.Linkage, circuit: sb.Circuit) -> None:
        self.circuit = circuit
        self.loop = Loop.of(linkage)
        self.column = circuit.input_column
        self.precise = PreciseLoop(self.loop, self.column)

    def rows(self, rng: np.random.Generator, count: int) -> np.ndarray:
        well = np.flatnonzero((self.circuit.status == "ok") & (self.circuit.condition < WELL))
        return rng.choice(well, min(count, well.size), replace=False)

    def columns(self, row: int) -> np.ndarray:
        """Columns with a value of their own."""
        kept = ~self._idle(row)[0]
        ball = [end for joint, end in zip(self.circuit_joints, self.loop.ends, strict=True) if joint == "S"]
        for end in ball:
            if abs(np.cos(self.circuit.q[row, end - 1])) < TURNS_DEFINED:
                kept[end - 2 : end + 1] = False
        return np.flatnonzero(kept)

    @property
    def circuit_joints(self) -> list[str]:
        widths = np.diff([-1, *self.loop.ends])
        return ["S" if width == 3 else "" for width in widths]

    def _idle(self, row: int) -> tuple[np.ndarray, np.ndarray]:
        _, columns, links = self.loop.idle(self.circuit.q[row], self.column)
        return columns, links

    def joints(self, row: int, rates: Sequence[float]) -> tuple[float, ...]:
        exact = self.precise.along((self.circuit.q[row, self.column], *rates), self.circuit.q[row])
        return self._joints(row, rates, exact)

    def all(
        self, row: int, rates: Sequence[float], link: int, at: np.ndarray
    ) -> dict[str, tuple[float, ...]]:
        """Errors of the joints, of a point of a link, and of the link's turning."""
        place = self.precise.point(link, at)

        def measures(q: list[mp.mpf]) -> list[mp.mpf]:
            frame = self.precise.link(q, link)
            return [*q, *place(q), *(frame[i][j] for i in range(3) for j in range(3))]

        q = self.circuit.q[row]
        exact = self.precise.along((q[self.column], *rates), q, measures)
        return {
            "joints": self._joints(row, rates, exact[: q.size]),
            "points": self._point(row, rates, link, at, exact[q.size : q.size + 3]),
            "links": self._turning(row, rates, link, exact[q.size + 3 :]),
        }

    def _joints(self, row: int, rates: Sequence[float], exact: list[list[mp.mpf]]) -> tuple[float, ...]:
        chosen = self.columns(row)
        got = [values[row, chosen] for values in (self.circuit.dq, self.circuit.ddq, self.circuit.dddq)]
        want = [np.array([float(exact[k][order]) for k in chosen]) for order in (1, 2, 3)]
        return self._relative(got, want, self.loop.scales[chosen], rates[0])

    def _point(
        self, row: int, rates: Sequence[float], link: int, at: np.ndarray, exact: list[list[mp.mpf]]
    ) -> tuple[float, ...]:
        trace = self.circuit.point(link, tuple(map(float, at)))
        place = np.array([float(x[0]) for x in exact])
        # the frame may stand far from the linkage
        assert np.abs(trace.position[row] - place).max() < 1e-10 * (self.loop.size + np.abs(place).max())
        got = [values[row] for values in (trace.velocity, trace.acceleration, trace.jerk)]
        want = [np.array([float(x[order]) for x in exact]) for order in (1, 2, 3)]
        return self._relative(got, want, np.full(3, self.loop.size), rates[0])

    def _turning(
        self, row: int, rates: Sequence[float], link: int, exact: list[list[mp.mpf]]
    ) -> tuple[float, ...]:
        """Angular velocity and acceleration, the vectors of R' R^T and of the skew part of R'' R^T."""
        moments = np.array(exact, dtype=np.float64).reshape(3, 3, 4)
        rotation = moments[..., 0]
        want = []
        for order in (1, 2):
            product = moments[..., order] @ rotation.T
            skew = product - product.T
            want.append(self.loop.base[:3, :3] @ np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) / 2)
        turning = self.circuit.link_motion(link)
        return self._relative([turning.velocity[row], turning.acceleration[row]], want, np.ones(3), rates[0])

    def moving_links(self, row: int) -> np.ndarray:
        """Moving links, from 1, that no idle freedom carries."""
        return np.flatnonzero(~self._idle(row)[1]) + 1

    def _relative(
        self, got: Sequence[np.ndarray], want: Sequence[np.ndarray], unit: np.ndarray, speed: float
    ) -> tuple[float, ...]:
        errors = []
        pace = abs(speed) / self.loop.scales[self.column]
        for order, (g, w) in enumerate(zip(got, want, strict=True), 1):
            size = max(pace**order, float(np.abs(w / unit).max(initial=0.0)))
            errors.append(float(np.abs((g - w) / unit).max(initial=0.0)) / size)
        return tuple(errors)


def motions(family: str, count: int) -> Iterator[tuple[np.random.Generator, sb.Linkage]]:
    for seed in range(count):
        rng = np.random.default_rng([7, seed])
        yield rng, FAMILIES[family](rng).linkage()


@pytest.mark.parametrize("family", FAMILIES)
def test_rates_of_joints_points_and_links_hold_10_9_and_8_digits(
    family: str, amount: tuple[int, int]
) -> None:
    count, rows = amount
    worst = {"joints": np.zeros(3), "points": np.zeros(3), "links": np.zeros(2)}
    compared = 0
    for rng, linkage in motions(family, count):
        speed = float(10 ** rng.uniform(-1, 1))
        for circuit in linkage.motion(samples=36, speed=speed):
            comparison = Comparison(linkage, circuit)
            rates = (speed, 0.0, 0.0)
            for row in comparison.rows(rng, rows):
                links = comparison.moving_links(row)
                if links.size:
                    at = comparison.loop.size * rng.normal(size=3)
                    errors = comparison.all(row, rates, int(rng.choice(links)), at)
                else:
                    errors = {"joints": comparison.joints(row, rates)}
                for name, values in errors.items():
                    worst[name] = np.maximum(worst[name], values)
                compared += 1
    assert compared >= count
    assert (worst["joints"] < RELATIVE).all(), worst
    assert (worst["points"] < RELATIVE).all(), worst
    assert (worst["links"] < RELATIVE[:2]).all(), worst


def test_rates_follow_an_input_law() -> None:
    compared = 0
    for rng, linkage in motions("general", 6):
        count = 24
        law = sb.Law.of(
            np.arange(count),
            np.linspace(0, 2 * np.pi, count, endpoint=False),
            rng.uniform(0.5, 2, count),
            rng.uniform(-2, 2, count),
            rng.uniform(-2, 2, count),
        )
        for circuit in linkage.motion(law=law):
            comparison = Comparison(linkage, circuit)
            for row in comparison.rows(rng, 2):
                # a circuit that rocks holds the samples of the law once for each pass
                apart = (law.q - circuit.q[row, 0] + np.pi) % (2 * np.pi) - np.pi
                sample = int(np.argmin(np.abs(apart)))
                rates = (law.dq[sample], law.ddq[sample], law.dddq[sample])
                assert (np.array(comparison.joints(row, rates)) < RELATIVE).all()
                compared += 1
    assert compared > 8


def test_rates_with_any_joint_as_input() -> None:
    compared = 0
    for family in ("general", "two slides", "compound joints"):
        for rng, linkage in motions(family, 4):
            columns = [c for c, end in _drivers(linkage)]
            column = int(rng.choice(columns))
            names = [linkage.columns[c] for c in columns if c != column]
            for circuit in linkage.motion(samples=36, input=linkage.columns[column], output=names[-1]):
                assert circuit.input_column == column
                comparison = Comparison(linkage, circuit)
                for row in comparison.rows(rng, 2):
                    assert (np.array(comparison.joints(row, (1.0, 0.0, 0.0))) < RELATIVE).all()
                    compared += 1
    assert compared > 12


def _drivers(linkage: sb.Linkage) -> list[tuple[int, str]]:
    """Columns that can be driven: all but a ball's turns."""
    kinds = [(joint.kind, name) for joint in linkage.joints for name in joint.columns]
    return [(column, name) for column, (kind, name) in enumerate(kinds) if kind != "S"]


def test_the_ground_stands_still() -> None:
    for case in (general(np.random.default_rng(3)), drawn(np.random.default_rng(3))):
        assert isinstance(case, Rows | Drawn)
        linkage = case.linkage()
        ground = len(linkage.joints)
        for circuit in linkage.motion(samples=24):
            moving = circuit.status == "ok"
            trace = circuit.point(ground, (0.3, 0.2, -0.1))
            np.testing.assert_allclose(trace.position - trace.position[0], 0.0, atol=1e-13)
            for values in (trace.velocity, trace.acceleration, trace.jerk):
                np.testing.assert_allclose(values[moving], 0.0, atol=1e-13)
