"""From the chords of a mesh to the boundaries of a map, polylines, and its regions, polygons with holes."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry.polygon import orient

from sevenbar.arrays import Floats
from sevenbar.design.maps.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Boundary:
    """A line between two kinds, on its left and on its right: `places` (n, 2) [shares of the ranges]."""

    left: int
    right: int
    places: Floats


@dataclass(frozen=True, eq=False)
class Region:
    """A connected part of a map of one kind: a `polygon` [shares of the ranges]."""

    kind: int
    polygon: shapely.Polygon

    @property
    def area(self) -> float:
        """Its share of the map."""
        return float(self.polygon.area)

    @cached_property
    def outline(self) -> Floats:
        """Its outline (n, 2), anticlockwise."""
        return _loop(self.polygon.exterior)

    @cached_property
    def holes(self) -> tuple[Floats, ...]:
        """Its holes, each (n, 2), clockwise."""
        return tuple(_loop(hole) for hole in self.polygon.interiors)

    def holds(self, places: Floats) -> np.ndarray:
        """Whether places (n, 2) are in it, or on its outline (n,)."""
        shapely.prepare(self.polygon)
        return np.asarray(shapely.intersects_xy(self.polygon, *places.T))

    def without(self, speck: float) -> Region:
        """The region without holes that are not wider than a speck [share]."""
        selected = [hole for hole in self.polygon.interiors if np.ptp(_loop(hole), axis=0).max() > speck]
        return Region(self.kind, shapely.Polygon(self.polygon.exterior, selected))


def _loop(ring: shapely.LinearRing) -> Floats:
    return np.asarray(shapely.get_coordinates(ring)[:-1])


def boundaries(mesh: Mesh) -> tuple[Boundary, ...]:
    """The chords joined to lines, each between two kinds; they end where kinds meet, or at the border."""
    pairs: dict[tuple[int, int], list[Floats]] = defaultdict(list)
    for chord in mesh.chords:
        ends = np.array([mesh.places[chord.start], mesh.places[chord.end]])
        if chord.left < chord.right:
            pairs[chord.left, chord.right].append(ends)
        else:
            pairs[chord.right, chord.left].append(ends[::-1])
    return tuple(Boundary(*pair, line) for pair, own in sorted(pairs.items()) for line in joined(own))


def joined(pieces: Iterable[Floats]) -> list[Floats]:
    """Directed pieces (2, 2) joined end to start, as far as only one follows another: lines (n, 2)."""
    lines = shapely.multilinestrings(shapely.linestrings(np.array(list(pieces))))
    parts = shapely.get_parts(shapely.line_merge(lines, directed=True))
    return [shapely.get_coordinates(line) for line in parts]


def regions(mesh: Mesh) -> tuple[Region, ...]:
    """The parts of the window by kind, the largest first."""
    left_of: dict[tuple[tuple[float, float], ...], int] = {}
    for chord in mesh.chords:
        start, end = mesh.places[chord.start], mesh.places[chord.end]
        left_of[start, end], left_of[end, start] = chord.left, chord.right
    ends = np.array([(mesh.places[chord.start], mesh.places[chord.end]) for chord in mesh.chords])
    chords = shapely.linestrings(ends.reshape(-1, 2, 2))
    lines = shapely.union_all([shapely.box(0, 0, 1, 1).exterior, *chords])
    result = []
    for face in map(orient, shapely.get_parts(shapely.polygonize(shapely.get_parts(lines)))):
        rings = [shapely.get_coordinates(ring).tolist() for ring in (face.exterior, *face.interiors)]
        sides = [(tuple(a), tuple(b)) for ring in rings for a, b in pairwise(ring)]
        # the face is on the left of its rings; the border and pieces of chords that cross have no kind
        kinds = Counter(left_of[side] for side in sides if side in left_of)
        # without a boundary all the window is one
        kind = kinds.most_common(1)[0][0] if kinds else mesh.corners[0, 0]
        result.append(Region(kind, face))
    return tuple(sorted(result, key=lambda region: -region.area))
