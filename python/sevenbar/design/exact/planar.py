"""Planar four-bars whose coupler takes three, four or five given poses: Burmester's problem.

A dyad is a fixed pivot g and a point that has m in the first pose and stays on a circle about g. With the
displacement x -> R x + d from the first pose and homogeneous (g, 1), (m, 1),

    (g, 1)^T T (m, 1) = 0,    T = [ 1 - R, -d ; d^T R, d.d / 2 ]                                          (1)

for each further pose. Of the 6 points of four such forms two are always m = (1, +-i, 0), g alike: the
circular points. So five poses have 4 dyads. With m at infinity the crank is a slider on the body, with g at
infinity one on the ground.

Source: docs/theory_design.md, (31).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.design.exact.answers import ExactAnswers
from sevenbar.design.exact.bilinear import POINTS, Complexes, solutions
from sevenbar.design.exact.draws import family
from sevenbar.design.exact.dyads import Dyad, Line
from sevenbar.design.exact.given import Displacements, numbers_given, place_text, planar_given
from sevenbar.design.exact.loops import all_loops, drawn, loops_of_pairs
from sevenbar.errors import RequestError, ends_here, shown
from sevenbar.kinematics.loop.rigid import axial, pose, turns_about

#: What a point is called, several, and the curve that four poses leave them.
PIVOTS = ("pivot", "pivots", "curve")

#: Dyads of five poses over the complex numbers.
DYADS = 4

#: Last coordinate [-, lengths relative to the task's] below which a point is at infinity.
AT_INFINITY = 1e-8

#: Length of a crank, relative to the task's, below which it is none; and a turn [rad] that is none.
NOTHING = 1e-9

Z = np.array([0.0, 0.0, 1.0])


@ends_here
def planar_poses(
    poses: npt.ArrayLike,
    *,
    moving: npt.ArrayLike | None = None,
    samples: int = 16,
    seed: int = 0,
    length_unit: str = "mm",
) -> ExactAnswers:
    """Planar four-bars whose coupler takes poses (n, 3), rows x, y [length] and angle [rad].

    Five poses: all dyads, up to 4 real ones, and every pair of them as a linkage. Four: `samples` dyads on
    the curve of moving pivots, drawn by `seed`. Three: `moving` (k, 2) pivots in ground coordinates at the
    first pose, or `samples` drawn ones; of such families dyads 1 and 2, 3 and 4 .. make a linkage each.
    Raises `RequestError` where poses are equal or have infinitely many dyads.

        >>> found = planar_poses([(0, 0, 0), (5, 3, 0.3), (9, 8, 0.5), (15, 9, 0.9), (22, 8, 1.4)])
        >>> found.complete, found.real, len(found.answers)
        (True, 2, 2)

    Source: L. Burmester, "Lehrbuch der Kinematik" (1888); docs/theory_design.md, (31).
    """
    task = planar_given(poses, 3, 5)
    _refuse_special(task)
    forms = _forms(task)
    title, count = f"{len(task.motions)} poses in a plane", len(task.motions)
    if moving is not None and count != 3:
        raise RequestError(f"moving: with {count} poses the pivots are not free; leave them out")
    if count == 5:
        result = solutions(forms)
        if result is None:
            raise RequestError(
                "poses: infinitely many dyads or sliders take these five; give four of them, or change one"
            )
        circular = np.array([_is_circular(b) for b in result.b])
        selected = np.flatnonzero(result.real & ~circular)
        dyads = _dyads([(result.a[i].real, result.b[i].real) for i in selected], task)
        how = (
            f"{POINTS} common points of four cubics by eigenvalues, without the circular points, "
            f"{int(result.multiplicity[circular].sum())} of them"
        )
        answers = all_loops(dyads, task, "Planar four-bar", length_unit)
        known = int(result.multiplicity[~circular].sum())
        return ExactAnswers(title, "dyads", DYADS, known, len(selected), answers, how, drawn(dyads, task))
    given = None if moving is None else _given_points(moving, task)
    pairs, how = family(forms, given, samples, seed, PIVOTS)
    dyads = _dyads(pairs, task)
    answers = loops_of_pairs(dyads, task, "Planar four-bar", length_unit)
    return ExactAnswers(title, "dyads", None, None, len(dyads), answers, how, drawn(dyads, task))


def planar_dyads(task: Displacements, samples: int, seed: int) -> list[Dyad]:
    """The dyads that take planar poses: all real ones of five; of four or three `samples`, drawn by a seed.

    None where poses are special, so that infinitely many take five.
    """
    forms = _forms(task)
    if len(task.motions) == 5:
        result = solutions(forms)
        rows = () if result is None else zip(result.a, result.b, result.real, strict=True)
        pairs = [(a.real, b.real) for a, b, real in rows if real and not _is_circular(b)]
    else:
        pairs, _ = family(forms, None, samples, seed, PIVOTS)
    return _dyads(pairs, task)


def _forms(task: Displacements) -> Floats:
    """The forms T (n - 1, 3, 3) of (1)."""
    turns, shifts = task.turns[:, :2, :2], task.shifts[:, :2]
    result = np.zeros((len(turns), 3, 3))
    for form, turn, shift in zip(result, turns, shifts, strict=True):
        form[:2, :2], form[:2, 2] = np.eye(2) - turn, -shift
        form[2, :2], form[2, 2] = shift @ turn, shift @ shift / 2
    return result


def _is_circular(point: Complexes) -> bool:
    x, y, last = point
    return bool(abs(last) < AT_INFINITY and abs(x * x + y * y) < AT_INFINITY)


def _dyads(pairs: list[tuple[Floats, Floats]], task: Displacements) -> list[Dyad]:
    """The dyads of pairs of homogeneous points; without those that have no crank."""
    result = (_dyad(a / np.linalg.norm(a), b / np.linalg.norm(b), task) for a, b in pairs if np.any(a))
    return [dyad for dyad in result if dyad is not None]


def _dyad(a: Floats, b: Floats, task: Displacements) -> Dyad | None:
    fixed_far, moving_far = abs(a[2]) < AT_INFINITY, abs(b[2]) < AT_INFINITY
    if fixed_far and moving_far:
        return None
    body = task.motions
    if moving_far:  # the body slides along a line whose normal is b
        g = np.append(a[:2] / a[2] * task.reach, 0.0)
        link = pose(body[:, :3, :3], g - body[:, :3, :3] @ g)
        return Dyad(Line("R", g, Z), Line("P", g, _across(b)), link)
    m = np.append(b[:2] / b[2] * task.reach, 0.0)
    places = body[:, :3, :3] @ m + body[:, :3, 3]
    if fixed_far:
        return Dyad(Line("P", m, _across(a)), Line("R", m, Z), pose(np.eye(3), places - m))
    g = np.append(a[:2] / a[2] * task.reach, 0.0)
    arms = places - g
    if math.hypot(*arms[0]) < NOTHING * task.reach:
        return None
    angles = np.arctan2(arms[:, 1], arms[:, 0]) - math.atan2(arms[0, 1], arms[0, 0])
    turns = turns_about(Z, angles)
    return Dyad(Line("R", g, Z), Line("R", m, Z), pose(turns, g - turns @ g))


def _across(normal: Floats) -> Floats:
    direction = np.array([-normal[1], normal[0], 0.0])
    return np.asarray(direction / np.linalg.norm(direction))


def _given_points(moving: npt.ArrayLike, task: Displacements) -> Floats:
    points = numbers_given("moving", moving)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
        raise RequestError(
            f"moving: {shown(moving)} are no pivots; give two or more places x, y in the first pose"
        )
    return np.column_stack([(points - task.origin[:2]) / task.reach, np.ones(len(points))])


def _refuse_special(task: Displacements) -> None:
    """`RequestError` for poses that one joint takes, or a parallelogram only."""
    angles = np.abs(np.arctan2(axial(task.turns)[:, 2], task.turns[:, 0, 0]))
    if (angles < NOTHING).all():
        raise RequestError(
            "poses: all have the same angle, and a parallelogram or a slide takes them; turn one of them"
        )
    pole = task.centre
    if pole is not None:
        raise RequestError(
            f"poses: all are turns about one point, {place_text(pole[:2], task.reach)}, and a hinge there "
            "takes them; shift one of the poses"
        )
