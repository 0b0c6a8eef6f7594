"""A path design as the ordinary analysis finds it: its written file is opened and its motion asked again."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sevenbar.design.synthesis.candidates import Candidate, Claim, Refusal, checked
from sevenbar.design.synthesis.path_match import STILL, Placing, placed
from sevenbar.design.synthesis.path_refine import Refined
from sevenbar.design.synthesis.path_search import SAMPLES
from sevenbar.design.synthesis.path_task import PathTask
from sevenbar.draft import Draft
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.linkage import Linkage
from sevenbar.motion import Floats, Law


@dataclass(frozen=True, eq=False)
class Made:
    """What a linkage makes of the wanted points at given inputs, on one pass.

    `places` (n, 3) as placed, `poses` (n, columns), `errors` (n,) how far each place is from its point.
    """

    places: Floats
    poses: Floats
    placing: Placing
    errors: Floats


def made(linkage: Linkage, name: str, inputs: Floats, wanted: Floats, *, place: bool) -> Made | None:
    """The pass of the ordinary analysis that comes nearest to the wanted points (n, 3) at inputs (n,).

    `None` where no pass reaches all of the inputs.
    """
    count = len(inputs)
    law = Law.of(np.arange(count, dtype=np.float64), inputs, 1.0, 0.0)
    point = next(p for p in linkage.points if p.name == name)
    best: Made | None = None
    for circuit in linkage.motion(law=law).circuits:
        trace = circuit.point(point.link, point.at).position
        # a circuit that rocks has the inputs once for each of its passes
        for begin in range(0, len(trace), count):
            places, poses = trace[begin : begin + count], circuit.q[begin : begin + count]
            if not (np.isfinite(places).all() and np.isfinite(poses).all()):
                continue
            placing = placed(wanted, places) if place else STILL
            put = placing.put(places)
            errors = np.linalg.norm(put - wanted, axis=1)
            if best is None or (errors**2).sum() < (best.errors**2).sum():
                best = Made(put, poses, placing, errors)
    return best


def checked_path(task: PathTask, solution: Refined) -> Candidate | Refusal:
    """The design with its error recomputed from what is written, or why it does not make the path.

    All points on one pass of one circuit, in their order; a closed path needs an input that turns fully.
    """
    draft = task.drawn(solution.varied)
    try:
        linkage = Draft.of(draft.toml(), "design").linkage
        found = made(linkage, task.point.name, solution.inputs, task.wanted, place=task.place)
    except (DescriptionError, RequestError) as error:
        return Refusal("assembly", str(error))
    if found is None:
        return Refusal(
            "dead centre", "no pass reaches the inputs of all points without a dead centre between"
        )
    figures = _standing(found.placing, linkage.length_unit) if task.place else {}
    if task.place and "joint" in task.draft.raw:
        draft, figures = moved(draft, found.placing), {}
    outputs = found.poses[:, linkage.columns.index(linkage.drive.output)]
    claim = Claim(solution.inputs, outputs, found.errors, linkage.length_unit, figures)
    candidate = checked(draft, claim, task.limits, poses=found.poses)
    if isinstance(candidate, Candidate) and task.closed:
        circuit = draft.linkage.motion(SAMPLES).circuits[candidate.circuit]
        if circuit.input_range is not None:
            return Refusal(
                "dead centre",
                "the path is closed, and a dead centre lies between its last point and its first",
            )
    return candidate


def _standing(placing: Placing, unit: str) -> Mapping[str, float]:
    """Where the linkage stands so that its point goes through the wanted points: a turn, then a shift.

    `turn_x`, `turn_y`, `turn_z` is the axis of one turn times its angle.
    """
    turn = np.degrees(rotation_vector(placing.rotation))
    names = [f"shift_{letter}_{unit}" for letter in "xyz"] + [f"turn_{letter}_deg" for letter in "xyz"]
    return dict(zip(names, map(float, [*placing.shift, *turn]), strict=True))


def rotation_vector(rotation: Floats) -> Floats:
    """The axis of a rotation (3, 3) times its angle [rad], (3,)."""
    skew = np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    sine, cosine = float(np.linalg.norm(skew)) / 2, (float(np.trace(rotation)) - 1) / 2
    angle = math.atan2(sine, cosine)
    if sine > 1e-6:
        return np.asarray(skew / 2 / sine * angle)
    if cosine > 0:
        return np.asarray(skew / 2)
    # half a turn: the axis is the column that is longest in R + 1
    columns = rotation + np.eye(3)
    axis = columns[:, int(np.linalg.norm(columns, axis=0).argmax())]
    return np.asarray(axis / np.linalg.norm(axis) * angle)


def moved(draft: Draft, placing: Placing) -> Draft:
    """A drawn linkage with all its places and directions moved."""

    def put(table: Mapping[str, object]) -> dict[str, object]:
        own = dict(table)
        for key, value in table.items():
            if key == "at":
                own[key] = [float(x) for x in placing.put(np.array(value, dtype=np.float64))]
            elif key == "axis":
                own[key] = [float(x) for x in placing.rotation @ np.array(value, dtype=np.float64)]
            elif key == "axes":
                own[key] = (np.array(value, dtype=np.float64) @ placing.rotation.T).tolist()
        return own

    draft = draft.with_value(("joint",), [put(joint) for joint in draft.raw["joint"]])
    if "point" in draft.raw:
        draft = draft.with_value(("point",), [put(point) for point in draft.raw["point"]])
    return draft
