"""How errors grow towards input dead centres, and where the dead centres themselves are, against 60 digits.

A dead centre is where the input, as a function of another joint, has its derivative zero. So the reference
drives the loop by that other joint and finds the zero of the derivative by Newton's method in many digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import mpmath as mp
import numpy as np

import sevenbar as sb
from evidence.accuracy.differences import central_differences
from evidence.accuracy.forty_digits import Comparison, reference
from evidence.accuracy.gallery_rows import apart, seeded
from evidence.accuracy.precise_loops import DIGITS, STEP, PreciseLoop
from evidence.accuracy.quantiles import ROUNDING, Row
from evidence.accuracy.reference_loops import Loop

#: Distances [rad, or parts of the size] from a dead centre at which rows are compared.
DISTANCES = tuple(10.0 ** (-k / 2) for k in range(3, 19))

#: Most dead centres of one motion whose neighbourhood is compared.
MOST = 4

#: Inputs a turn from whose poses dead centres are looked for: near enough for Newton's method.
SAMPLES = 360

#: Two values [rad, or parts of the size] of one dead centre found in two ways are nearer than this.
SAME = 1e-5

#: The reference's Newton steps end below this, far above its own digits and far below a rounding.
ARRIVED = mp.mpf(10) ** -24

#: Most of them: each doubles the digits.
NEWTON_STEPS = 8

#: Asked for in a place, relative to 1 or to the dead centre's condition where that is more.
ASKED = {"closed form": 1e-12, "general": 1e-10}


def drives(linkage: sb.Linkage) -> list[str]:
    """The file's input, and its output driving instead: a crank-rocker has dead centres this way."""
    return [linkage.drive.joint, linkage.drive.output]


def moved(linkage: sb.Linkage, joint: str, samples: int) -> sb.Motion:
    """Driven by either end at unit speed, the other one being the output."""
    first, second = drives(linkage)
    return linkage.motion(samples=samples, input=joint, output=second if joint == first else first, speed=1.0)


def towards(name: str, joint: str, distances: Sequence[float], most: int) -> Iterator[Row]:
    """Rows at distances [rad, or parts of the size] from the first input dead centres, on both passes."""
    linkage = sb.load(name)
    motion = moved(linkage, joint, SAMPLES)
    column = linkage.columns.index(motion.input)
    against = reference(linkage, column)
    rng = seeded(name, 1)
    unit = float(against.scales[column])
    ends = sorted({d.input for c in motion for d in c.dead_centres if d.kind == "input"})[:most]
    if not ends:
        return
    inputs = np.sort(np.concatenate([[end - unit * d, end + unit * d] for end in ends for d in distances]))
    law = sb.Law.of(np.arange(inputs.size), inputs, 1.0, 0.0, 0.0)
    for circuit in linkage.motion(law=law, input=motion.input, output=motion.output):
        far = apart(circuit, turns=linkage.column_kinds[column] == "turn") / unit
        comparison = Comparison(linkage, circuit, against, rng=rng)
        for row in np.flatnonzero((circuit.status == "ok") & (far < 2 * DISTANCES[0])):
            yield Row(
                linkage=name,
                circuit=circuit.index,
                input=float(circuit.input[row]),
                condition=float(circuit.condition[row]),
                apart=float(far[row]),
                errors=comparison.errors(int(row), (1.0, 0.0, 0.0)),
            )


@dataclass(frozen=True)
class Place:
    """A dead centre beside the exact one.

    `kind` "input" or "output", by the joint that stands still; errors of the input's and the output's value
    [rad, or parts of the size]; the condition that Sevenbar tells.
    """

    linkage: str
    driver: str
    circuit: int
    kind: str
    input: float
    condition: float
    errors: tuple[float, float]


def places(name: str, joint: str) -> tuple[list[Place], int]:
    """Every dead centre of every circuit, and how many could not be set beside an exact one."""
    linkage = sb.load(name)
    motion = moved(linkage, joint, SAMPLES)
    ends = (linkage.columns.index(motion.input), linkage.columns.index(motion.output))
    loop = Loop.of(linkage)
    found, left_out = [], 0
    for circuit in motion:
        for dead in circuit.dead_centres:
            exact = exact_place(linkage, loop, circuit, dead)
            if exact is None:
                left_out += 1
                continue
            errors = [
                _apart(value, at, turns=linkage.column_kinds[column] == "turn") / loop.scales[column]
                for value, at, column in zip((dead.input, dead.output), exact, ends, strict=True)
            ]
            found.append(
                Place(
                    linkage=name,
                    driver=motion.input,
                    circuit=circuit.index,
                    kind=dead.kind,
                    input=dead.input,
                    condition=dead.condition,
                    errors=(float(errors[0]), float(errors[1])),
                )
            )
    return found, left_out


