"""All assembly modes of loops of seven turning joints: how many are found, how many false, and how fast."""

from __future__ import annotations

import math
import statistics
import time
from dataclasses import dataclass, field, replace

import numpy as np

from evidence.benches.cases.arm import Arm
from evidence.benches.cases.closure import CLOSED, SAME, Closure, apart, different, moved
from evidence.benches.cases.loops import Problem, families
from evidence.benches.cases.solvers import SOLVERS, Solve, prepared
from evidence.benches.harness import OutOfTimeError, Work, at_most, compare, seconds
from evidence.benches.outcome import Cell, Outcome, Table
from evidence.benches.peers import Peers, reason_of
from evidence.benches.setting import Setting

TITLE = "All modes of loops of seven turning joints"
ABOUT = """\
Every assembly mode at one input. To a solver of robot arms that is an arm of six joints that must reach a
pose. The true modes of a loop are all that any program here found, what a search by Newton's method from
random starts (NumPy alone) found, and those known from the papers, each closing to 1e-9. An answer counts
as found when it closes to 1e-3 and Newton's method moves it to a true mode by less than 0.01 rad
(generous, for solvers that search); any other is false; one told twice counts once. *Making* is what a
program does once for each new linkage, *solving* what it does at each input; times are medians over the
loops, CPU time, one thread. *Off* is the greatest closure error of an answer that counts (radians,
lengths in parts of the size). Of ssik's three derivations for arms of no special geometry one is made,
without its cache on disk. A solver has a limited time for each family; what it did not come to is told."""

COLUMNS = ["", "loops", "modes found", "of", "false", "making [ms]", "solving [ms]", "off", "note"]

#: CPU time [s] for one solver and one family of loops; in the first family a making may take longer, so that
#: symbolic derivations are shown.
FAMILY, MAKING = 20.0, 60.0

#: Closure error of an answer that is meant, though its solver calls it least squares: searches end so near.
MEANT = 1e-3

#: How far [rad] Newton's method may move an answer that counts.
NEAR = 0.01

#: The limits [s] for a quick look.
QUICK = (0.5, 1.0)

#: The families of a quick look.
QUICK_FAMILIES = ("no special geometry", "the 7R paper's linkage")

#: Starts of the search that knows nothing of all this.
STARTS = 4000


@dataclass
class Tally:
    """What one program made of a family: its answers to the loops it came to, times [s], why no more."""

    answers: dict[int, np.ndarray] = field(default_factory=dict)
    making: list[float] = field(default_factory=list)
    solving: list[float] = field(default_factory=list)
    note: str = ""


def run(setting: Setting) -> Outcome:
    """Family by family."""
    tables: list[Table] = []
    for name, problems in families(*setting.choose((12, 6), (2, 1))):
        if setting.quick and name not in QUICK_FAMILIES:
            continue
        tallies = {"Sevenbar": ours(problems)}
        for who in SOLVERS:
            limits = (FAMILY, MAKING if not tables else FAMILY)
            tallies[who] = theirs(who, problems, setting.peers, *setting.choose(limits, QUICK))
        tables.append(Table(name, COLUMNS, judged(problems, tallies, setting.choose(STARTS, STARTS // 8))))
    return Outcome(TITLE, ABOUT, tables)


def ours(problems: list[Problem]) -> Tally:
    """Sevenbar's; each linkage is a new one, so that nothing is made beforehand."""
    tally = Tally(making=[0.0])
    for index, problem in enumerate(problems):

        def modes(problem: Problem = problem) -> np.ndarray:
            return replace(problem.linkage).assembly_modes(problem.theta).q

        tally.answers[index] = modes()
        tally.solving.append(lasting(modes))
        error = Closure(problem.linkage.transforms).error(tally.answers[index])
        assert (error < CLOSED).all(), f"a mode of Sevenbar's does not close: {error.max():.1e}"
    return tally


def theirs(who: str, problems: list[Problem], peers: Peers, left: float, making: float) -> Tally:
    """A peer's, as far as its time reaches: `left` [s] in all, `making` [s] at most for the first loop."""
    tally = Tally()
    for index, problem in enumerate(problems):
        if left <= 0:
            tally.note = tally.note or "no time for more loops"
            break
        try:
            with at_most(making if index == 0 else left):
                spent, solve = made(who, problem, peers)
                tally.answers[index] = meant(solve, problem)
            once = lasting(lambda: solve(problem.theta))  # noqa: B023
        except OutOfTimeError as error:
            tally.note = str(error)
            break
        except Exception as error:
            tally.note = reason_of(error)
            left -= 1.0
            continue
        tally.making.append(spent)
        tally.solving.append(once)
        left -= spent + once
    return tally


def made(who: str, problem: Problem, peers: Peers) -> tuple[float, Solve]:
    """Seconds and the solver for a new linkage."""
    kept: list[Solve] = []
    arm = Arm(problem.linkage.transforms)
    spent = seconds(lambda: kept.append(prepared(who, arm, peers)), 1, time.thread_time)
    return spent, kept[0]


def meant(solve: Solve, problem: Problem) -> np.ndarray:
    """Answers as poses (m, 7) of the loop; not what a solver calls least squares and does not close."""
    angles, least_squares = solve(problem.theta)
    poses = np.column_stack([np.full(len(angles), problem.theta), angles])
    kept: np.ndarray = poses[(Closure(problem.linkage.transforms).error(poses) < MEANT) | ~least_squares]
    return kept


def lasting(call: object) -> float:
    """Median time [s] of a call; of the process's clock only ticks are seen once a timer of `at_most` ran."""
    return compare([Work("", call)], rounds=3, clock=time.thread_time)[0].median  # type: ignore[arg-type]


def judged(problems: list[Problem], tallies: dict[str, Tally], starts: int) -> list[list[Cell]]:
    """The rows of a family's table."""
    true = []
    for index, problem in enumerate(problems):
        closure = Closure(problem.linkage.transforms)
        found = [tally.answers[index] for tally in tallies.values() if index in tally.answers]
        found += [problem.known, closure.searched(problem.theta, starts, seed=index)]
        candidates = closure.polished(np.concatenate(found))
        true.append(different(candidates[closure.error(candidates) < CLOSED]))
    rows: list[list[Cell]] = []
    for who, tally in tallies.items():
        score = [scored(problems[index], true[index], answers) for index, answers in tally.answers.items()]
        if not score:
            rows.append([who, 0.0, None, None, None, None, None, None, tally.note])
            continue
        counts = np.array(score)
        rows.append(
            [
                who,
                float(len(score)),
                *(float(count) for count in counts[:, :3].sum(axis=0)),
                1e3 * statistics.median(tally.making),
                1e3 * statistics.median(tally.solving),
                float(np.nanmax(counts[:, 3])) if not np.isnan(counts[:, 3]).all() else math.nan,
                tally.note,
            ]
        )
    return rows


def scored(problem: Problem, true: np.ndarray, answers: np.ndarray) -> tuple[int, int, int, float]:
    """Modes found, true ones, false answers, and the greatest closure error of those that count."""
    closure = Closure(problem.linkage.transforms)
    if not len(answers):
        return 0, len(true), 0, math.nan
    polished = closure.polished(answers)
    near = moved(answers, polished) < NEAR
    same = apart(polished, true) < SAME
    counts = near & same.any(axis=1)
    found = int(same[counts].any(axis=0).sum())
    error = float(closure.error(answers[counts]).max()) if counts.any() else math.nan
    return found, len(true), int((~counts).sum()), error
