"""A map: the kinds of linkages over two dimensions, their boundaries and regions, and the design on it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from sevenbar.arrays import Floats, Integers, whole_number
from sevenbar.description.draft import Draft
from sevenbar.description.held import HeldDimensions, held_of
from sevenbar.design.maps.mesh import Scheme, meshed
from sevenbar.design.maps.outline import Boundary, Region, boundaries, regions
from sevenbar.design.maps.plane import Kind, LoopPlane, Plane
from sevenbar.design.maps.rssr_plane import RssrPlane
from sevenbar.design.maps.window import MapAxis, Range, axes_of
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.printing import Printed
from sevenbar.text.progress import Progress
from sevenbar.text.words import say

#: Fewest and most lines of a grid.
GRID_ENDS = (3, 1001)


class Fineness(NamedTuple):
    """A plane, and how finely it is searched.

    `lines` of the grid along each dimension; `fine` squares along a range where boundaries are followed, none
    where points are dear; how near chords keep to boundaries [share of the ranges]; inputs in a turn.
    """

    plane: type[Plane]
    lines: int
    fine: int
    tolerance: float
    samples: int


#: An RSSR: boundaries to a bend of half the window's radius. And loops that take some 10 ms a point. Extremes
#: are refined from the inputs, and forces through so many rows are smooth where they are at all.
RSSR, LOOP = Fineness(RssrPlane, 61, 800, 1e-6, 72), Fineness(LoopPlane, 25, 0, 1e-3, 72)

#: Regions, holes and boundaries not wider than this are not drawn [tolerances]: where a boundary is a double
#: one, as of a symmetric linkage, rounding leaves such specks on it.
SPECK = 10.0

#: How exactly the design's distances are found [share of a range]: below what a drawing shows.
EXACT = 1e-10


@dataclass(frozen=True)
class NearestChange:
    """How far the design is from a change along one dimension: the boundary's `value`, and the kind beyond.

    `value` [the dimension's unit] is `None`, and so is `kind`, where no boundary is met inside the window.
    """

    axis: MapAxis
    way: Literal["down", "up"]
    value: float | None
    kind: Kind | None


@dataclass(frozen=True)
class Design:
    """The design as it is: its two dimensions [their units], its kind, and the nearest changes."""

    x: float
    y: float
    inside: bool
    kind: Kind
    steps: tuple[NearestChange, ...]


@dataclass(frozen=True, eq=False, repr=False)
class Map(Printed):
    """The kinds of linkages over two dimensions of a draft.

    Boundaries and regions hold places (n, 2) in shares of the two ranges; `values` turns such into the
    dimensions' units. `tolerance` [share] is how far lines may be from the true boundary; a region narrower
    than `widest` [share] may be missing, in `open` of the area. `grid` (lines, lines) has the number of the
    kind at each crossing of grid lines, y first.
    """

    draft: Draft
    input: str
    axes: tuple[MapAxis, MapAxis]
    kinds: tuple[Kind, ...]
    grid: Integers
    boundaries: tuple[Boundary, ...]
    regions: tuple[Region, ...]
    design: Design
    tolerance: float
    widest: float
    open: float
    plane: Plane = field(repr=False)

    @property
    def linkage(self) -> Linkage:
        """The design's linkage."""
        return self.draft.linkage

    @property
    def held(self) -> HeldDimensions:
        """What is the same all over the map."""
        return held_of(self.draft, [axis.name for axis in self.axes])

    def values(self, places: Floats) -> Floats:
        """Places (n, 2) given in shares, in the dimensions' units."""
        return np.column_stack([axis.value(p) for axis, p in zip(self.axes, places.T, strict=True)])

    def shares_of(self, values: Floats) -> Floats:
        """Places (n, 2) given in the dimensions' units, in shares."""
        return np.column_stack([axis.share(v) for axis, v in zip(self.axes, values.T, strict=True)])

    @cached_property
    def areas(self) -> dict[Kind, float]:
        """The share of the map's area that each kind has, the greatest first."""
        result: dict[Kind, float] = {}
        for region in self.regions:
            kind = self.kinds[region.kind]
            result[kind] = result.get(kind, 0.0) + region.area
        return dict(sorted(result.items(), key=lambda item: -item[1]))

    def numbers_at(self, places: Floats) -> Integers:
        """The number of the kind at places (n, 2) [shares] by the drawn regions; -1 outside.

        In specks that are not drawn it is that of the linkage itself.
        """
        result = np.full(len(places), -1, dtype=np.int64)
        for region in self.regions:
            result[region.holds(places)] = region.kind
        speck = (result < 0) & ((places >= 0) & (places <= 1)).all(axis=1)
        result[speck] = self.plane.kinds_at(places[speck])
        return result

    def kind_at(self, x: float, y: float) -> Kind | None:
        """The kind at values of the two dimensions [their units] by the drawn regions; `None` outside."""
        number = int(self.numbers_at(self.shares_of(np.array([[x, y]], dtype=np.float64)))[0])
        return self.kinds[number] if number >= 0 else None

    def name(self, kind: Kind) -> str:
        """A kind in words: its circuits are named where kinds on the map differ in them only."""
        alike = {k.circuits for k in self.areas if k.motion_type == kind.motion_type}
        return kind.label if len(alike | {kind.circuits}) > 1 else say(kind.motion_type)


def motion_map(
    of: Linkage | Draft,
    over: Mapping[str, Range],
    *,
    grid: int | None = None,
    input: str | None = None,
    follow: Collection[str] = (),
    progress: Progress | None = None,
) -> Map:
    """The motion types of a linkage over two of its dimensions, the first along x.

    `over` has a range for each: two numbers in the file's unit, or a text as "20cm:40cm". Of an RSSR in the
    paper's dimensions the boundaries do not depend on `grid`, the count of lines along each range; of other
    loops, each point of which is a motion of its own, they are searched between those lines. `input` is the
    joint that drives, the file's by default. A dimension that the file leaves out, L2 of an RSSR, is held at
    its value in the design; `follow=["L2"]` lets it follow from the others.

    Raises `RequestError` for dimensions and ranges that do not fit.

        >>> import sevenbar as sb
        >>> found = motion_map(sb.load("rssr"), {"L1": (100, 400), "L3": (300, 800)})
        >>> found.kind_at(250, 550)
        Kind(motion_type='crank-rocker', circuits=2)
    """
    draft = Draft.of_linkage(of) if isinstance(of, Linkage) else of
    axes = axes_of(draft, over)
    for axis in axes:
        if axis.name in follow:
            raise RequestError(f"follow: {axis.name} is an axis of the map; leave one of the two out")
    draft = draft.holding(follow)
    linkage = draft.linkage
    column = linkage.input_column(input)
    driver = linkage.columns[column]
    places = {axis.dimension.place[0] for axis in axes}
    closed_form = linkage.form == "rssr" and places <= {"rssr", "drive", "point"}
    kind, usual, fine, tolerance, samples = RSSR if closed_form else LOOP
    lines = usual if grid is None else whole_number("grid", grid, *GRID_ENDS, "a count of lines")
    scheme = _scheme(lines, fine, tolerance)
    plane: Plane = kind(draft, axes, driver, samples, progress)
    # what is not covered is reported of the design itself
    motion = linkage.motion(RSSR.samples, input=driver)
    mesh = meshed(plane, scheme)
    ticks = range(0, scheme.size + 1, 1 << scheme.finest)
    speck = SPECK * scheme.tolerance
    lines_between = tuple(line for line in boundaries(mesh) if np.ptp(line.places, axis=0).max() > speck)
    parts = tuple(part.without(speck) for part in regions(mesh) if np.ptp(part.outline, axis=0).max() > speck)
    return Map(
        draft=draft,
        input=driver,
        axes=axes,
        kinds=tuple(plane.kinds),
        grid=np.array([[mesh.corners[x, y] for x in ticks] for y in ticks]),
        boundaries=lines_between,
        regions=parts,
        design=_design(plane, axes, motion, lines_between, scheme.tolerance),
        tolerance=scheme.tolerance,
        widest=mesh.widest,
        open=mesh.open,
        plane=plane,
    )


def _scheme(lines: int, fine: int, tolerance: float) -> Scheme:
    cells = lines - 1
    regular = max(0, int(np.ceil(np.log2(fine / cells)))) if fine > cells else 0
    finest = max(regular, int(np.ceil(np.log2(1.0 / (tolerance * cells)))))
    return Scheme(cells, regular, finest, tolerance)


def _design(
    plane: Plane, axes: tuple[MapAxis, MapAxis], motion: Motion, lines: tuple[Boundary, ...], tolerance: float
) -> Design:
    values = [axis.dimension.value for axis in axes]
    here = np.array([float(axis.share(value)) for axis, value in zip(axes, values, strict=True)])
    inside = bool(((here >= 0) & (here <= 1)).all())
    if motion.motion_type == "change-point":
        kind = Kind("change-point", 0)
    else:
        kind = Kind(motion.motion_type, len(motion.circuits))
    steps: list[NearestChange] = []
    for place, axis in enumerate(axes) if inside else ():
        crossings = _crossings(lines, here, place)
        ways: tuple[tuple[Literal["down", "up"], int], ...] = (("down", -1), ("up", 1))
        for way, sign in ways:
            far = [(sign * (at - here[place]), at, k) for at, *k in crossings]
            ahead = [one for one in far if one[0] > 0]
            if not ahead:
                steps.append(NearestChange(axis, way, None, None))
                continue
            _, at, (low, high) = min(ahead)
            exact = _exact(plane, here, place, at, tolerance)
            beyond = plane.kinds[high if sign > 0 else low]
            steps.append(NearestChange(axis, way, float(axis.value(exact)), beyond))
    return Design(values[0], values[1], inside, kind, tuple(steps))


def _crossings(lines: tuple[Boundary, ...], here: Floats, place: int) -> list[tuple[float, int, int]]:
    """Where the line through a place along one axis meets boundaries, and the kinds before and after."""
    result = []
    for line in lines:
        start, end = line.places[:-1], line.places[1:]
        away = start[:, 1 - place] - here[1 - place], end[:, 1 - place] - here[1 - place]
        for i in np.flatnonzero((away[0] > 0) != (away[1] > 0)):
            part = away[0][i] / (away[0][i] - away[1][i])
            at = start[i, place] + part * (end[i, place] - start[i, place])
            # going up along x a line that runs down has its left hand beyond, and along y the other way
            beyond_left = bool(away[0][i] > 0) == (place == 0)
            kinds = (line.right, line.left) if beyond_left else (line.left, line.right)
            result.append((float(at), *kinds))
    return result


def _exact(plane: Plane, here: Floats, place: int, at: float, tolerance: float) -> float:
    """The boundary near `at` along one axis, by halving; `at` itself where none is met."""
    points = np.array([here, here])
    points[:, place] = at - 2 * tolerance, at + 2 * tolerance
    low, high = points[0, place], points[1, place]
    first, second = plane.numbers_at(points).tolist()
    if first == second:
        return at
    while high - low > EXACT:
        middle = 0.5 * (low + high)
        points[0, place] = middle
        if not low < middle < high:
            break
        if int(plane.numbers_at(points[:1])[0]) == first:
            low = middle
        else:
            high = middle
    return float(0.5 * (low + high))
