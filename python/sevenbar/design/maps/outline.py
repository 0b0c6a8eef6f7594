"""From the chords of a mesh to the boundaries of a map, polylines, and its regions, polygons with holes."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.maps.mesh import Mesh, Node

Place = tuple[float, float]

Name = TypeVar("Name", bound=Hashable)


@dataclass(frozen=True, eq=False)
class Boundary:
    """A line between two kinds, on its left and on its right: `places` (n, 2) [shares of the ranges]."""

    left: int
    right: int
    places: Floats


@dataclass(frozen=True, eq=False)
class Region:
    """A connected part of a map of one kind: its outline, anticlockwise, and its holes [shares], (n, 2)."""

    kind: int
    outline: Floats
    holes: tuple[Floats, ...]

    @property
    def area(self) -> float:
        """Its share of the map."""
        return signed_area(self.outline) + sum(signed_area(hole) for hole in self.holes)

    def without(self, speck: float) -> Region:
        """The region without holes that are not wider than a speck [share]."""
        kept = tuple(hole for hole in self.holes if np.ptp(hole, axis=0).max() > speck)
        return Region(self.kind, self.outline, kept)


def signed_area(loop: Floats) -> float:
    """The area within a closed loop (n, 2), negative where it runs clockwise."""
    x, y = loop.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def boundaries(mesh: Mesh) -> tuple[Boundary, ...]:
    """The chords joined to lines, each between two kinds; they end where kinds meet, or at the border."""
    pairs: dict[tuple[int, int], list[tuple[Node, Node]]] = defaultdict(list)
    for chord in mesh.chords:
        if chord.left < chord.right:
            pairs[chord.left, chord.right].append((chord.start, chord.end))
        else:
            pairs[chord.right, chord.left].append((chord.end, chord.start))
    found = []
    for (left, right), pieces in sorted(pairs.items()):
        for line in joined(pieces):
            found.append(Boundary(left, right, np.array([mesh.places[node] for node in line])))
    return tuple(found)


def joined(pieces: Iterable[tuple[Name, Name]]) -> list[list[Name]]:
    """Directed pieces joined end to start, as far as only one follows another."""
    after: dict[Name, list[Name]] = defaultdict(list)
    before: dict[Name, int] = defaultdict(int)
    for start, end in pieces:
        after[start].append(end)
        before[end] += 1
    through = {node for node in after if len(after[node]) == 1 and before[node] == 1}
    lines = []
    for start in [node for node in after if node not in through]:
        for end in after[start]:
            line = [start, end]
            while line[-1] in through:
                line.append(after[line[-1]].pop())
                through.discard(line[-2])
            lines.append(line)
    while through:
        line = [through.pop()]
        while after[line[-1]]:
            line.append(after[line[-1]].pop())
            through.discard(line[-1])
        lines.append(line)
    return lines


def regions(mesh: Mesh) -> tuple[Region, ...]:
    """The parts of the window by kind, the largest first."""
    pieces: dict[int, list[tuple[Node, Node]]] = defaultdict(list)
    places: dict[Node, Place] = dict(mesh.places)
    for chord in mesh.chords:
        pieces[chord.left].append((chord.start, chord.end))
        pieces[chord.right].append((chord.end, chord.start))
    for kind, start, end in _border(mesh, places):
        pieces[kind].append((start, end))
    found = []
    for kind, own in sorted(pieces.items()):
        loops = [np.array([places[node] for node in loop]) for loop in _loops(own, places)]
        loops = [loop for loop in loops if len(loop) > 2]
        outer = [loop for loop in loops if signed_area(loop) > 0]
        holes = [loop for loop in loops if signed_area(loop) < 0]
        owner = [_around(hole, outer) for hole in holes]
        for i, outline in enumerate(outer):
            mine = tuple(hole for hole, o in zip(holes, owner, strict=True) if o == i)
            found.append(Region(kind, outline, mine))
    return tuple(sorted(found, key=lambda region: -region.area))


def _border(mesh: Mesh, places: dict[Node, Place]) -> list[tuple[int, Node, Node]]:
    """The window's own edge, anticlockwise, in pieces of one kind."""
    size = mesh.scheme.size
    cuts = [node for node in mesh.places if len(node) == 2]
    ring = [(0, 0), (size, 0), (size, size), (0, size)]
    found: list[tuple[int, Node, Node]] = []
    for index, start in enumerate(ring):
        end = ring[(index + 1) % 4]
        axis = 0 if start[1] == end[1] else 1
        sign = 1 if end[axis] > start[axis] else -1
        own = [n for n in cuts if n[0][1 - axis] == n[1][1 - axis] == start[1 - axis]]
        own.sort(key=lambda node: sign * mesh.places[node][axis])
        here: Node = (start,) * 3
        places[here] = (start[0] / size, start[1] / size)
        kind = mesh.corners[start]
        for node in own:
            found.append((kind, here, node))
            here, kind = node, mesh.corners[node[1] if sign > 0 else node[0]]
        found.append((kind, here, (end,) * 3))
    return found


def _loops(pieces: Sequence[tuple[Node, Node]], places: Mapping[Node, Place]) -> list[list[Node]]:
    """Closed loops of directed pieces that keep one kind on the left."""
    after: dict[Node, list[Node]] = defaultdict(list)
    for start, end in pieces:
        after[start].append(end)
    loops = []
    for first in list(after):
        while after[first]:
            loop, here = [first], after[first].pop()
            while here != first:
                before, ways = loop[-1], after[here]
                loop.append(here)
                turn = [_turn(places[before], places[here], places[way]) for way in ways]
                here = ways.pop(turn.index(max(turn)))
            loops.append(loop)
    return loops


def _turn(before: Place, here: Place, after: Place) -> float:
    """The turn to the left from one piece to the next, in (-pi, pi]: the sharpest keeps to one region."""
    came = math.atan2(here[1] - before[1], here[0] - before[0])
    goes = math.atan2(after[1] - here[1], after[0] - here[0])
    turn = (goes - came) % math.tau
    return turn - math.tau if turn > math.pi else turn


def _around(hole: Floats, outer: Sequence[Floats]) -> int:
    """The place of the smallest outline round a hole."""
    # a hole may touch its outline in a corner, so one of its corners is no witness
    inside = [i for i, loop in enumerate(outer) if within([loop], hole).mean() > 0.5]
    return min(inside, key=lambda i: signed_area(outer[i]), default=-1)


def within(loops: Iterable[Floats], points: Floats) -> np.ndarray:
    """Whether points (n, 2) lie within an odd number of closed loops."""
    order = np.argsort(points[:, 1], kind="stable")
    x, y = points[order].T
    crossings = np.zeros(len(points), dtype=np.int64)
    for loop in loops:
        start, end = loop, np.roll(loop, -1, axis=0)
        low, high = np.minimum(start[:, 1], end[:, 1]), np.maximum(start[:, 1], end[:, 1])
        first, last = np.searchsorted(y, low, side="left"), np.searchsorted(y, high, side="left")
        edge = np.repeat(np.arange(len(loop)), last - first)
        # the points from `first` to `last` of every edge, one after the other
        point = np.arange(len(edge)) - np.repeat(np.cumsum(last - first) - last, last - first)
        rise = (y[point] - start[edge, 1]) / (end[edge, 1] - start[edge, 1])
        right = start[edge, 0] + rise * (end[edge, 0] - start[edge, 0]) > x[point]
        crossings += np.bincount(point[right], minlength=len(points))
    inside = np.empty(len(points), dtype=bool)
    inside[order] = crossings % 2 == 1
    return inside
