"""Function generation: RSSR designs whose output follows a wanted function of the input.

Exact precision points come in closed form (`precision`); a whole range from a global search, whose starts are
designs of least linear closure error for zeros of a Sobol sequence and plain Sobol designs, thousands at
once, the best of which are fitted (`fitting`). All go through the ordinary analysis (`candidates`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
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
    ranked,
    renamed,
    tally,
    transmits_best,
)
from sevenbar.design.closure import draft_of, outputs, scaled, transmissions
from sevenbar.design.course import SearchCourse
from sevenbar.design.limits import INPUT_TURNS, Limits
from sevenbar.design.synthesis.function.fitting import Estimate, Fit
from sevenbar.design.synthesis.function.precision import designs_of, reflected, system, through
from sevenbar.design.wish import Wish, wish_of_function, wish_of_pairs
from sevenbar.errors import MissingExtraError, RequestError
from sevenbar.text.expression import function_of
from sevenbar.text.printing import Printed
from sevenbar.text.progress import Progress, silent

#: What a design must keep to where nothing else is given.
USUAL = Limits(transmission_lowest=math.radians(30))

#: Designs of the global search: of each kind.
SEARCHED = 4096

#: How many of them are fitted for each design requested, and at least.
FITTED_EACH, FITTED_LEAST = 4, 16

#: Greatest error [rad] at precision points with which a start is on one branch.
ON_BRANCH = 1e-6

#: Two starts are one where no unknown differs by more [parts of L3, rad].
START_APART = 0.15

#: Two fits ended in one place where no unknown differs by more.
ENDS_APART = 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class Synthesis(Printed):
    """Designs found for a wish, best first, and what was refused on the way.

    `searched` designs were compared and `fitted` of them refined; `refusals` begin with the nearest.
    """

    wanted: str
    limits: Limits
    candidates: tuple[Candidate, ...]
    refusals: tuple[Refusal, ...]
    searched: int
    fitted: int
    seed: int
    #: The wanted function, `None` for another wish.
    wish: Wish | None = None
    #: The remark about a search that was stopped; empty for one that ended by itself.
    unfinished: str = ""

    def required(self) -> tuple[Candidate, ...]:
        """The candidates; `RequestError` saying what was nearest where there are none."""
        if self.candidates:
            return self.candidates
        reasons = tally(self.refusals) or "none closes on one branch over the range"
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
        if "transmission" in faults or ("error" in faults and self.limits.transmission_lowest):
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
    if count < 1:
        raise RequestError(f"designs: {count} is no number of designs; give 1 or more")
    if not 0 < tolerance <= math.pi:
        raise RequestError(f"tolerance: {math.degrees(tolerance):g} deg is none; give an angle > 0")
    if (points is None) == (function is None):
        raise RequestError("points: give pairs of angles or a function, one of the two")
    if points is not None:
        wish = wish_of_pairs(points[0], points[1], zeros=zeros, title=name or "pairs of angles")
    else:
        if zeros is not None:
            raise RequestError("zeros: are chosen for a function; leave them out, or give pairs of angles")
        title = name or (f"y = {function}" if isinstance(function, str) else "y(x)")
        called = function_of(function) if isinstance(function, str) else function
        assert called is not None
        wish = wish_of_function(
            called,
            x_range,
            input_range,
            output_range,
            points=precision,
            title=title,
            formula=function if isinstance(function, str) else None,
        )
    return _found(wish, limits, tolerance, count, seed, progress)


def need_scipy() -> None:
    """Raises `MissingExtraError` where scipy is not installed."""
    try:
        import scipy.optimize
        import scipy.stats  # noqa: F401
    except ImportError:
        raise MissingExtraError(
            "design needs scipy and tomlkit; install them with: pip install 'sevenbar[design]'"
        ) from None


def _found(
    wish: Wish, limits: Limits, tolerance: float, count: int, seed: int, progress: Progress
) -> Synthesis:
    course = SearchCourse(1 + max(FITTED_LEAST, FITTED_EACH * count), progress)
    rows, zeros = starts(wish, seed)
    fit = Fit(wish, limits)
    chosen = _chosen(fit, rows, zeros, course.total - 1)
    course.step()
    kept: list[Candidate] = []
    refused: list[tuple[float, Refusal]] = []
    by_transmission = wish.exact and wish.function is None
    key = (lambda c: -(c.transmission_lowest or 0.0)) if by_transmission else None
    best: list[Candidate] = []
    unfinished = ""
    try:
        # first the best of all; where starts end in one design, each with its own zero of the input
        for hold in (False, True):
            for fitted in _refined(fit, chosen, hold=hold):
                if fitted is not None:
                    error, result = _judged(wish, *fitted, limits, tolerance)
                    if isinstance(result, Candidate):
                        kept.append(result)
                    else:
                        refused.append((error, result))
                course.step(transmits_best(kept) if by_transmission else least_error(kept))
            best = distinct(ranked(kept, key), scale_free=True, count=count)
            if len(best) == count:
                break
            if not hold:
                course.longer(len(chosen))
        course.end()
    except KeyboardInterrupt:
        if not kept:
            raise
        best = distinct(ranked(kept, key), scale_free=True, count=count)
        unfinished = course.unfinished
    refusals = tuple(refusal for _, refusal in sorted(refused, key=lambda pair: pair[0]))
    return Synthesis(
        wish.title,
        limits,
        tuple(renamed(best, wish.title)),
        refusals,
        len(rows),
        len(chosen),
        seed,
        wish,
        unfinished,
    )


def starts(wish: Wish, seed: int) -> tuple[Floats, Floats]:
    """Designs (n, 6), L3 = 1, and zeros (n, 2) from which fits begin: exact ones, or of a global search."""
    from scipy.stats import qmc

    if wish.exact:
        return through(wish.point_input, wish.point_output, zeros=wish.zeros, samples=4 * SEARCHED, seed=seed)
    draws = qmc.Sobol(7, seed=seed).random(SEARCHED)
    # of least closure error for given zeros: (1) of `precision` is linear
    zeros = draws[:, :2] * math.pi if wish.zeros is None else np.tile(wish.zeros, (1, 1))
    sides, right = system(wish.input + zeros[:, :1], wish.output + zeros[:, 1:])
    linear = designs_of(np.einsum("mij,mj->mi", np.linalg.pinv(sides), right), zeros)
    # and any at all, the output's zero where the mean error is none
    rows = np.ones((SEARCHED, 6))
    rows[:, [0, 1, 5]] = 5.0 * draws[:, :3] - 2.5
    rows[:, [2, 3]] = 6.0 ** (2 * draws[:, 3:5] - 1)
    first = draws[:, 5] * math.tau if wish.zeros is None else np.full(SEARCHED, wish.zeros[0])
    branch = (draws[:, 6] < 0.5).astype(int)
    angles = np.where(
        branch[:, None],
        outputs(rows, first[:, None] + wish.input, 1),
        outputs(rows, first[:, None] + wish.input, 0),
    )
    good = np.isfinite(angles).all(axis=1)
    off = np.unwrap(angles[good] - wish.output, axis=1).mean(axis=1)
    second = off if wish.zeros is None else np.full(len(off), wish.zeros[1])
    both = np.concatenate([linear[0], rows[good]])
    pairs = np.concatenate([linear[1], np.column_stack([first[good], second])])
    return (both, pairs) if wish.zeros is not None else reflected(both, pairs)


def _chosen(fit: Fit, rows: Floats, zeros: Floats, most: int) -> list[Estimate]:
    """The most promising starts that differ: little error, limits nearly kept, all points on one branch."""
    wish, limits = fit.wish, fit.limits
    scored: list[tuple[float, Estimate]] = []
    square = transmissions(rows, zeros[:, :1] + fit.used)
    ratio = np.abs(rows).max(axis=1) / rows[:, 2:5].min(axis=1)
    missed = np.maximum(
        math.sin(limits.transmission_lowest) - np.sqrt(np.maximum(square.min(axis=1), 0.0)), 0.0
    )
    missed = missed + 0.1 * np.maximum(np.log(ratio / limits.ratio), 0.0)
    if limits.motion_type in INPUT_TURNS:
        turn = np.linspace(0.0, math.tau, 36, endpoint=False)
        missed = missed + np.maximum(-transmissions(rows, turn).min(axis=1), 0.0)
    for branch in (0, 1):
        angles = outputs(rows, zeros[:, :1] + fit.input, branch)
        off = short_way(angles - zeros[:, 1:] - fit.wanted)
        at_points = np.abs(off[:, fit.points]).max(axis=1) if wish.exact else np.zeros(len(rows))
        rms = np.sqrt((off[:, fit.range] ** 2).mean(axis=1)) + missed
        good = np.isfinite(off).all(axis=1) & (square.min(axis=1) > 0) & (at_points < ON_BRANCH)
        scored += [(float(rms[i]), Estimate(rows[i], zeros[i], branch)) for i in np.flatnonzero(good)]
    scored.sort(key=lambda pair: pair[0])
    chosen: list[Estimate] = []
    seen = np.empty((0, 8))
    for _, point in scored:
        own = np.concatenate([np.arctan(point.row), np.cos(point.zeros)])
        if not len(seen) or np.abs(seen - own).max(axis=1).min() > START_APART:
            chosen.append(point)
            seen = np.concatenate([seen, own[None]])
        if len(chosen) == most:
            break
    return chosen


def _refined(fit: Fit, chosen: list[Estimate], *, hold: bool) -> Iterator[tuple[Estimate, float] | None]:
    """The designs that starts lead to, with their greatest errors before these were equalised [rad].

    `None` for a start that leads where another did.
    """
    seen: list[Floats] = []
    for start in chosen:
        free = len(fit.packed(start)) - fit.wish.point_input.size - hold
        if fit.wish.exact and (free <= 0 or fit.wish.function is None):
            near = fit.exact(start)
            yield (fit.exact(fit.equalised(near, hold=hold)) if free > 0 else near), math.nan
            continue
        near = start if hold else fit.least_squares(start)
        own = fit.packed(near)
        if any(np.abs(own - other).max() < ENDS_APART for other in seen):
            yield None
            continue
        seen.append(own)
        before = float(np.abs(fit.errors(own, near.branch)[0]).max())
        found = fit.equalised(near, hold=hold)
        yield fit.exact(found) if fit.wish.exact else found, math.nan if hold else before


def _judged(
    wish: Wish, point: Estimate, before: float, limits: Limits, tolerance: float
) -> tuple[float, Candidate | Refusal]:
    """A design as the ordinary analysis finds it, and its greatest error [rad], infinite without one."""
    rows, zeros = point.row[None], point.zeros[None]
    if wish.zeros is None:
        rows, zeros = reflected(rows, zeros)
    elif np.abs(np.exp(1j * (point.zeros - np.array(wish.zeros))) - 1).max() > ON_BRANCH:
        return math.inf, Refusal("assembly", "needs the crank on the other side of its zero")
    row, zero = scaled(rows[0], limits.longest), zeros[0]
    dense = np.union1d(wish.dense, wish.input if wish.function is None else wish.point_input)
    angles = outputs(row[None], zero[0] + dense, point.branch)[0]
    if not np.isfinite(angles).all():
        return math.inf, Refusal("assembly", "cannot reach the whole range of the input")
    angles = np.unwrap(angles)
    at, wanted = (wish.input, wish.output) if wish.function is None else (dense, wish.function(dense))
    errors = short_way(np.interp(at, dense, angles) - zero[1] - wanted)
    greatest = float(np.abs(errors).max())
    if greatest > tolerance:
        detail = (
            f"greatest error {math.degrees(greatest):.3g} deg, {math.degrees(tolerance):g} deg are allowed"
        )
        return greatest, Refusal("error", detail)
    figures = {"input_zero_deg": math.degrees(zero[0]), "output_zero_deg": math.degrees(zero[1])}
    if math.isfinite(before):
        figures["error_greatest_least_squares_deg"] = math.degrees(before)
    claim = Claim(zero[0] + dense, angles, errors, "deg", figures)
    return greatest, checked(draft_of(row, wish.title), claim, limits)
