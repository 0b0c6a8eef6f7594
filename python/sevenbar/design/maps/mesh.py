"""Where kinds change: a mesh of squares, each so small that it holds no boundary or a nearly straight one.

Squares stand on a lattice of whole numbers, so that neighbours of different size share their corners. A
square is set aside where no boundary can be in it; of the others the edges whose ends differ are halved down
to the boundary's exact place, and the places are joined by chords.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sevenbar.design.maps.plane import Plane

#: A corner of squares, or an end of an edge: whole numbers of the lattice.
Corner = tuple[int, int]

#: The piece of a side between two neighbouring corners, the lesser one first.
Edge = tuple[Corner, Corner]

#: Where a chord ends: on an edge, or in the middle of a square, marked by one corner twice as large.
Node = tuple[Corner, ...]

#: More squares of one width in which boundaries are not distinct are not halved; their width is reported.
MOST_HIDING = 10_000

#: More squares than this are not kept, whatever their boundaries look like.
MOST_SQUARES = 200_000


@dataclass(frozen=True)
class Scheme:
    """How finely a map is checked.

    `cells` squares along each range to begin with; those with a boundary are halved `regular` times, those in
    which boundaries meet or cannot be distinguished `finest` times. A chord is within `tolerance` [share of
    the ranges] of the boundary.
    """

    cells: int
    regular: int
    finest: int
    tolerance: float

    @property
    def size(self) -> int:
        """Whole numbers along each range."""
        return self.cells << self.finest


@dataclass(frozen=True)
class Chord:
    """A piece of a boundary, from node to node, and the kinds on both hands."""

    start: Node
    end: Node
    left: int
    right: int


@dataclass(frozen=True, eq=False)
class Mesh:
    """The chords of all boundaries, and the places of their ends [shares of the ranges].

    `corners` has the kind of each corner looked at; `border` the edges of the window that a boundary crosses;
    `open` is the area of squares in which something may be hidden, `widest` the width of the widest of them.
    """

    scheme: Scheme
    chords: tuple[Chord, ...]
    places: dict[Node, tuple[float, float]]
    corners: dict[Corner, int]
    open: float
    widest: float


def meshed(plane: Plane, scheme: Scheme) -> Mesh:
    """The mesh of a plane."""
    return _Making(plane, scheme).made()


#: A square: its lower left corner and its width.
Square = tuple[int, int, int]


class _Making:
    def __init__(self, plane: Plane, scheme: Scheme) -> None:
        self.plane, self.scheme = plane, scheme
        self.kinds: dict[Corner, int] = {}
        #: Of each edge cut: where, and whether a third kind stands between its ends.
        self.cuts: dict[Node, tuple[tuple[float, float], bool]] = {}
        #: Squares of the least width in which boundaries are not distinct.
        self.hiding: set[Square] = set()
        #: Squares that were set aside.
        self.quiet: set[Square] = set()

    def made(self) -> Mesh:
        scheme = self.scheme
        width = 1 << scheme.finest
        squares = [(x * width, y * width, width) for x in range(scheme.cells) for y in range(scheme.cells)]
        self._know(corner for square in squares for corner in _corners(square))
        doubtful = set(self._refined(squares))
        chords: dict[Square, list[Chord]] = {}
        stale = doubtful
        while stale:
            bent: list[Square] = []
            while stale:
                known = len(self.cuts)
                bent += self._joined(stale, chords)
                # where rounding cuts a side that nothing should cut, both squares beside it must know
                ends = [corner for edge in list(self.cuts)[known:] for corner in edge]
                stale = _touching(ends, self.quiet)
                self.quiet -= stale
                doubtful |= stale
            split = [square for square in bent if square[2] > 1]
            if len(doubtful) + 4 * len(split) > MOST_SQUARES:
                self.hiding.update(split)
                break
            doubtful.difference_update(split)
            for square in split:
                del chords[square]
            known = len(self.kinds)
            # their neighbours may be cut already, so that none of them can be set aside
            children = self._split(split)
            doubtful.update(children)
            new = list(self.kinds)[known:]
            stale = set(children) | _touching(new, doubtful)
        return self._mesh([chord for own in chords.values() for chord in own], doubtful)

    def _mesh(self, chords: list[Chord], doubtful: set[Square]) -> Mesh:
        size = self.scheme.size
        places: dict[Node, tuple[float, float]] = {}
        for chord in chords:
            for node in (chord.start, chord.end):
                cut = self.cuts.get(node)
                places[node] = _middle(node[0], size) if cut is None else cut[0]
        hiding = [square for square in doubtful if square in self.hiding]
        if self.plane.gaps(np.empty((0, 2)), np.empty(0)) is None:
            widest, area = 1.0 / self.scheme.cells, 1.0
        else:
            widest = max((width for _, _, width in hiding), default=1) / size
            area = sum(width * width for _, _, width in hiding) / size**2
        return Mesh(self.scheme, tuple(chords), places, self.kinds, area, widest)

    def _know(self, corners: Iterable[Corner]) -> None:
        """Asks for the kinds of corners not known yet."""
        new = list(dict.fromkeys(corner for corner in corners if corner not in self.kinds))
        if new:
            result = self.plane.kinds_at(np.array(new) / self.scheme.size)
            self.kinds.update(zip(new, result.tolist(), strict=True))

    def _split(self, squares: Iterable[Square]) -> list[Square]:
        halves = [(x, y, width // 2) for x, y, width in squares]
        children = [(x + i, y + j, half) for x, y, half in halves for j in (0, half) for i in (0, half)]
        # even those that nothing is in: sides are known to be halved by the corner in their middle
        self._know(corner for child in children for corner in _corners(child))
        return children

    def _refined(self, squares: list[Square]) -> list[Square]:
        """Of squares and their parts those with a boundary, or that may have one."""
        scheme, plane = self.scheme, self.plane
        selected: list[Square] = []
        while squares:
            array = np.array(squares, dtype=np.float64)
            width = array[:, 2] / scheme.size
            gaps = plane.gaps(array[:, :2] / scheme.size + 0.5 * width[:, None], width)
            if gaps is None:
                return selected + squares
            near = np.sort(np.where(np.abs(gaps) <= plane.reach(width)[:, None], gaps, np.nan), axis=1)
            # boundaries nearer to each other than the tolerance are not distinct
            same = plane.reach(np.array([scheme.tolerance]))
            parts = np.isfinite(near[:, 0]).astype(int) + (np.diff(near, axis=1) > same).sum(axis=1)
            wide = array[:, 2] > 1 << (scheme.finest - scheme.regular)
            split = (parts > 0) & wide
            hiding = (parts > 1) & ~wide
            if hiding.sum() <= MOST_HIDING:
                split |= hiding & (array[:, 2] > 1)
            selected += [squares[i] for i in np.flatnonzero((parts > 0) & ~split)]
            self.hiding.update(squares[i] for i in np.flatnonzero(hiding & ~split))
            self.quiet.update(squares[i] for i in np.flatnonzero(parts == 0))
            squares = self._split(squares[i] for i in np.flatnonzero(split))
        return selected

    def _joined(self, squares: Iterable[Square], chords: dict[Square, list[Chord]]) -> list[Square]:
        """Finds the chords of squares; returns the squares whose chords do not tell what is in them."""
        rings: list[tuple[Square, list[Edge]]] = []
        for square in squares:
            chords[square] = []
            cut = [edge for edge in self._sides(square) if self.kinds[edge[0]] != self.kinds[edge[1]]]
            if cut:
                rings.append((square, cut))
        self._cut({_sorted(e) for _, cut in rings for e in cut if _sorted(e) not in self.cuts})
        bent: list[Square] = []
        simple: list[tuple[Square, Chord]] = []
        for square, cut in rings:
            chords[square] = own = self._chords(square, cut)
            if len(cut) == 2 and not any(self.cuts[_sorted(edge)][1] for edge in cut):
                simple.append((square, own[0]))
            else:
                bent.append(square)
        return bent + self._off(simple)

    def _sides(self, square: Square) -> list[Edge]:
        """The edges round a square, anticlockwise."""
        lower_left, *others = _corners(square)
        ring = (lower_left, *others, lower_left)
        return [piece for start, end in pairwise(ring) for piece in self._pieces(start, end)]

    def _pieces(self, start: Corner, end: Corner) -> list[Edge]:
        """The pieces of a side between the corners on it."""
        middle = ((start[0] + end[0]) // 2, (start[1] + end[1]) // 2)
        if abs(end[0] - start[0]) + abs(end[1] - start[1]) > 1 and middle in self.kinds:
            return self._pieces(start, middle) + self._pieces(middle, end)
        return [(start, end)]

    def _cut(self, edges: Iterable[Edge]) -> None:
        """Finds where edges are cut, by halving."""
        cut = list(edges)
        if not cut:
            return
        ends = np.array(cut, dtype=np.float64) / self.scheme.size
        first = np.array([self.kinds[a] for a, _ in cut])
        second = np.array([self.kinds[b] for _, b in cut])
        low, high = np.zeros(len(cut)), np.ones(len(cut))
        seen = second.copy()
        length = np.abs(ends[:, 1] - ends[:, 0]).max()
        for _ in range(max(0, int(np.ceil(np.log2(length / self.plane.exact))))):
            middle = 0.5 * (low + high)
            result = self.plane.kinds_at(ends[:, 0] + middle[:, None] * (ends[:, 1] - ends[:, 0]))
            before = result == first
            low, high = np.where(before, middle, low), np.where(before, high, middle)
            seen = np.where(before, seen, result)
        place = ends[:, 0] + 0.5 * (low + high)[:, None] * (ends[:, 1] - ends[:, 0])
        for edge, (x, y), third in zip(cut, place.tolist(), (seen != second).tolist(), strict=True):
            self.cuts[edge] = ((x, y), third)

    def _chords(self, square: Square, cut: list[Edge]) -> list[Chord]:
        """The chords between the cuts of a square's ring; behind a cut stands the kind of its edge's end."""
        nodes = [_sorted(edge) for edge in cut]
        after = [self.kinds[edge[1]] for edge in cut]
        if len(cut) == 2:
            return [Chord(nodes[1], nodes[0], after[0], after[1])]
        if len(set(after)) == 2:
            (centre,) = self.plane.kinds_at(np.array([_middle(_heart(square), self.scheme.size)])).tolist()
            if centre in after:
                return [
                    Chord(nodes[(i + 1) % len(nodes)], node, kind, centre)
                    for i, (node, kind) in enumerate(zip(nodes, after, strict=True))
                    if kind != centre
                ]
        heart: Node = (_heart(square),)
        return [
            Chord(heart, node, kind, after[i - 1])
            for i, (node, kind) in enumerate(zip(nodes, after, strict=True))
        ]

    def _off(self, chords: list[tuple[Square, Chord]]) -> list[Square]:
        """The squares whose chord is farther from the boundary than the tolerance, in its middle."""
        if not chords:
            return []
        ends = np.array([[self.cuts[c.start][0], self.cuts[c.end][0]] for _, c in chords])
        along = ends[:, 1] - ends[:, 0]
        length = np.hypot(*along.T)
        left = np.column_stack([-along[:, 1], along[:, 0]]) / np.maximum(length, 1e-300)[:, None]
        middle, away = ends.mean(axis=1), self.scheme.tolerance * left
        # a chord of no length is a boundary that only touches the square's corner
        looked = length > self.scheme.tolerance
        right_kind = np.ones(len(chords), dtype=bool)
        for points, want in (
            (middle + away, [c.left for _, c in chords]),
            (middle - away, [c.right for _, c in chords]),
        ):
            inside = looked & ((points >= 0) & (points <= 1)).all(axis=1)
            right_kind[inside] &= self.plane.kinds_at(points[inside]) == np.array(want)[inside]
        return [chords[i][0] for i in np.flatnonzero(~right_kind)]


def _sorted(edge: Edge) -> Edge:
    return edge if edge[0] < edge[1] else (edge[1], edge[0])


def _corners(square: Square) -> tuple[Corner, Corner, Corner, Corner]:
    x, y, width = square
    return (x, y), (x + width, y), (x + width, y + width), (x, y + width)


def _heart(square: Square) -> Corner:
    """The middle of a square, written twice as large."""
    return 2 * square[0] + square[2], 2 * square[1] + square[2]


def _middle(heart: Corner, size: int) -> tuple[float, float]:
    """The place of such a node."""
    return heart[0] / (2 * size), heart[1] / (2 * size)


def _touching(corners: Iterable[Corner], squares: set[Square]) -> set[Square]:
    """Those of the squares with one of these corners on a side."""
    widths = {width for _, _, width in squares}
    result: set[Square] = set()
    for x, y in set(corners):
        for width in widths:
            for left in {x // width, (x - 1) // width}:
                for low in {y // width, (y - 1) // width}:
                    result.add((left * width, low * width, width))
    return result & squares
