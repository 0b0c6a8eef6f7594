"""Spatial linkages RCCC and CCCC whose coupler takes given poses: dyads of cylindrical joints.

A dyad is two lines, eight numbers. The angle and the distance of the lines stay (CC), so does the place on
the fixed line (RC), so does that on the moving line (RR): 2, 3, 4 equations for each pose after the first,

    CC    5 poses: 6 dyads, as many as spherical ones of the directions; the places are linear equations
    RC    3 poses: one dyad for each direction of the moving line, two numbers free; none for 4 poses
    RR    3 poses: 2 real dyads, which make a Bennett linkage (`bennett`)

So five general poses give CCCC linkages, which have two freedoms, and none with an R joint.

Source: docs/theory_design.md, (33) to (35).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sevenbar.design.exact.answers import ExactAnswer, ExactAnswers
from sevenbar.design.exact.bilinear import POINTS, solutions
from sevenbar.design.exact.draws import directions
from sevenbar.design.exact.given import Displacements, place_text, poses_given
from sevenbar.design.exact.lines import found_dyad
from sevenbar.design.exact.loops import all_loops, drawn, loop
from sevenbar.design.exact.spherical import NOTHING, refuse_one_axis
from sevenbar.errors import RequestError, ends_here

#: Dyads CC of five poses over the complex numbers.
DYADS = POINTS


@ends_here
def cc_dyads(poses: npt.ArrayLike, *, length_unit: str = "mm") -> ExactAnswers:
    """The dyads CC, up to 6 real ones, that take five poses (5, 4, 4), and every pair as a linkage CCCC.

    These linkages have two freedoms: they take all poses, and no input alone leads them from one to the
    next, so they have no verdict. Raises `RequestError` where poses are equal, their rotations have one axis
    or infinitely many dyads.

        >>> from sevenbar.kinematics.loop.rigid import about, pose
        >>> places = [(0, 0, 0), (10, 4, 2), (15, 9, 8), (22, 8, 9), (30, 5, 20)]
        >>> turns = [about(2, 0.3 * i) @ about(0, 0.2 * i * i) @ about(1, 0.1 * i) for i in range(5)]
        >>> found = cc_dyads(pose(turns, places))
        >>> found.complete, found.real, found.answers[0].linkage.kind
        (True, 2, 'CCCC')

    Source: docs/theory_design.md, (33) to (35).
    """
    task = poses_given(poses, 5, 5)
    _refuse_special(task)
    result = solutions(task.turns - np.eye(3))
    if result is None:
        raise RequestError(
            "poses: infinitely many directions of dyads take these five orientations; change one of them"
        )
    real = [(result.a[i].real, result.b[i].real) for i in np.flatnonzero(result.real)]
    every = [found_dyad(a, b, "CC", task) for a, b in real if np.linalg.norm(np.cross(a, b)) >= NOTHING]
    dyads = [dyad for dyad in every if dyad is not None]
    answers = all_loops(dyads, task, "Linkage CCCC", length_unit)
    how = f"{POINTS} pairs of directions as of spherical dyads, the places of each from 4 linear equations"
    known = int(result.multiplicity.sum())
    return ExactAnswers(
        "5 poses in space", "dyads", DYADS, known, len(dyads), answers, how, drawn(dyads, task)
    )


@ends_here
def rccc_poses(
    poses: npt.ArrayLike, *, samples: int = 8, seed: int = 0, length_unit: str = "mm"
) -> ExactAnswers:
    """Linkages RCCC whose coupler takes three poses (3, 4, 4): members of their family, drawn by `seed`.

    The direction of the moving line of the dyad RC is free, all else of it follows; the dyad CC has its
    direction and two more numbers free. Four poses leave no dyad RC. Raises `RequestError` where poses are
    equal or their rotations have one axis.
    """
    task = poses_given(poses, 3, 3)
    _refuse_special(task)
    forms = task.turns - np.eye(3)
    answers: list[ExactAnswer] = []
    for draw in directions(samples, 8, seed):
        ways = (("RC", draw[:3], None), ("CC", draw[3:6], 3 * draw[6:]))
        result = [found_dyad(np.cross(*(forms @ b)), b, kind, task, free) for kind, b, free in ways]
        dyads = [dyad for dyad in result if dyad is not None]
        if len(dyads) == 2:
            title = f"Linkage RCCC {len(answers) + 1}"
            answers.append(loop(dyads[0], dyads[1], task, title, length_unit))
    how = f"one dyad RC for each direction of its moving line, drawn with seed {seed}"
    return ExactAnswers("3 poses in space", "linkages", None, None, len(answers), tuple(answers), how)


def _refuse_special(task: Displacements) -> None:
    """`RequestError` for poses whose rotations have one axis, or that leave a point where it is."""
    refuse_one_axis(task.turns, "poses")
    if task.centre is not None:
        place = place_text(task.centre, task.reach)
        raise RequestError(
            f"poses: all are turns about one point, {place}, which spherical linkages "
            "take: give their rotations to spherical_orientations"
        )
