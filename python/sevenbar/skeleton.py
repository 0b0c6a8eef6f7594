"""The linkage in space: the places of its joints, links and points along a circuit."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.linkage import Linkage, Point
from sevenbar.motion import Circuit, Integers, Motion
from sevenbar.rigid import inverse

#: Places of the pose: the two centres and the two balls; further named points come after them.
A0, A, B, B0 = 0, 1, 2, 3


#: The places between which each link lies.
LINK_ENDS = {1: (A0, A), 2: (A, B), 3: (B, B0), 4: (B0, A0)}


@dataclass(frozen=True, eq=False)
class Walk:
    """A circuit as it is walked; closed by its first row, a turn on, unless a law drives.

    `rows` index the circuit; `input`, `output` [rad] and `time` [s] run on over the closure, each (n,).
    `passes` are the stretches between input dead centres, both ends included; `ways` has a factor for the
    velocities of each: -1 where the input goes back, against its speed, else 1.
    """

    rows: Integers
    input: Floats
    output: Floats
    time: Floats
    passes: tuple[slice, ...]
    ways: tuple[float, ...]


def walk(motion: Motion, circuit: Circuit) -> Walk:
    """The rows of a circuit in the order of its motion."""
    count = len(circuit.time)
    starts = [0, *(np.flatnonzero(np.diff(circuit.branch)) + 1), count]
    rows = np.arange(count)
    if motion.law is not None or count < 2 or not circuit.closed:
        passes = tuple(slice(a, b) for a, b in pairwise(starts))
        ways = _ways(motion, circuit.input, passes)
        return Walk(rows, circuit.input, circuit.output, circuit.time, passes, ways)
    # one that turns back on the way is walked as it rises
    way = circuit.turns * math.copysign(math.tau, motion.speed if circuit.goes_round else 1.0)
    gained = 0.0 if circuit.output_range is not None else _turns_gained(circuit.output)
    last = circuit.input[0] + way
    period = circuit.time[-1] + abs(last - circuit.input[-1]) / abs(motion.speed)
    inputs = np.append(circuit.input, last)
    passes = tuple(slice(a, b + 1) for a, b in pairwise(starts))
    return Walk(
        np.append(rows, 0),
        inputs,
        np.append(circuit.output, circuit.output[0] + gained),
        np.append(circuit.time, period),
        passes,
        _ways(motion, inputs, passes),
    )


def _ways(motion: Motion, inputs: Floats, passes: Sequence[slice]) -> tuple[float, ...]:
    if motion.law is not None or len(passes) < 2:
        return (1.0,) * len(passes)
    rises = (float(inputs[part][-1] - inputs[part][0]) for part in passes)
    return tuple(math.copysign(1.0, rise * motion.speed) for rise in rises)


def _turns_gained(angles: Floats) -> float:
    """The whole turns [rad] between the first row of a closed circuit and the first again; 0 if unknown."""
    ahead = float(2 * angles[-1] - angles[-2] - angles[0])
    return round(ahead / math.tau) * math.tau if math.isfinite(ahead) else 0.0


def along(motion: Motion, circuit: Circuit, path: Walk, column: int) -> Floats:
    """A column [rad, or length] of a circuit along its walk; a turn runs on over the closure, (n,)."""
    if column == circuit.output_column:
        return path.output
    values: Floats = circuit.q[path.rows, column]
    if len(path.rows) > len(circuit.time) and motion.linkage.column_kinds[column] == "turn":
        values[-1] += _turns_gained(circuit.q[:, column])
    return values


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The places of a linkage along a walk, in the report frame [length].

    `places` (n, 4 + k, 3): A0, A, B, B0 and k further named points, `names` of each; `axes` (2, 3) unit
    vectors along the joints at A0 and B0; `stays` the chains of places that tie further points to links.
    """

    places: Floats
    names: tuple[str, ...]
    axes: Floats
    stays: tuple[tuple[int, int, int], ...]

    def pose(self, row: float) -> Floats:
        """The places (4 + k, 3) at a row, between two rows on the straight line between them."""
        low = min(int(row), len(self.places) - 1)
        high, share = min(low + 1, len(self.places) - 1), row - low
        between: Floats = (1 - share) * self.places[low] + share * self.places[high]
        return self.places[low] if share == 0 else between

    @property
    def solid(self) -> int:
        """How many places, from the first on, a pose cannot do without."""
        return 4

    @property
    def standing(self) -> tuple[int, ...]:
        """The named places that stand still."""
        return (A0, B0)

    def lines(self, pose: Floats, screen: Floats) -> list[Floats]:
        """The lines (2, 2) of a pose, as seen on the screen, that labels should keep off."""
        seen = pose @ screen.T
        lines = [seen[[a, b]] for a, b in LINK_ENDS.values()]
        for centre, axis in zip((A0, B0), self.axes @ screen.T * self.span / 6, strict=True):
            lines.append(np.stack([seen[centre] - axis, seen[centre] + axis]))
        return lines

    @property
    def moving(self) -> tuple[int, ...]:
        """The places whose paths are drawn."""
        return (A, B, *range(4, len(self.names)))

    @cached_property
    def span(self) -> float:
        """The largest extent along x, y or z [length]."""
        high, low = (one.reduce(one.reduce(self.places, axis=0), axis=0) for one in (np.fmax, np.fmin))
        return float((high - low).max())


