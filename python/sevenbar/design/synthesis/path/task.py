"""What is wanted of a path generator: points in order, perhaps with inputs; what of the linkage may vary."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import finite_array, whole_number
from sevenbar.description.draft import Draft
from sevenbar.description.held import HeldDimensions, held_of
from sevenbar.design.idle_link import refuse_idle_link
from sevenbar.design.limits import Limits
from sevenbar.design.task import DesignTask, FreeNumber, PathWant
from sevenbar.design.task.contradictions import OPENINGS, closed_poses
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.task import Placement
from sevenbar.design.task.wanted_path import wanted_inputs, wanted_places
from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Point
from sevenbar.kinematics.numbers.dimensions import Dimension, check_apart

#: Bounds where none are given, relative to the greater of the linkage's longest dimension and the path's
#: extent: of lengths that must be positive, and how far others may go from zero.
SHORTEST, LONGEST = 0.02, 2.0

#: The same for places as drawn, from where they are drawn, and for the numbers of a drawn direction.
DRAWN, TILT = 0.5, 1.0

#: Angles may go half a turn to each side where no bounds are given [rad].
HALF_TURN = math.pi


@dataclass(frozen=True, eq=False)
class PathTask:
    """A wanted path and the linkage that shall make it: a `design` task of one want, the path of a `point`.

    Numbers that may change are in the file's units. With a placement that is not "fixed" the linkage may
    stand anywhere in space, and be larger as a whole where every length may change.
    """

    design: DesignTask
    point: Point

    @property
    def draft(self) -> Draft:
        """The linkage as the start."""
        return self.design.draft

    @property
    def want(self) -> PathWant:
        """The wanted path."""
        (want,) = self.design.wants
        assert isinstance(want, PathWant)
        return want

    @cached_property
    def loop(self) -> TaskLoop:
        """The loop of the linkage, with the point."""
        return TaskLoop(self.draft, self.design.names)

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """The dimensions that may change."""
        return tuple(self.loop.numbers.dimensions[number] for number in self.loop.free)

    @property
    def held(self) -> HeldDimensions:
        """What does not change."""
        return held_of(self.draft, self.design.names)

    @cached_property
    def extent(self) -> float:
        """The greatest extent of the wanted path [length], which errors are parts of."""
        return self.want.residual_unit(self.draft.linkage)


Where = str | tuple[int, Sequence[float]]


def path_task(
    linkage: Linkage | Draft,
    points: npt.ArrayLike,
    point: Where,
    *,
    vary: Sequence[str] | None = None,
    bounds: Mapping[str, tuple[float | str, float | str]] | None = None,
    timing: npt.ArrayLike | None = None,
    phase: bool = False,
    place: bool = False,
    limits: Limits | None = None,
    follow: Collection[str] = (),
) -> PathTask:
    """The task as requested, checked; raises `RequestError` for what does not fit.

    `points` (n, 3) [length]; one that ends where it began is closed. `vary` holds names of dimensions or
    patterns, `bounds` (low, high) by name or pattern, numbers in the file's units or texts as "25 cm"; where
    none are given all that can change without opening the loop varies, within bounds of its own. L2 of an
    RSSR whose file leaves it out is a dimension like the others; in `follow` it follows from them.
    """
    draft = linkage if isinstance(linkage, Draft) else Draft.of_linkage(linkage)
    draft, own = _with_point(draft.giving(vary or ()).holding(follow), point)
    wanted, closed = wanted_places(points)
    inputs = wanted_inputs(timing, wanted, closed)
    if phase and inputs is None:
        raise RequestError("phase: the path has no inputs whose start could be free; give timing, too")
    wanted = wanted[:-1] if closed else wanted
    limits = Limits() if limits is None else limits
    if flaw := limits.flaw(draft.linkage.form):
        raise RequestError(f"transmission: {flaw}")
    refuse_idle_link(draft.linkage, own.link, "a path on it")
    varied = _varied(draft, own, vary)
    every = _dimensions(draft)
    lengths = {d.name for d in every if d.kind in ("length", "pitch")}
    scale_free = lengths - _of_other_points(draft, own) <= {d.name for d in varied}
    anywhere: Placement = "free with scale" if scale_free else "free"
    design = DesignTask(
        draft,
        tuple(_bounded(draft, varied, limits, float(np.ptp(wanted, axis=0).max()), bounds or {})),
        (PathWant(own.name, wanted, closed, inputs, phase),),
        placement=anywhere if place else "fixed",
        limits=limits,
        follow=tuple(d.name for d in every if d.follows),
    )
    task = PathTask(design, own)
    _refuse_unreachable(task)
    return task


def _dimensions(draft: Draft) -> list[Dimension]:
    return [d for d in draft.dimensions if d.kind != "speed"]


def _of_other_points(draft: Draft, point: Point) -> set[str]:
    """The names of the coordinates of other points than that whose path is wanted."""
    return {
        d.name
        for d in _dimensions(draft)
        if d.place[0] == "point" and draft.raw["point"][int(d.place[1])]["name"] != point.name
    }


def _with_point(draft: Draft, point: Where) -> tuple[Draft, Point]:
    """The draft with the point among its named ones, and the point."""
    linkage = draft.linkage
    if isinstance(point, str):
        named = {known.name: known for known in linkage.points}
        if point not in named:
            raise RequestError(
                f"point: no point {shown(point)}; {suggestion(point, named)}this linkage has "
                f"{', '.join(named) or 'none'}; give one, or a link and a place on it"
            )
        if (link := named[point].link) == linkage.graph.ground:
            raise RequestError(
                f"point: '{point}' is on link {link}, the ground, which stands still; give a point "
                f"of link 1 to {link - 1}"
            )
        return draft, named[point]
    try:
        link, at = point
        place = finite_array("at", at)
    except (TypeError, ValueError) as error:
        if isinstance(error, RequestError):
            raise
        raise RequestError(f"point: {shown(point)} is not a place; give a link and three numbers") from None
    ground = linkage.graph.ground
    link = whole_number("point", link, 1, ground - 1, "a moving link", f", link {ground} is the ground")
    if place.size != 3:
        raise RequestError(f"at: {place.size} numbers; give three")
    taken = {known.name for known in linkage.points} | {joint.name for joint in linkage.joints}
    name = next(n for n in ("P", "path_point", *(f"P{i}" for i in range(1, 1000))) if n not in taken)
    made = draft.with_point(name, link, tuple(map(float, place)))
    return made, next(p for p in made.linkage.points if p.name == name)


def _named(pattern: str, dimensions: Sequence[Dimension]) -> list[Dimension]:
    """The dimensions with a name or a key, or with names of a pattern."""
    return [d for d in dimensions if pattern in (d.name, d.key) or fnmatchcase(d.name, pattern)]


def _varied(draft: Draft, point: Point, vary: Sequence[str] | None) -> list[Dimension]:
    """The dimensions that may change."""
    every, others = _dimensions(draft), _of_other_points(draft, point)
    names = [d.name for d in every]
    if vary is None:
        chosen = {d.name for d in every if not d.follows} - others
    else:
        chosen = set()
        for pattern in vary:
            result = _named(pattern, every)
            if not result:
                raise RequestError(
                    f"vary: {shown(pattern)} is not a dimension here; {suggestion(pattern, names)}"
                    f"give some of {', '.join(names)}, or a pattern as 'L*'"
                )
            if follow := [d.name for d in result if d.follows and pattern in (d.name, d.key)]:
                raise RequestError(
                    f"vary: {follow[0]} is to follow from the others; leave one of the two out"
                )
            chosen |= {d.name for d in result if not d.follows}
            if wrong := [d.name for d in result if d.name in others]:
                raise RequestError(
                    f"vary: {wrong[0]} is of another point than '{point.name}', whose path it does not "
                    "change; leave it out"
                )
    if not chosen:
        raise RequestError(f"vary: no dimension may change; give some of {', '.join(names)}")
    varied = [d for d in every if d.name in chosen]
    check_apart("vary", varied)
    motion = draft.linkage.motion(OPENINGS)
    loop = TaskLoop(draft, [d.name for d in varied])
    q = closed_poses(loop, motion.circuits)
    if q is None:
        raise RequestError(
            f"linkage: {motion.motion_type}, the loop moves nowhere as it is described, so it cannot be a "
            "start; give dimensions with which it moves"
        )
    opening = [varied[k].name for k in loop.openings(loop.start, q)]
    if opening and vary is not None:
        listed = ", ".join(opening[:4]) + (" .." if len(opening) > 4 else "")
        raise RequestError(
            f"vary: {listed} cannot change alone without opening the loop; leave "
            f"{'it' if len(opening) == 1 else 'them'} out"
        )
    # the point's own coordinates open nothing
    return [d for d in varied if d.name not in opening]


def _bounded(
    draft: Draft,
    dimensions: Sequence[Dimension],
    limits: Limits,
    extent: float,
    given: Mapping[str, tuple[float | str, float | str]],
) -> Iterator[FreeNumber]:
    """What varies with its bounds, those of the size held too."""
    size = max([extent, *(abs(d.value) for d in _dimensions(draft) if d.kind == "length")])
    bounds = {}
    for d in dimensions:
        low, high = _usual(d, size, drawn=d.place[0] == "joint")
        if limits.size is not None and d.kind == "length":
            least, most = limits.size
            low, high = max(low, least if d.positive else -most), min(high, most)
            if not low <= d.value <= high:
                raise RequestError(
                    f"size: {d.name} begins at {d.value:g}, outside {low:g}:{high:g}; "
                    "give other limits, or another start"
                )
        bounds[d.name] = low, high
    for pattern, pair in given.items():
        result = _named(pattern, dimensions)
        if not result:
            raise RequestError(
                f"bounds: {shown(pattern)} is not a dimension that varies; {suggestion(pattern, bounds)}"
                f"these vary: {', '.join(bounds)}"
            )
        # a pattern of lengths and angles takes numbers alone
        alike = len({d.unit for d in result}) == 1
        try:
            least, most = (
                result[0].read(value) if alike and isinstance(value, str) else float(value) for value in pair
            )
        except (TypeError, ValueError):
            least = most = math.nan
        if not (math.isfinite(least) and math.isfinite(most) and least < most):
            written = isinstance(pair, tuple) and any(isinstance(end, str) for end in pair)
            listed = ":".join(map(str, pair)) if written else pair
            raise RequestError(
                f"bounds: {shown(listed)} of {pattern} are no bounds; give the least and the greatest value, "
                "as in 100:400"
            )
        for d in result:
            if d.positive and not least > 0:
                raise RequestError(f"bounds: {least:g} of {d.name}: a link needs a length; give bounds > 0")
            if not least <= d.value <= most:
                raise RequestError(
                    f"bounds: {d.name} begins at {d.value:g} {d.unit}".rstrip()
                    + f", outside {least:g}:{most:g}; give bounds that hold it, or another start"
                )
            bounds[d.name] = least, most
    return (FreeNumber(name, *ends) for name, ends in bounds.items())


def _usual(d: Dimension, size: float, *, drawn: bool) -> tuple[float, float]:
    """Bounds of a dimension where none are given, its own value within."""
    if d.kind == "angle":
        half = HALF_TURN / d.scale
        return d.value - half, d.value + half
    if drawn and d.kind == "number":
        return d.value - TILT, d.value + TILT
    if d.kind == "number":
        return -1.0, 1.0
    if drawn:
        return d.value - DRAWN * size, d.value + DRAWN * size
    if d.positive or (d.place[-1] == "length" and d.value > 0):
        return min(SHORTEST * size, d.value), max(LONGEST * size, d.value)
    return min(-LONGEST * size, d.value), max(LONGEST * size, d.value)


def _refuse_unreachable(task: PathTask) -> None:
    """`RequestError` for a path that is larger than the linkage can reach within the bounds."""
    reach = _reach(task)
    if reach is None:
        return
    unit, wanted = task.draft.linkage.length_unit, task.want.places
    if task.design.placement == "fixed":
        far = np.linalg.norm(wanted, axis=1)
        if far.max() > reach:
            raise RequestError(
                f"points: point {far.argmax() + 1} lies {far.max():.4g} {unit} from the origin, and the "
                f"linkage reaches {reach:.4g} {unit} at most within the bounds; widen them, or place it "
                "freely"
            )
    elif (across := float(np.linalg.norm(wanted[:, None] - wanted, axis=2).max())) > 2 * reach:
        raise RequestError(
            f"points: the path is {across:.4g} {unit} across, and the linkage reaches {2 * reach:.4g} {unit} "
            "at most within the bounds; widen them"
        )


def _reach(task: PathTask) -> float | None:
    """How far the point can be from the origin within the bounds; `None` if that is open.

    It is open where joints slide, and of a drawing.
    """
    numbers = task.loop.numbers
    word, point = numbers.word, numbers.points[task.loop.named(task.point.name)]
    letters = {step.letter for step in word.steps[: point.steps]}
    if task.draft.linkage.form == "drawn" or letters & {"P", "H"}:
        return None
    places = {d.place: k for k, d in enumerate(numbers.dimensions)}
    most = np.abs(numbers.nominal)
    for d, low, high in zip(task.dimensions, task.design.low, task.design.high, strict=True):
        most[places[d.place]] = max(abs(low), abs(high))
    slides = [k for product in (*word.fixed[: point.steps], point.frame) for k in product.slides]
    coordinates = point.at if point.place is None else most[list(point.place)].tolist()
    return float(most[slides].sum()) + math.hypot(*coordinates)
