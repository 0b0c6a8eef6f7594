"""A measure over a map: its values on the grid and along boundaries, and contour lines that cross none."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.design.maps.atlas import LOOP, Map
from sevenbar.design.maps.contours import EXACT, EXACT_FORCES, Contour, Net, traced
from sevenbar.design.maps.outline import Region
from sevenbar.design.maps.plane import Take
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.measures import MEASURES, Measure, is_of_forces, measures_named
from sevenbar.text.printing import Printed

#: About how many contour lines are drawn where none are asked for.
LEVELS = 9

#: Where some values grow without bound, levels are taken between these percentiles.
CUT = (2.0, 96.0)

#: Boundaries are sampled so many times in a cell of the grid, and so many times more in narrow places.
ALONG, DENSER = 2, 8

#: How far inside their region samples of a boundary are taken [share], at least 2 tolerances: nothing to be
#: seen on a sheet, and room for the boundary to bend between two samples of this distance [share].
INSIDE, BEND = 3e-5, 7.5e-3

#: Lines of a grid below which samples are wider apart, since each takes its time, and taken so much farther
#: inside as boundaries bend between them, by the square, up to so far [share]: hardly to be seen.
DENSE, MOST_INSIDE = 61, 1e-3

#: Places of a measure's contours, as a part of those at which it is taken before: a rough count; and how many
#: times as long each takes, since steep measures crowd them at boundaries, where motions are sharp.
IN_CONTOURS, DEARER = 0.4, 3.0

#: About how many places are timed before it is stated how long a map takes.
TIMED = 24

#: Rounds in which narrow places are given more samples.
ROUNDS = 3

#: A triangle lies in its region when points this far from its sides [share of the way to its middle] do.
SHRUNK = 0.02


@dataclass(frozen=True, eq=False, repr=False)
class Heights(Printed):
    """A measure over a map.

    `take` is the circuit that counts; `unit` is that of the values, "" without one. `nodes` (n, 2) [shares]
    are the places where it was taken and `values` (n,) what was found, NaN where there is none; `here` is
    the design's.
    """

    measure: Measure
    take: Take
    unit: str
    levels: tuple[float, ...]
    contours: tuple[Contour, ...]
    nodes: Floats
    values: Floats
    here: float | None


def measure_heights(
    of: Map,
    measures: Iterable[str | Measure | Callable[[Motion], float]],
    *,
    take: Take = "highest",
    levels: Sequence[float] | None = None,
    ahead: Callable[[int, float], object] = lambda count, seconds: None,  # noqa: ARG005
) -> tuple[Heights, ...]:
    """Measures over a map, each with contour lines at `levels`, round ones by default.

    Of measures of circuits the "highest" or the "lowest" value of all circuits is taken, or that of the
    circuit of an index. `ahead` is called before the work with about how many linkages are measured and how
    long that takes [s]. Raises `RequestError` for measures that are words or counts, and for levels that are
    no numbers.

        >>> import sevenbar as sb
        >>> from sevenbar.design.maps import motion_map
        >>> drawn = motion_map(sb.load("rssr"), {"L1": (100, 400), "L3": (300, 800)})
        >>> (swing,) = measure_heights(drawn, ["swing"])
        >>> swing.levels
        (50.0, 100.0, 150.0, 200.0, 250.0)
    """
    chosen = with_contours(measures)
    check_take(take)
    if isinstance(take, (int, np.integer)):
        refuse_missing_circuit(of, int(take))
    wanted = None if levels is None else levels_of(levels)
    net = _net(of)
    place = of.shares_of(np.array([[of.design.x, of.design.y]]))
    (own,) = of.plane.values_at(place, chosen, take)
    nodes, in_contours = len(net.nodes), round(IN_CONTOURS * len(chosen) * len(net.nodes))
    of.plane.expect(nodes + in_contours)
    # some places all over the map show how long all of them take
    first = np.arange(nodes) % max(nodes // TIMED, 1) == 0
    table = np.empty((nodes, len(chosen)))
    begin = perf_counter()
    table[first] = of.plane.values_at(net.nodes[first], chosen, take)
    each = (perf_counter() - begin) / max(first.sum(), 1)
    ahead(nodes + in_contours, (nodes + DEARER * in_contours) * each)
    table[~first] = of.plane.values_at(net.nodes[~first], chosen, take)
    linkage = of.linkage
    output = linkage.columns[linkage.other_column(linkage.columns.index(of.input))]
    result = []
    for measure, values, here in zip(chosen, table.T, own.tolist(), strict=True):
        steps = wanted if wanted is not None else _round_levels(values)
        exact = EXACT_FORCES if is_of_forces(measure.name) else EXACT
        lines = traced(net, values, steps, partial(_read, of, measure, take), exact)
        contours = tuple(part for line in lines for part in _inside(of, line))
        unit, design = measure.unit(linkage, output), None if math.isnan(here) else here
        result.append(Heights(measure, take, unit, tuple(steps), contours, net.nodes, values, design))
    return tuple(result)


def usual_lines(measures: Iterable[Measure]) -> int | None:
    """Lines of a map's grid, where its measures say so: forces take their time at every linkage."""
    return LOOP.lines if any(is_of_forces(measure.name) for measure in measures) else None