@dataclass(frozen=True, eq=False)
class Chain(Skeleton):
    """The places of any loop: its joints and links, then named points.

    `axes` (n, 3) are those of the first row, through each joint. `links` holds the places along each link,
    the ground's last; `marks` what is drawn of each joint: a word and the places it joins. `paths` are the
    places whose paths are drawn, `points` the named ones among them.
    """

    links: tuple[tuple[int, ...], ...]
    marks: tuple[tuple[int, str, tuple[int, ...]], ...]
    joints: tuple[int, ...]
    points: tuple[int, ...]
    extent: float

    @property
    def solid(self) -> int:
        """How many places, from the first on, a pose cannot do without."""
        return len(self.names) - len(self.points)

    @property
    def standing(self) -> tuple[int, ...]:
        """The named places that stand still."""
        return (self.joints[0], self.joints[-1])

    @property
    def moving(self) -> tuple[int, ...]:
        """The places whose paths are drawn."""
        return (*self.joints[1:-1], *self.points)

    def lines(self, pose: Floats, screen: Floats) -> list[Floats]:
        """The lines (2, 2) of a pose, as seen on the screen, that labels should keep off."""
        seen = pose @ screen.T
        ends = [pair for link in self.links for pair in pairwise(link)]
        ends += [(places[0], places[-1]) for _, _, places in self.marks]
        return [seen[list(pair)] for pair in ends]


#: Half the length of a joint's drawn axis and of its cylinder, as shares of the linkage's extent.
AXIS, CYLINDER = 0.075, 0.032


def chain(
    linkage: Linkage,
    frames: Floats,
    points: Sequence[tuple[str, int, Floats]] = (),
    *,
    extent: float | None = None,
) -> Chain:
    """The places of a loop from the frames (n, moving links, 4, 4) of its links along a walk.

    `points` are named places on links, (n, 3) each. Each joint is drawn where its axis was placed, each
    link from joint to joint; in Denavit-Hartenberg rows along the offset, then along the common normal.
    `extent` is that of the linkage where the frames show only a part of its motion.
    """
    rows, count = len(frames), len(linkage.joints)
    after = np.concatenate([frames, np.broadcast_to(linkage.ground, (rows, 1, 4, 4))], axis=1)
    steps = [frames[:, i] @ linkage.links[i] for i in range(count - 1)]
    before = np.stack([np.broadcast_to(linkage.base, (rows, 4, 4)), *steps], axis=1)
    origins = np.concatenate([before[..., :3, 3], after[..., :3, 3]])
    spread = float((np.nanmax(origins, axis=(0, 1)) - np.nanmin(origins, axis=(0, 1))).max())
    in_rows = "twist_1_deg" in linkage.dimensions
    spherical = not spread > 1e-9
    places: list[Floats] = []

    def add(place: Floats) -> int:
        places.append(np.broadcast_to(place, (rows, 3)))
        return len(places) - 1

    # a loop whose axes meet where all frames lie is shown on a sphere round that place
    radius = 1.0 if spherical else 0.0
    span = extent or (1.6 if spherical else spread)
    feet: list[tuple[int, int]] = []
    marks: list[tuple[int, str, tuple[int, ...]]] = []
    links: list[tuple[int, ...]] = []
    for i, joint in enumerate(linkage.joints):
        first, second = before[:, i, :3, 2], after[:, i, :3, 2]
        near = before[:, i, :3, 3] + radius * first
        far = after[:, i, :3, 3] + radius * second
        feet.append((add(near), add(far)))

        def along(middle: Floats, axis: Floats, half: float, to: Floats | None = None) -> tuple[int, int]:
            end = middle if to is None else to
            # not by closure errors, which would swap the ends from row to row
            back = ((end - middle) * axis).sum(axis=1, keepdims=True) < -1e-3 * span
            way = np.where(back, -1.0, 1.0) * axis
            return add(middle - half * span * way), add(end + half * span * way)

        if joint.kind != "S":
            marks.append((i, "axis", along(near, first, AXIS, far)))
        match joint.kind:
            case "R" | "C" | "H":
                cylinder = along(far, second, CYLINDER)
                marks.append((i, "cylinder", cylinder))
                marks += [(i, "thread", cylinder)] if joint.kind == "H" else []
            case "P":
                marks.append((i, "block", (feet[i][1],)))
            case "U":
                marks.append((i, "axis", along(far, second, AXIS)))
                marks += [(i, "arm", along(near, first, CYLINDER)), (i, "arm", along(far, second, CYLINDER))]
            case _:
                marks.append((i, "ball", (feet[i][1],)))
    for i in range(count):
        start, end = feet[i][1], feet[(i + 1) % count][0]
        inner: tuple[int, ...] = ()
        if spherical:
            centre = before[:, 0, :3, 3]
            inner = tuple(add(place) for place in _arc_between(centre, places[start], places[end]))
        elif in_rows:
            inner = _bend(after[:, i], places[start], places[end], add)
        links.append((start, *inner, end))
    solid = len(places)
    named = [""] * solid
    for i, joint in enumerate(linkage.joints):
        named[feet[i][1]] = short(joint.name, 24)
    for name, _, place in points:
        add(place)
        named.append(short(name, 24))
    own = tuple(range(solid, len(places)))
    stays = tuple(
        (links[link - 1][0], place, links[link - 1][-1])
        for place, (_, link, _) in zip(own, points, strict=True)
    )
    joints = tuple(foot for _, foot in feet)
    return Chain(
        np.stack(places, axis=1),
        tuple(named),
        after[0, :, :3, 2],
        stays,
        links=tuple(links),
        marks=tuple(marks),
        joints=joints,
        points=own,
        extent=span,
    )


