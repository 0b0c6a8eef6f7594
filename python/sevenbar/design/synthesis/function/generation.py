"""Function generation: RSSR designs whose output follows a wanted function of the input.

Starts come by the thousand in closed form (`starts`). The best of them are solved as tasks of one want
(`design.task`) and go through the ordinary analysis (`candidates`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, short_way
from sevenbar.design.candidates import (
    Candidate,
    Claim,
    Refusal,
    checked,
    distinct,
    least_error,
    transmits_best,
)
from sevenbar.design.closure import NAMES, draft_of, outputs, scaled
from sevenbar.design.extra import need_scipy
from sevenbar.design.limits import Limits
from sevenbar.design.search import Designs, DesignSearch
from sevenbar.design.synthesis.function.precision import reflected
from sevenbar.design.synthesis.function.starts import ON_BRANCH, Start, chosen, starts
from sevenbar.design.task import DesignTask, FreeNumber, FunctionWant, Most
from sevenbar.design.task.loop import RssrLoop
from sevenbar.design.task.problem import TaskModel, TaskProblem, TaskSeed
from sevenbar.design.task.solve import solved
from sevenbar.design.wish import Wish, wish_of_function, wish_of_pairs
from sevenbar.errors import RequestError
from sevenbar.text.progress import Progress, silent

#: What a design must keep to where nothing else is given.
USUAL = Limits(transmission_lowest=math.radians(30))

#: How many of them are fitted for each design requested, and at least.
FITTED_EACH, FITTED_LEAST = 4, 16

#: The dimensions that are lengths of links.
LINKS = ("L1", "L2", "L3")

#: Two starts ended in one place where no ratio and no zero differs by more.
ENDS_APART = 1e-2

#: Evaluations of the least squares a start begins with: in each of three rounds where anything must hold,
#: and in the one where nothing must.
LOOK, FREE_LOOK = 30, 120

#: Designs, at least, after which no other start is tried, where as many as are wanted differ.
ENOUGH = 5

#: A start whose least squares end so many times above those of the worst design wanted is left.
HOPELESS = 1.1


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Synthesis(Designs[Candidate]):
    """Designs found for a wish, best first, and what was refused on the way, the nearest first.

    `searched` designs were compared and `fitted` of them refined.
    """

    wanted: str
    limits: Limits
    searched: int
    fitted: int
    seed: int
    #: The wanted function, `None` for another wish.
    wish: Wish | None = None

    def required(self) -> tuple[Candidate, ...]:
        """The candidates; `RequestError` saying what was nearest where there are none."""
        if self.candidates:
            return self.candidates
        reasons = self.refused or "none closes on one branch over the range"
        nearest = f"; nearest: {self.refusals[0].detail}" if self.refusals else ""
        raise RequestError(
            f"design: no linkage found for {self.wanted} with limits {self.limits.text()}; of "
            f"{self.searched} designs {self.fitted} were fitted, refused: {reasons}{nearest}; "
            + "; ".join(self._to_ease())
        )

    def _to_ease(self) -> list[str]:
        """What may be given up so that a design is found, and what may be a mistake."""
        faults = {refusal.fault for refusal in self.refusals}
        ways = []
        # where nothing closes, the limit has led the search
        led = not faults or "error" in faults
        if "transmission" in faults or (led and self.limits.transmission_lowest):
            ways.append("a smaller least transmission angle (0 for none)")
        if "size" in faults or ("error" in faults and self.limits.size is not None):
            ways.append("a wider range of sizes")
        if "motion type" in faults or ("error" in faults and self.wish and self.limits.motion_type):
            ways.append("another motion type, or any")
        if self.wish is None:
            ways.append("a smaller swing, or a time ratio nearer to 1")
        else:
            ways += ["a greater tolerance of the error"] if "error" in faults else []
            ways.append("a narrower range of the input, the output or x")
        hint = None if self.wish is None else self.wish.hint
        return ["try " + ", or ".join(ways), *([hint] if hint else [])]


def function_generation(
    points: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
    *,
    function: str | Callable[[Floats], Floats] | None = None,
    x_range: tuple[float, float] = (0.0, 1.0),
    input_range: tuple[float, float] = (0.0, math.pi / 2),
    output_range: tuple[float, float] = (0.0, math.pi / 2),
    precision: int | None = None,
    zeros: tuple[float, float] | None = None,
    tolerance: float = math.radians(2),
    limits: Limits = USUAL,
    count: int = 5,
    seed: int = 0,
    name: str | None = None,
    progress: Progress = silent,
) -> Synthesis:
    """RSSR designs for `points`, (inputs, outputs) [rad], or for a `function` of x over ranges [rad].

    Three to seven pairs (to five with `zeros` [rad] given) are met exactly, more as nearly as can be. A
    function is approached over the whole range, or met at `precision` Chebyshev points. No design with a
    greatest error above `tolerance` [rad] is given. The linkage is at zero + reading. `progress` is called
    with (done, total, the best so far); Ctrl+C ends the search with what it has. Raises `RequestError` for a
    wish that is none; one that cannot be met has no candidates.

        >>> found = function_generation(function="x^2", precision=3, count=1)
        >>> found.candidates[0].error_greatest < math.radians(1)
        True
    """
    need_scipy()
    check_count(count)
    if not 0 < tolerance <= math.pi:
        raise RequestError(f"tolerance: {math.degrees(tolerance):g} deg is none; give an angle > 0")
    if (points is None) == (function is None):
        raise RequestError("points: give pairs of angles or a function, one of the two")
    if points is not None:
        wish = wish_of_pairs(points[0], points[1], zeros=zeros, title=name or "pairs of angles")
    else:
        if zeros is not None:
            raise RequestError("zeros: are chosen for a function; leave them out, or give pairs of angles")
        assert function is not None
        wish = wish_of_function(function, x_range, input_range, output_range, points=precision, title=name)
    return _generated(wish, limits, tolerance, count, seed, progress)


def check_count(count: int) -> None:
    """Raises `RequestError` for a number of designs that is none."""
    if count < 1:
        raise RequestError(f"designs: {count} is no number of designs; give 1 or more")


def _generated(
    target: Wish, limits: Limits, tolerance: float, count: int, seed: int, progress: Progress
) -> Synthesis:
    most = max(FITTED_LEAST, FITTED_EACH * count)
    search: DesignSearch[Candidate] = DesignSearch(1 + most, progress, count=count)
    rows, zeros = starts(target, seed)
    started = chosen(target, limits, rows, zeros, most)
    search.step()
    with search.until_stopped(search.checked):
        # first the best of all; where starts end in one design, each with its own zero of the input
        _fit_each(search, target, limits, tolerance, started, hold=False)
        if not search.enough:
            search.longer(len(started))
            _fit_each(search, target, limits, tolerance, started, hold=True)
    return Synthesis(
        **vars(search.result(target.title)),
        wanted=target.title,
        limits=limits,
        searched=len(rows),
        fitted=len(started),
        seed=seed,
        wish=target,
    )


def _fit_each(
    search: DesignSearch[Candidate],
    target: Wish,
    limits: Limits,
    tolerance: float,
    started: list[Start],
    *,
    hold: bool,
) -> None:
    """Fits the starts and checks where they lead, with `hold` each with its own zero of the input."""
    ends: list[Floats] = []
    costs: list[float] = []

    def solve(start: Start) -> tuple[float, Candidate | Refusal] | None:
        others = len(costs) >= search.count and not hold
        hopeless = HOPELESS * sorted(costs)[search.count - 1] if others else math.inf
        fitted = _fitted(target, limits, start, ends, hopeless, hold=hold)
        if fitted is None:
            return None
        error, result = _judged(target, fitted, limits, tolerance)
        if isinstance(result, Candidate):
            costs.append(fitted.cost)
            error = -(result.transmission_lowest or 0.0) if target.pairs else error
        return error, result

    def enough() -> bool:
        if len(costs) < max(ENOUGH, 2 * search.count):
            return False
        return len(distinct([one for _, one in search.checked], scale_free=True)) >= search.count

    search.over(started, solve, transmits_best if target.pairs else least_error, enough=enough)


@dataclass(frozen=True, eq=False)
class _Fitted(Start):
    """Where a start led, its greatest error [rad] before errors were equalised, and its least squares."""

    before: float = math.nan
    cost: float = 0.0


def _task(target: Wish, limits: Limits, start: Start, *, hold: bool) -> DesignTask:
    """The wish as a task about a start, within the sizes; with `hold` its zero of the input stays."""
    inputs, outputs = target.input, target.output
    if target.function is not None:
        inputs = np.union1d(target.input, target.point_input)
        outputs = target.function(inputs)
    own = (float(start.zeros[0]) if hold else None, None)
    want = FunctionWant(inputs, outputs, own if target.zeros is None else target.zeros)
    low, high = limits.longest / limits.ratio, limits.longest
    row = start.row * math.sqrt(low * high / (start.row[2:5].min() * np.abs(start.row).max()))
    free = [FreeNumber(name, low if name in LINKS else -high, high) for name in NAMES]
    points = tuple(int(i) for i in np.searchsorted(inputs, target.point_input))
    return DesignTask(
        draft_of(row, target.title),
        tuple(free),
        (want,),
        (Most(0, 0.0, points),) if target.exact else (),
        goal="transmission" if target.pairs else "minimax",
        limits=limits,
    )


def _fitted(
    target: Wish, limits: Limits, start: Start, ends: list[Floats], hopeless: float, *, hold: bool
) -> _Fitted | None:
    """Where a start leads; `None` where that is `hopeless`, or one of the `ends`, which become more."""
    own = start.zeros[2 if target.zeros is not None else int(hold) :]
    if target.exact and len(NAMES) - 1 + own.size <= target.point_input.size:
        return _Fitted(start.row, start.zeros, start.branch)
    model = TaskModel(_task(target, limits, start, hold=hold))
    assert isinstance(model.loop, RssrLoop)
    inputs = model.wanted[0].stations.inputs(own)
    poses = model.loop.on_branch(model.loop.start, inputs, start.branch)
    seed, before, cost = TaskSeed(model.loop.start, (own,), poses, poses[0], 0.0), math.nan, 0.0
    if model.task.goal == "minimax":
        look = solved(model, seed, LOOK if model.holds or model.turns else FREE_LOOK, whole=False)
        if look is None:
            return None
        seed, cost = look.seed, look.cost
        end = np.concatenate([seed.values / seed.values[4], *seed.own])
        if cost > hopeless or any(np.abs(end - other).max() < ENDS_APART for other in ends):
            return None
        ends.append(end)
        near = TaskProblem(model, seed)
        values = near.at(near.start)
        if values is not None and not hold:
            before = math.sqrt(inputs.size) * float(np.abs(values.residuals).max())
    result = solved(model, seed, 0)
    if result is None:
        return None
    zeros = start.zeros.copy()
    zeros[zeros.size - own.size :] = result.seed.own[0]
    return _Fitted(result.seed.values, zeros, start.branch, before, cost)


def _judged(
    target: Wish, point: _Fitted, limits: Limits, tolerance: float
) -> tuple[float, Candidate | Refusal]:
    """A design as the ordinary analysis finds it, and its greatest error [rad], infinite without one."""
    rows, zeros = point.row[None], point.zeros[None]
    if target.zeros is None:
        rows, zeros = reflected(rows, zeros)
    elif np.abs(np.exp(1j * (point.zeros - np.array(target.zeros))) - 1).max() > ON_BRANCH:
        return math.inf, Refusal("assembly", "needs the crank on the other side of its zero")
    row, zero = scaled(rows[0], limits.longest), zeros[0]
    dense = np.union1d(target.dense, target.input if target.function is None else target.point_input)
    angles = outputs(row[None], zero[0] + dense, point.branch)[0]
    if not np.isfinite(angles).all():
        return math.inf, Refusal("assembly", "cannot reach the whole range of the input")
    angles = np.unwrap(angles)
    at, wanted = (target.input, target.output) if target.function is None else (dense, target.function(dense))
    errors = short_way(np.interp(at, dense, angles) - zero[1] - wanted)
    greatest = float(np.abs(errors).max())
    if greatest > tolerance:
        detail = (
            f"greatest error {math.degrees(greatest):.3g} deg, {math.degrees(tolerance):g} deg are allowed"
        )
        return greatest, Refusal("error", detail)
    figures = {"input_zero_deg": math.degrees(zero[0]), "output_zero_deg": math.degrees(zero[1])}
    if math.isfinite(point.before):
        figures["error_greatest_least_squares_deg"] = math.degrees(point.before)
    claim = Claim(zero[0] + dense, angles, errors, "deg", figures)
    return greatest, checked(draft_of(row, target.title), claim, limits)
