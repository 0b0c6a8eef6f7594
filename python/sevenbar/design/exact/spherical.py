"""Spherical four-bars whose coupler takes three, four or five given orientations.

A dyad is a fixed axis a and an axis of the body, b in the first orientation, whose angle does not change.
With the rotation R from the first orientation

    a^T (R - 1) b = 0                                                                                     (1)

for each further one: four bilinear forms have 6 common points, and all of them are dyads.

Source: docs/theory_design.md, (32).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, positive_length
from sevenbar.design.exact.answers import ExactAnswers
from sevenbar.design.exact.bilinear import POINTS, solutions
from sevenbar.design.exact.draws import family
from sevenbar.design.exact.dyads import Dyad, Line
from sevenbar.design.exact.given import Displacements, numbers_given, orientations_given, place_text
from sevenbar.design.exact.lines import facing, link_motions
from sevenbar.design.exact.loops import all_loops, drawn, loops_of_pairs
from sevenbar.errors import RequestError, ends_here, shown
from sevenbar.kinematics.loop.rigid import pose

#: Dyads of five orientations over the complex numbers.
DYADS = POINTS

#: Sine of the angle of two axes [-] below which they are one.
NOTHING = 1e-9


@ends_here
def spherical_orientations(
    orientations: npt.ArrayLike,
    *,
    moving: npt.ArrayLike | None = None,
    samples: int = 16,
    seed: int = 0,
    radius: float = 100.0,
    length_unit: str = "mm",
) -> ExactAnswers:
    """Spherical four-bars about the origin whose coupler takes rotation matrices (n, 3, 3).

    Five orientations: all dyads, up to 6 real ones, and every pair of them as a linkage. Four: `samples`
    dyads on the cone of moving axes, drawn by `seed`. Three: `moving` axes (k, 3) in the first orientation,
    or `samples` drawn ones; of such families dyads 1 and 2, 3 and 4 .. make a linkage each. The joints are
    drawn on a sphere of this `radius`. Raises `RequestError` where orientations are equal, or have
    infinitely many dyads.

        >>> from sevenbar.kinematics.loop.rigid import about
        >>> turns = [about(2, 0.3 * i) @ about(0, 0.2 * i * i) @ about(1, 0.1 * i) for i in range(5)]
        >>> found = spherical_orientations(turns)
        >>> found.complete, found.real
        (True, 2)

    Source: J. M. McCarthy and G. S. Soh, "Geometric design of linkages" (2011); docs/theory_design.md, (32).
    """
    task = orientations_given(orientations, 3, 5)
    radius = positive_length("radius", radius)
    refuse_one_axis(task.turns, "orientations")
    forms, count = task.turns - np.eye(3), len(task.motions)
    title = f"{count} orientations"
    if moving is not None and count != 3:
        raise RequestError(f"moving: with {count} orientations the axes are not free; leave them out")
    if count == 5:
        result = solutions(forms)
        if result is None:
            raise RequestError(
                "orientations: infinitely many dyads take these five; give four of them, or change one"
            )
        selected = np.flatnonzero(result.real)
        dyads = _dyads([(result.a[i].real, result.b[i].real) for i in selected], task, radius)
        answers = all_loops(dyads, task, "Spherical four-bar", length_unit)
        how = f"{POINTS} common points of four cubics by eigenvalues"
        known = int(result.multiplicity.sum())
        return ExactAnswers(title, "dyads", DYADS, known, len(selected), answers, how, drawn(dyads, task))
    given = None if moving is None else _given_axes(moving)
    pairs, how = family(forms, given, samples, seed, ("axis", "axes", "cone"))
    dyads = _dyads(pairs, task, radius)
    answers = loops_of_pairs(dyads, task, "Spherical four-bar", length_unit)
    return ExactAnswers(title, "dyads", None, None, len(dyads), answers, how, drawn(dyads, task))


def refuse_one_axis(turns: Floats, what: str) -> None:
    """`RequestError` for rotations (n, 3, 3) about one axis: a hinge and infinitely many dyads take them."""
    # a direction that no rotation moves
    _, sizes, base = np.linalg.svd(np.concatenate(turns - np.eye(3)))
    if sizes[0] < NOTHING:
        raise RequestError(f"{what}: all have one orientation; turn one of them")
    if sizes[-1] < NOTHING * sizes[0]:
        axis = place_text(base[-1] * np.sign(base[-1][np.abs(base[-1]).argmax()]), 1.0)
        raise RequestError(
            f"{what}: all are turns about one direction, {axis}, as those of a plane; "
            "turn one of them about another"
        )


def _dyads(pairs: list[tuple[Floats, Floats]], task: Displacements, radius: float) -> list[Dyad]:
    """The dyads of pairs of axes; without those whose link has no length."""
    result = []
    for a, b in pairs:
        if not np.any(a):
            continue
        a, b = facing(a, b)
        if np.linalg.norm(np.cross(a, b)) > NOTHING:
            link = link_motions(a, b, np.einsum("nij,j->ni", task.motions[:, :3, :3], b))
            result.append(Dyad(Line("R", radius * a, a), Line("R", radius * b, b), pose(link)))
    return result


def _given_axes(moving: npt.ArrayLike) -> Floats:
    axes = numbers_given("moving", moving)
    sound = axes.ndim == 2 and axes.shape[1:] == (3,) and len(axes) > 1
    if not (sound and np.linalg.norm(axes, axis=1).all()):
        raise RequestError(
            f"moving: {shown(moving)} are no axes; give two or more directions x, y, z, as they are in the "
            "first orientation"
        )
    return axes