def _read(of: Map, measure: Measure, take: Take, places: Floats) -> Floats:
    """A measure at places (n, 2) [shares], (n,)."""
    return of.plane.values_at(places, [measure], take)[:, 0]


def with_contours(measures: Iterable[str | Measure | Callable[[Motion], float]]) -> tuple[Measure, ...]:
    """The measures of names or functions; raises `RequestError` for those that are words or counts."""
    chosen = measures_named(measures)
    for measure in chosen:
        if measure.quantity in ("word", "count"):
            numbers = [m.name for m in MEASURES.values() if m.quantity not in ("word", "count")]
            raise RequestError(
                f"measure: {measure.name} is a {measure.quantity}, which has no contours; "
                f"give some of {', '.join(numbers)}"
            )
    return chosen


def check_take(take: object, key: str = "take") -> None:
    """Raises `RequestError` for what chooses no circuit."""
    counts = isinstance(take, (int, np.integer)) and not isinstance(take, bool) and take >= 0
    if take not in ("highest", "lowest") and not counts:
        raise RequestError(
            f"{key}: {shown(take)} is not offered; give highest, lowest, or the index of a circuit, from 0"
        )


def refuse_missing_circuit(of: Map, take: int) -> None:
    """Raises `RequestError` for a circuit that no linkage on the map has."""
    most = max((kind.circuits for kind in (*of.areas, of.design.kind)), default=0)
    if take >= most:
        has = "none has a circuit" if not most else f"they have at most {most}, 0 to {most - 1}"
        raise RequestError(
            f"take: {take} is a circuit that no linkage on the map has: {has}; give one of these, "
            "highest or lowest"
        )


def levels_of(levels: Sequence[float] | str, key: str = "levels") -> list[float]:
    """Finite numbers, rising, of some or of a word as '20,40,60'; raises `RequestError` for what are none."""
    given = [part for part in levels.split(",") if part.strip()] if isinstance(levels, str) else levels
    try:
        values = sorted({float(level) for level in given})
    except (TypeError, ValueError):
        values = []
    if not values or not all(map(math.isfinite, values)):
        raise RequestError(f"{key}: {shown(levels)} are not finite numbers; give some, as in 20,40,60")
    return values