def exact_place(
    linkage: sb.Linkage, loop: Loop, circuit: sb.Circuit, dead: sb.motion.DeadCentre
) -> tuple[mp.mpf, mp.mpf] | None:
    """The exact values of input and output; None where Newton's method leads away (both stand still)."""
    ends = [circuit.input_column, circuit.output_column]
    values = np.array([dead.input, dead.output])
    standing = 0 if dead.kind == "input" else 1
    still, moving, at = ends[standing], ends[1 - standing], float(values[1 - standing])
    turns = [linkage.column_kinds[column] == "turn" for column in ends]
    off = circuit.q[:, ends] - values
    off = np.where(turns, (off + np.pi) % (2 * np.pi) - np.pi, off) / loop.scales[ends]
    near = np.array(circuit.q[np.nanargmin(np.abs(off).max(axis=1))])
    near[moving] += _off(at - near[moving], turns=turns[1 - standing])
    (q,) = loop.polished(near, moving)
    with mp.workdps(DIGITS):
        follower = PreciseLoop(loop, moving).follower(q)
        x = mp.mpf(float(q[moving]))
        for _ in range(NEWTON_STEPS):
            samples = [follower(x + k * STEP)[still] for k in range(-2, 3)]
            held, first, second, _ = central_differences(samples, STEP)
            step = first / second
            x -= step
            if abs(step) > loop.scales[moving] * SAME:
                break
            if abs(step) < loop.scales[moving] * ARRIVED:
                return (held, x) if dead.kind == "input" else (x, held)
    return None


def _off(value: float, *, turns: bool) -> float:
    """A difference of two values of a column, whole turns aside."""
    return (value + np.pi) % (2 * np.pi) - np.pi if turns else value


def _apart(value: float, exact: mp.mpf, *, turns: bool) -> float:
    """How far a value is from an exact one, whole turns aside."""
    with mp.workdps(DIGITS):
        off = mp.mpf(float(value)) - exact
        if turns:
            off -= 2 * mp.pi * mp.nint(off / (2 * mp.pi))
        return float(abs(off))


def bound(condition: float, *, closed_form: bool) -> float:
    """What one rounding of the closure makes of a rate beside a dead centre, as a part of the rate.

    It moves the dead centre by about eps, and so changes how far it is, on which all rates rest. That
    distance goes with 1 / condition for the RSSR's closed form, with 1 / condition^2 for a general loop.
    """
    return ROUNDING * (condition if closed_form else condition**2)


def measured(name: str, *, distances: Sequence[float] = DISTANCES, most: int = MOST) -> dict[str, object]:
    """All of one linkage, driven by either end: errors towards its dead centres, and their places."""
    linkage = sb.load(name)
    closed_form = "rssr" in linkage.description
    driven, found = [], []
    for joint in drives(linkage):
        rows = list(towards(name, joint, distances, most))
        if rows:
            driven.append({"input": joint, "rows": len(rows), "steps": _by_distance(rows, closed_form)})
        at, left_out = places(name, joint)
        if at or left_out:
            found.append(_told(at, joint, left_out, closed_form))
    return {"closed form": closed_form, "driven": driven, "places": found}


def _by_distance(rows: list[Row], closed_form: bool) -> list[dict[str, object]]:
    """For each distance the greatest condition, errors, and errors relative to the bound, of the joints."""
    steps = []
    for distance in DISTANCES:
        # half way to the next distances, in decades
        near = [row for row in rows if 0.8 < row.apart / distance < 1.25]
        if near:
            errors = np.array([row.errors["joints"] for row in near])
            bounds = np.array([bound(row.condition, closed_form=closed_form) for row in near])
            steps.append(
                {
                    "apart": distance,
                    "rows": len(near),
                    "condition": max(row.condition for row in near),
                    "errors": errors.max(axis=0).tolist(),
                    "bounds": (errors / bounds[:, None]).max(axis=0).tolist(),
                }
            )
    return steps


def _told(at: list[Place], joint: str, left_out: int, closed_form: bool) -> dict[str, object]:
    asked = ASKED["closed form" if closed_form else "general"]
    parts = [max(place.errors) / max(1.0, place.condition) for place in at]
    return {
        "input": joint,
        "count": len(at),
        "left out": left_out,
        "condition": max((place.condition for place in at), default=0.0),
        "still": max((place.errors[0 if place.kind == "input" else 1] for place in at), default=0.0),
        "moving": max((place.errors[1 if place.kind == "input" else 0] for place in at), default=0.0),
        "part": max(parts, default=0.0),
        "beyond": sum(bool(part > asked) for part in parts),
        "asked": asked,
    }
