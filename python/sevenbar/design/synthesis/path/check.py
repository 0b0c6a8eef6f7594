"""A path design as the ordinary analysis finds it: its written file is opened and its motion asked again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import Candidate, Claim, Refusal, checked
from sevenbar.design.synthesis.path.refine import Refined
from sevenbar.design.synthesis.path.search import SAMPLES
from sevenbar.design.synthesis.path.task import PathTask
from sevenbar.design.task.match import STILL, Placing, placed
from sevenbar.design.task.standing import moved, standing
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.kinematics.law import Law
from sevenbar.kinematics.linkage import Linkage

#: How much further off than the solution, relative to its error and to the path's extent, the points may be
#: on one pass: more, and the solution lies on several.
TORN = 1e-6


@dataclass(frozen=True, eq=False)
class Made:
    """What a linkage makes of the wanted points at given inputs, on one pass: a branch of a circuit.

    `places` (n, 3) as placed, `poses` (n, columns), `left` (n, 3) from each place to its point.
    """

    circuit: int
    branch: int
    places: Floats
    poses: Floats
    placing: Placing
    left: Floats

    @property
    def rms(self) -> float:
        """The root mean square of the distances."""
        return float(np.sqrt((self.left**2).sum(axis=1).mean()))


def made(linkage: Linkage, name: str, inputs: Floats, wanted: Floats, *, place: bool) -> list[Made]:
    """What each pass of the ordinary analysis makes of the wanted points (n, 3) at inputs (n,), best first.

    Passes that do not reach all of the inputs are left out.
    """
    count = len(inputs)
    law = Law.of(np.arange(count, dtype=np.float64), inputs, 1.0, 0.0)
    point = next(p for p in linkage.points if p.name == name)
    found: list[Made] = []
    for circuit in linkage.motion(law=law).circuits:
        trace = circuit.point(point.link, point.at).position
        # a circuit that rocks has the inputs once for each of its passes
        for begin in range(0, len(trace), count):
            places, poses = trace[begin : begin + count], circuit.q[begin : begin + count]
            if not (np.isfinite(places).all() and np.isfinite(poses).all()):
                continue
            placing = placed(wanted, places) if place else STILL
            put = placing.put(places)
            found.append(Made(circuit.index, begin // count, put, poses, placing, wanted - put))
    return sorted(found, key=lambda one: one.rms)


def _torn(found: list[Made], wanted: Floats, solution: Refined) -> Refusal | None:
    """Why no pass holds all the points that were solved for, each of which some pass comes near."""
    best = found[0]
    if best.rms <= solution.rms * (1 + TORN) + TORN * float(np.ptp(wanted)):
        return None
    off = [np.linalg.norm(best.placing.put(one.placing.back(one.places)) - wanted, axis=1) for one in found]
    nearest = np.argmin(off, axis=0)
    first = found[nearest[0]]
    for k, place in enumerate(nearest):
        other = found[place]
        if other.circuit != first.circuit:
            return Refusal(
                "circuit",
                f"point 1 lies on circuit {first.circuit}, point {k + 1} on circuit {other.circuit}: it must "
                "be taken apart between them",
            )
        if other.branch != first.branch:
            return Refusal(
                "dead centre",
                f"point 1 lies on branch {first.branch}, point {k + 1} on branch {other.branch} of circuit "
                f"{first.circuit}: a dead centre of the input lies between",
            )
    return Refusal("circuit", "no pass goes through the poses that were solved for")


def checked_path(task: PathTask, solution: Refined) -> Candidate | Refusal:
    """The design with its error recomputed from what is written, or why it does not make the path.

    All points on one pass of one circuit, in their order; a closed path needs an input that turns fully.
    """
    draft = task.drawn(solution.varied)
    try:
        linkage = Draft.of(draft.toml(), "design", agree=draft.agree).linkage
        found = made(linkage, task.point.name, solution.inputs, task.wanted, place=task.place)
    except (DescriptionError, RequestError) as error:
        return Refusal("assembly", str(error))
    if not found:
        return Refusal(
            "dead centre", "no pass reaches the inputs of all points without a dead centre between"
        )
    torn = _torn(found, task.wanted, solution)
    if torn is not None:
        return torn
    best = found[0]
    figures = standing(best.placing, linkage.length_unit) if task.place else {}
    if task.place and task.draft.linkage.form == "drawn":
        draft, figures = moved(draft, best.placing), {}
    outputs = best.poses[:, linkage.columns.index(linkage.drive.output)]
    errors = np.linalg.norm(best.left, axis=1)
    claim = Claim(solution.inputs, outputs, errors, linkage.length_unit, figures)
    candidate = checked(draft, claim, task.limits, poses=best.poses)
    if isinstance(candidate, Candidate) and task.closed:
        circuit = draft.linkage.motion(SAMPLES).circuits[candidate.circuit]
        if not circuit.goes_round:
            return Refusal(
                "dead centre",
                "the path is closed, and a dead centre lies between its last point and its first",
            )
    return candidate