def _bend(frame: Floats, start: Floats, end: Floats, add: Callable[[Floats], int]) -> tuple[int, ...]:
    """The corner of a link of Denavit-Hartenberg rows, between its offset and its common normal."""
    axis = frame[:, :3, 2]
    corner = start + ((end - start) * axis).sum(axis=1, keepdims=True) * axis
    small = 1e-9 * max(1e-300, float(np.nanmax(np.abs(end - start), initial=0.0)))
    if min(np.nanmax(np.abs(corner - start)), np.nanmax(np.abs(corner - end))) <= small:
        return ()
    return (add(corner),)


def _arc_between(centre: Floats, start: Floats, end: Floats) -> list[Floats]:
    """Places (n, 3) on the great circle from start to end, on a unit sphere."""
    shares = np.linspace(0, 1, 14)[1:-1]
    chords = [start + share * (end - start) - centre for share in shares]
    lengths = [np.linalg.norm(chord, axis=1, keepdims=True) for chord in chords]
    return [centre + chord / np.where(n > 1e-9, n, 1.0) for chord, n in zip(chords, lengths, strict=True)]


def frames_of(linkage: Linkage, q: Floats) -> Floats:
    """The frames (n, moving links, 4, 4) of the links in the report frame, from joint values (n, columns)."""
    now = np.broadcast_to(linkage.base, (len(q), 4, 4))
    found, column = [], 0
    for i, joint in enumerate(linkage.joints[:-1]):
        values = q[:, column : column + len(joint.columns)].T
        column += len(joint.columns)
        match joint.kind:
            case "R":
                move = _turn(values[0], 2)
            case "P":
                move = _slide(values[0])
            case "H":
                move = _turn(values[0], 2) @ _slide(joint.pitch * values[0] / math.tau)
            case "C":
                move = _turn(values[0], 2) @ _slide(values[1])
            case "U":
                move = _turn(values[0], 2) @ _turn(np.full(len(q), joint.angle), 0) @ _turn(values[1], 2)
            case _:
                move = _turn(values[0], 2) @ _turn(values[1], 1) @ _turn(values[2], 0)
        found.append(now @ move)
        now = found[-1] @ linkage.links[i]
    return np.stack(found, axis=1)


def _turn(angle: Floats, axis: int) -> Floats:
    """Rotations (n, 4, 4) about x, y or z (`axis` 0, 1, 2)."""
    matrices = np.tile(np.eye(4), (len(angle), 1, 1))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrices[:, a, a] = matrices[:, b, b] = np.cos(angle)
    matrices[:, b, a], matrices[:, a, b] = np.sin(angle), -np.sin(angle)
    return matrices