def _round_levels(values: Floats) -> list[float]:
    from matplotlib.ticker import MaxNLocator

    finite = values[np.isfinite(values)]
    if not finite.size:
        return []
    low, high = np.percentile(finite, CUT)
    ticks = MaxNLocator(LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
    return [float(tick) for tick in ticks if finite.min() < tick < finite.max()]


def _net(of: Map) -> Net:
    """Triangles that cross no boundary."""
    lines = len(of.grid)
    step = min(1.0 / (ALONG * (lines - 1)), BEND * _margin(of) / INSIDE)
    ticks = np.linspace(0.0, 1.0, lines)
    x, y = np.meshgrid(ticks, ticks)
    crossings, numbers = np.column_stack([x.ravel(), y.ravel()]), of.grid.ravel()
    nodes, kinds, triangles = [], [], []
    count = 0
    for kind in range(len(of.kinds)):
        regions = [region for region in of.regions if region.kind == kind]
        if not regions or not of.kinds[kind].circuits:
            continue
        own, corners = _triangles(of, kind, regions, crossings[numbers == kind], step)
        nodes.append(own)
        kinds.append(np.full(len(own), kind))
        triangles.append(corners + count)
        count += len(own)
    if not nodes:
        return Net(np.empty((0, 2)), np.empty(0, dtype=np.int64), np.empty((0, 3), dtype=np.int64))
    return Net(np.concatenate(nodes), np.concatenate(kinds), np.concatenate(triangles))


def _triangles(
    of: Map, kind: int, regions: Sequence[Region], inner: Floats, step: float
) -> tuple[Floats, Integers]:
    """Triangles between places of one kind, given ones and others along the boundary, and those places."""
    from matplotlib.tri import Triangulation

    parts = [
        _beside(loop, step / DENSER, _margin(of))
        for region in regions
        for loop in (region.outline, *region.holes)
    ]

    def within(places: Floats) -> np.ndarray:
        return np.asarray(np.any([region.holds(places) for region in regions], axis=0))

    chosen = np.concatenate([np.arange(len(part)) % DENSER == 0 for part in parts])
    samples = np.concatenate(parts)
    right = of.plane.kinds_at(samples) == kind
    samples, chosen = samples[right], chosen[right]
    own, corners = np.empty((0, 2)), np.empty((0, 3), dtype=np.int64)
    for _ in range(ROUNDS):
        own = np.unique(np.concatenate([inner, samples[chosen]]), axis=0)
        if len(own) < 3 or np.linalg.matrix_rank(own - own[0], tol=of.tolerance) < 2:
            return np.empty((0, 2)), np.empty((0, 3), dtype=np.int64)
        corners = Triangulation(*own.T).triangles.astype(np.int64)
        (ax, ay), (bx, by) = ((own[corners[:, i]] - own[corners[:, 0]]).T for i in (1, 2))
        clockwise = ax * by < bx * ay
        corners[clockwise] = corners[clockwise][:, ::-1]
        middle = own[corners].mean(axis=1)
        tests = [within(middle)]
        for a, b in ((0, 1), (1, 2), (2, 0)):
            side = own[corners[:, [a, b]]].mean(axis=1)
            tests.append(within(side + SHRUNK * (middle - side)))
        inside = np.all(tests, axis=0)
        crossing = own[corners[np.any(tests, axis=0) & ~inside]]
        corners = corners[inside]
        low, high = crossing.min(axis=1, initial=1.0), crossing.max(axis=1, initial=0.0)
        new = np.zeros(len(samples), dtype=bool)
        for a, b in zip(low, high, strict=True):
            new |= ((samples >= a) & (samples <= b)).all(axis=1)
        if not (new & ~chosen).any():
            break
        chosen |= new
    return own, corners


def _margin(of: Map) -> float:
    """How far inside their region samples of a boundary are taken [share]."""
    wider = max(1.0, (DENSE - 1) / (len(of.grid) - 1))
    return max(min(INSIDE * wider**2, MOST_INSIDE), 2 * of.tolerance)


def _beside(loop: Floats, step: float, inside: float) -> Floats:
    """Places along a closed loop (n, 2), a little to its left, not farther apart than `step`."""
    start, end = loop, np.roll(loop, -1, axis=0)
    along = end - start
    length = np.hypot(*along.T)
    keep = length > 0
    start, along, length = start[keep], along[keep], length[keep]
    distance = np.concatenate([[0.0], np.cumsum(length)])
    wanted = np.linspace(0.0, distance[-1], max(8, int(np.ceil(distance[-1] / step))), endpoint=False)
    piece = np.clip(np.searchsorted(distance, wanted, side="right") - 1, 0, len(length) - 1)
    part = (wanted - distance[piece]) / length[piece]
    left = np.column_stack([-along[:, 1], along[:, 0]]) / length[:, None]
    return np.asarray(np.clip(start[piece] + part[:, None] * along[piece] + inside * left[piece], 0.0, 1.0))


def _inside(of: Map, line: Contour) -> Iterable[Contour]:
    """The parts of a line that lie in regions of its kind."""
    inside = of.numbers_at(line.places) == line.kind
    starts = np.flatnonzero(inside & ~np.concatenate([[False], inside[:-1]]))
    ends = np.flatnonzero(inside & ~np.concatenate([inside[1:], [False]]))
    for start, end in zip(starts, ends, strict=True):
        if end > start:
            yield replace(line, places=line.places[start : end + 1])
