"""One circuit of the 7R paper's linkage at 360 inputs with its rates, by whatever way a peer has."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import sevenbar as sb
from evidence.benches.cases import fsolve_circuit, pinocchio_circuit, solvers
from evidence.benches.cases.arm import Arm
from evidence.benches.harness import Timing, Work, at_most, compare
from evidence.benches.outcome import Cell, Outcome, Table
from evidence.benches.peers import reason_of
from evidence.benches.setting import Setting

TITLE = "The 7R paper's linkage: one circuit"
ABOUT = """\
360 inputs of circuit 0 from a known pose: all joints' angles, velocities and accelerations. Sevenbar
(`linkage.circuit`) also gives jerks, dead centres and extremes, and certifies that it stayed on the
circuit. scipy's `fsolve` begins each input at the row before; pinocchio gives the kinematics for a
Newton's method, and exact rates; the solvers of robot arms give all modes of each input, of which the
nearest to the row before is taken. Who has positions only takes differences as the 7R paper does (a row
to the next over the time between, the last to the first). *Angles off* and the rest are the greatest
differences from Sevenbar, rates in parts of the greatest. CPU time, one thread."""

SAMPLES = 360

#: Time [s] for a solver to make itself ready for the linkage.
MAKING = 60.0

#: A peer that is further [rad] from the circuit did other work.
SAME_CIRCUIT = 1e-6


@dataclass(frozen=True, eq=False)
class Rows:
    """Angles and rates of all joints, (n, 7) each, at an input speed of 1 rad/s."""

    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray


def run(setting: Setting) -> Outcome:
    """One table."""
    linkage = sb.load("seven_r")
    circuit = linkage.motion(samples=SAMPLES).circuits[0]
    truth = Rows(circuit.q, circuit.dq, circuit.ddq)
    offs: dict[str, tuple[float, float, float]] = {}
    works = [Work("Sevenbar", lambda: linkage.circuit(circuit.q[0], samples=SAMPLES))]
    absent: list[tuple[str, str]] = []
    for who, make, note in ways(linkage, truth, setting):
        try:
            with at_most(setting.choose(MAKING, 1.0)):
                call = make()
        except Exception as error:
            absent.append((who, reason_of(error)))
            continue

        def check(rows: Rows, who: str = who) -> None:
            apart = np.abs(turned(rows.q - truth.q)).max(axis=1)
            lost = np.flatnonzero(apart > SAME_CIRCUIT)
            assert not lost.size, (
                f"leaves the circuit at row {lost[0]}, {lost.size} of {SAMPLES} rows lie elsewhere"
            )
            offs[who] = off(rows, truth)

        works.append(Work(who, call, note=note, check=check))
    # of the process's clock only ticks are seen once a timer of `at_most` ran
    timings = compare(works, rounds=setting.choose(15, 1), clock=time.thread_time)
    return Outcome(TITLE, ABOUT, [table(timings, offs, absent)])


Way = tuple[str, Callable[[], Callable[[], Rows]], str]


def ways(linkage: sb.Linkage, truth: Rows, setting: Setting) -> Iterator[Way]:
    """Who, what makes its call, and what it gives."""
    for name, closure in fsolve_circuit.CLOSURES.items():
        yield (
            f"fsolve, {name}",
            lambda closure=closure: by_fsolve(closure(linkage.transforms), truth, setting),  # type: ignore[misc]
            "differences",
        )
    yield "pinocchio + Newton", lambda: by_pinocchio(linkage, truth, setting), "exact rates"
    for name in ("ssik", "roboticstoolbox", "EAIK", "ik-geo"):
        yield name, lambda name=name: by_arm(name, linkage, truth, setting), "all modes; differences"  # type: ignore[misc]


def by_fsolve(equations: Any, truth: Rows, setting: Setting) -> Callable[[], Rows]:
    """Scipy's fsolve."""
    setting.peers.module("scipy")
    return lambda: differenced(fsolve_circuit.positions(equations, truth.q[0], truth.q[:, 0]))


def by_pinocchio(linkage: sb.Linkage, truth: Rows, setting: Setting) -> Callable[[], Rows]:
    """Newton's method on pinocchio's kinematics."""
    follow = pinocchio_circuit.follower(setting.peers.module("pin"), linkage.transforms)
    return lambda: Rows(*follow(truth.q[0], truth.q[:, 0]))


def by_arm(name: str, linkage: sb.Linkage, truth: Rows, setting: Setting) -> Callable[[], Rows]:
    """A solver of robot arms."""
    solve = solvers.prepared(name, Arm(linkage.transforms), setting.peers)

    def call() -> Rows:
        q = np.empty_like(truth.q)
        q[:, 0] = truth.q[:, 0]
        last = truth.q[0, 1:]
        for row in q:
            answers = solve(row[0]).angles
            turns = turned(answers - last)
            last = last + turns[np.abs(turns).max(axis=1).argmin()]
            row[1:] = last
        return differenced(q)

    return call


def differenced(q: np.ndarray) -> Rows:
    """With rates as the 7R paper has them, of a circuit that closes after one turn of the input."""
    step = 2 * math.pi / len(q)

    def rate(values: np.ndarray) -> np.ndarray:
        apart: np.ndarray = np.roll(values, -1, axis=0) - values
        return apart / step

    velocity = turned(np.roll(q, -1, axis=0) - q) / step
    return Rows(q, velocity, rate(velocity))


def turned(angles: np.ndarray) -> np.ndarray:
    """Angles [rad] less whole turns, the nearest to zero."""
    less: np.ndarray = (angles + math.pi) % (2 * math.pi) - math.pi
    return less


def off(rows: Rows, truth: Rows) -> tuple[float, float, float]:
    """Greatest differences of angles [rad], and of velocities and accelerations relative to the greatest."""
    return (
        float(np.abs(turned(rows.q - truth.q)).max()),
        float(np.abs(rows.dq - truth.dq).max() / np.abs(truth.dq).max()),
        float(np.abs(rows.ddq - truth.ddq).max() / np.abs(truth.ddq).max()),
    )


def table(
    timings: list[Timing], offs: dict[str, tuple[float, float, float]], absent: list[tuple[str, str]]
) -> Table:
    """Times beside errors."""
    columns = [
        "",
        "ms",
        "ratio",
        "from",
        "to",
        "angles off [rad]",
        "velocity off",
        "acceleration off",
        "note",
    ]
    rows: list[list[Cell]] = []
    for timing in timings:
        errors = offs.get(timing.who, (None, None, None))
        ratios = (timing.ratio, timing.ratio_low, timing.ratio_high)
        note = timing.failure or timing.note or "exact rates, jerk too; certified"
        rows.append([timing.who, 1e3 * timing.median, *ratios, *errors, note])
    rows += [[who, *[None] * 7, reason] for who, reason in absent]
    return Table(f"{SAMPLES} inputs", columns, rows)
