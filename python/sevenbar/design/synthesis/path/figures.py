"""A figure of a path design: wanted points and the path in space and from three sides, and the errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from sevenbar.arrays import Floats
from sevenbar.design.candidates import CHECK_SAMPLES, Candidate
from sevenbar.design.synthesis.path.check import made
from sevenbar.design.synthesis.path.task import PathTask
from sevenbar.design.task.path_page import PathPage, path_page
from sevenbar.drawing.names import short
from sevenbar.text.words import say


@dataclass(frozen=True, eq=False)
class Drawn:
    """The path of a design as placed.

    `whole` (m, 3) is all of its circuit, `used` (k, 3) the part along the wanted points, `places` (n, 3)
    the point is at each of them.
    """

    whole: Floats
    used: Floats
    places: Floats


def drawn(task: PathTask, candidate: Candidate) -> Drawn:
    """The path of a design of a task, in the coordinates of the wanted points."""
    linkage = candidate.draft.linkage
    own = task.place and "joint" not in task.draft.raw
    # its inputs were reached when it was checked
    found = made(linkage, task.point.name, candidate.claim.inputs, task.wanted, place=own)[0]
    circuit = linkage.motion(CHECK_SAMPLES).circuits[candidate.circuit]
    point = next(p for p in linkage.points if p.name == task.point.name)
    rows = found.placing.put(circuit.point(point.link, point.at).position)
    if circuit.closed:
        rows = np.concatenate([rows, rows[:1]])
    if task.closed:
        return Drawn(rows, rows, found.places)
    position = candidate.position
    steps = np.diff(position)
    rising = (steps > 0).sum() >= (steps < 0).sum()
    first, last = (position[0], position[-1]) if rising else (position[-1], position[0])
    count = len(circuit.input)
    last += count if last < first else 0
    inner = np.arange(int(np.ceil(first)), int(np.floor(last)) + 1) % count
    ends = found.places[[0, -1]] if rising else found.places[[-1, 0]]
    return Drawn(
        rows,
        np.concatenate([ends[:1], rows[:-1][inner] if circuit.closed else rows[inner], ends[1:]]),
        found.places,
    )


def path_figure(task: PathTask, candidate: Candidate) -> Figure:
    """Wanted points and path in space (a) and from three sides (b to d), the error at each point (e)."""
    path = drawn(task, candidate)
    near = _near(path.whole, np.concatenate([task.wanted, path.used]))
    title = say(
        "{linkage}: {motion_type}, circuit {number}",
        linkage=short(candidate.name, 70),
        motion_type=say(candidate.motion_type),
        number=candidate.circuit,
    )
    page = PathPage(task.wanted, path.used, candidate.claim.errors, title, whole=near)
    return path_page(task.draft.linkage, page)


def _near(whole: Floats, seen: Floats) -> Floats:
    """A circuit's rows without those far beyond what is checked, which would make the rest small."""
    middle, half = (seen.max(axis=0) + seen.min(axis=0)) / 2, float(np.ptp(seen, axis=0).max())
    rows = whole.copy()
    rows[(np.abs(whole - middle) > half).any(axis=1)] = np.nan
    return rows