def _slide(distance: Floats) -> Floats:
    """Translations (n, 4, 4) along z."""
    matrices = np.tile(np.eye(4), (len(distance), 1, 1))
    matrices[:, 2, 3] = distance
    return matrices


def frames_along(linkage: Linkage, circuit: Circuit, rows: Integers) -> Floats:
    """The frames (n, moving links, 4, 4) of the links along rows of a circuit."""
    frames = np.tile(np.eye(4), (len(rows), len(linkage.links), 1, 1))
    for i in range(len(linkage.links)):
        x, y, z = (float(value) for value in inverse(linkage.point_frames[i])[:3, 3])
        frames[:, i, :3, 3] = circuit.point(i + 1, (x, y, z)).position[rows]
        frames[:, i, :3, :3] = circuit.link_motion(i + 1).rotation[rows]
    return frames


def skeleton(motion: Motion, circuit: Circuit) -> Skeleton:
    """The places of the linkage along the walk of a circuit."""
    linkage: Linkage = motion.linkage
    if linkage.kind != "RSSR":
        rows = walk(motion, circuit).rows
        poses = frames_of(linkage, circuit.q[rows])
        # there a ball's turns have no value, but the links a place
        lost = np.flatnonzero(circuit.status[rows] == "turns-undefined")
        if lost.size:
            poses[lost] = frames_along(linkage, circuit, rows[lost])
        if np.isnan(poses).any(axis=(1, 2, 3)).all():
            raise _nothing(circuit)
        return chain(
            linkage,
            poses,
            [(p.name, p.link, circuit.point(p.link, p.at).position[rows]) for p in linkage.points],
        )
    rows = walk(motion, circuit).rows
    traces = [circuit.point(point.link, point.at).position[rows] for point in linkage.points]
    solved = np.flatnonzero(~np.isnan(traces[0]).any(axis=1) & ~np.isnan(traces[1]).any(axis=1))
    if solved.size == 0:
        raise _nothing(circuit)
    frames = (linkage.base, linkage.ground)
    axes = np.stack([frame[:3, 2] for frame in frames])
    centres = []
    for frame, axis, trace in zip(frames, axes, traces, strict=False):
        arm = trace[solved[0]] - frame[:3, 3]
        centres.append(np.broadcast_to(frame[:3, 3] + (arm @ axis) * axis, trace.shape))
    places = np.stack([centres[0], traces[0], traces[1], centres[1], *traces[2:]], axis=1)
    names = ("A₀", "A", "B", "B₀", *(short(point.name, 24) for point in linkage.points[2:]))
    ends = [LINK_ENDS[point.link] for point in linkage.points[2:]]
    return Skeleton(places, names, axes, tuple((a, 4 + i, b) for i, (a, b) in enumerate(ends)))


def _nothing(circuit: Circuit) -> RequestError:
    return RequestError(
        f"circuit: circuit {circuit.index} has no pose at the inputs of the law; nothing to draw"
    )


def short(text: str, width: int) -> str:
    """The text, cut to so many letters."""
    return text if len(text) <= width else text[: width - 1] + "…"


def places_of(linkage: Linkage, q: Floats, frame: Skeleton) -> Floats:
    """The places (n, k, 3) of poses given by joint values (n, columns), in the order of those of `frame`."""
    frames = frames_of(linkage, q)
    points = [(point.name, point.link, _carried(linkage, frames, point)) for point in linkage.points]
    if isinstance(frame, Chain):
        return chain(linkage, frames, points, extent=frame.extent).places
    traces = [trace for _, _, trace in points]
    centres = [np.broadcast_to(frame.pose(0)[centre], traces[0].shape) for centre in (A0, B0)]
    return np.stack([centres[0], traces[0], traces[1], centres[1], *traces[2:]], axis=1)


def _carried(linkage: Linkage, frames: Floats, point: Point) -> Floats:
    """Where a point of a link is (n, 3) in poses given by the frames of the links."""
    place = linkage.point_frames[point.link - 1] @ np.array([*point.at, 1.0])
    if point.link > len(linkage.links):
        return np.broadcast_to(place[:3], (len(frames), 3))
    moved: Floats = (frames[:, point.link - 1] @ place)[:, :3]
    return moved


def one_pose(frame: Chain, row: int) -> Chain:
    """The places of one row alone."""
    return replace(frame, places=frame.places[row : row + 1])
