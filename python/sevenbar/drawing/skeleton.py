"""The linkage as it is drawn: places along its links, marks of its joints, and named points, pose by pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.joint_shapes import shape_of
from sevenbar.drawing.names import joint_label, short
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import at_row, joint_frames, poses, poses_along, walk
from sevenbar.kinematics.loop.geometry import Loop, Point
from sevenbar.kinematics.loop.graph import Graph
from sevenbar.kinematics.solvers.plane_and_sphere import sphere_of

#: Half the length of a joint's drawn axis, and how far a plate and a rail reach past what slides on them, as
#: shares of the linkage's extent.
AXIS, PLATE, RAIL = 0.075, 0.04, 0.1

#: A point farther from the linkage than so many of its extents is left outside the picture.
FARTHEST = 3.0
#: A link of a net with more ends than these is drawn as a closed outline.
MOST_ENDS = 2
#: A spherical loop is drawn on the sphere of its farthest point if that is so many times larger than its own.
LARGER = 2.0


@dataclass(frozen=True, eq=False)
class DrawnSphere:
    """The sphere on which a spherical loop is drawn: its centre (3,) and radius [length].

    `free`: nothing of the description gives a length, so that the radius is 1 by choice.
    """

    centre: Floats
    radius: float
    free: bool


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The places of a loop in poses, in the report frame [length]: its joints and links, then named points.

    `places` (n, k, 3), `names` of each; `polylines` holds the places along each link, the ground's last;
    `marks` what is drawn of each joint: its number, a word and the places it joins. `feet` are the places of
    each joint on the link before it and on the link after it, `points` those of the named points, `stays` the
    places that tie each point to its link, `owners` that link's place among the `polylines`. `extent`
    [length] is what the sizes of the marks are shares of. `reach` is how far joints slide, least and most, by
    the joint's number: across its axis (2,), or along it (1,). `sphere` is that of a spherical loop, `rods`
    the places of both ends of each rod.
    """

    linkage: Loop
    places: Floats
    names: tuple[str, ...]
    polylines: tuple[tuple[int, ...], ...]
    marks: tuple[tuple[int, str, tuple[int, ...]], ...]
    feet: tuple[tuple[int, int], ...]
    points: tuple[int, ...]
    stays: tuple[tuple[int, int, int], ...]
    owners: tuple[int, ...]
    extent: float
    reach: Mapping[int, tuple[Floats, Floats]]
    sphere: DrawnSphere | None = None
    rods: tuple[tuple[int, ...], ...] = ()

    def pose(self, row: float) -> Floats:
        """The places (k, 3) at a row, between two rows on the straight line between them."""
        return at_row(self.places, row)

    @property
    def solid(self) -> int:
        """How many places, from the first on, a pose cannot do without."""
        return len(self.names) - len(self.points)

    @property
    def graph(self) -> Graph:
        """Its links and joints."""
        return self.linkage.graph

    def along(self, link: int) -> tuple[int, ...]:
        """The places along a link."""
        return self.polylines[link - 1]

    def foot(self, joint: int, link: int) -> int:
        """The place of a joint on one of its links."""
        return self.feet[joint][self.graph.side(joint, link)]

    @property
    def joints(self) -> tuple[int, ...]:
        """The places of the joints, on the links after them; of a slot that of its pin."""
        joints = self.linkage.joints
        return tuple(pair[not one.row.slot_on_after] for pair, one in zip(self.feet, joints, strict=True))

    @property
    def inner(self) -> dict[int, int]:
        """The places of the joints between moving links, whose paths are drawn, by the joint's number."""
        standing = self.graph.standing
        return {joint: place for joint, place in enumerate(self.joints) if joint not in standing}

    @property
    def lines(self) -> list[tuple[int, int]]:
        """Pairs of places with a line between, that labels should keep off."""
        ends = [pair for line in self.polylines for pair in pairwise(line)]
        ends += [(places[0], places[-1]) for _, word, places in self.marks if word != "axis"]
        ends += [(rod[0], rod[-1]) for rod in self.rods]
        return ends + [pair for stay in self.stays for pair in pairwise(stay)]

    @cached_property
    def bounds(self) -> tuple[Floats, Floats]:
        """The least and the greatest coordinates (k, 3) that each place has in any pose."""
        return np.fmin.reduce(self.places, axis=0), np.fmax.reduce(self.places, axis=0)

    @cached_property
    def far(self) -> frozenset[int]:
        """The named points that are too far off to be in one picture with the linkage."""
        if not self.points:
            return frozenset()
        middle = np.nanmean(self.places[:, : self.solid], axis=(0, 1))
        most = FARTHEST * self._extent_of(range(self.solid))
        low, high = self.bounds
        away = np.fmax(high - middle, middle - low)
        return frozenset(place for place in self.points if np.nanmax(away[place], initial=0.0) > most > 0)

    @property
    def shown(self) -> list[int]:
        """The places that a picture shows: all but points that are far off."""
        return [place for place in range(len(self.names)) if place not in self.far]

    @cached_property
    def span(self) -> float:
        """The largest extent along x, y or z [length] of what a picture shows, rails aside."""
        rails = {end for _, word, ends in self.marks if word == "rail" for end in ends}
        return self._extent_of([place for place in self.shown if place not in rails])

    def _extent_of(self, places: Sequence[int]) -> float:
        low, high = self.bounds
        return _extent(np.stack([low[places], high[places]]))


def skeleton_of(
    linkage: Loop, frames: Floats, points: Sequence[Point] = (), *, like: Skeleton | None = None
) -> Skeleton:
    """The places of a linkage from the frames (n, links, 4, 4) of its links in n poses.

    Each joint is drawn where its axis was placed, each link from joint to joint; in Denavit-Hartenberg rows
    along the offset, then along the common normal. `like` is that of the whole motion where the
    frames show only a part of it.
    """
    rows, graph = len(frames), linkage.graph
    before, after = joint_frames(linkage, frames)
    origins = np.concatenate([before[..., :3, 3], after[..., :3, 3]])
    spread = _extent(origins)
    in_rows = linkage.in_rows
    at = [linkage.point_frames[point.link - 1] @ (*point.at, 1.0) for point in points]
    carried = [(frames[:, point.link - 1] @ place)[:, :3] for point, place in zip(points, at, strict=True)]
    sphere = like.sphere if like else _sphere(linkage, carried)
    places: list[Floats] = []

    def add(place: Floats) -> int:
        places.append(place if place.ndim == 2 else np.broadcast_to(place, (rows, 3)))
        return len(places) - 1

    span = like.extent if like else 1.6 * sphere.radius if sphere else spread
    feet: list[tuple[int, int]] = []
    marks: list[tuple[int, str, tuple[int, ...]]] = []
    reach: dict[int, tuple[Floats, Floats]] = {}
    links: list[tuple[int, ...]] = []
    for i, joint in enumerate(linkage.joints):
        # the axis as it is written
        written = -1.0 if joint.backwards else 1.0
        first, second = written * before[:, i, :3, 2], written * after[:, i, :3, 2]
        near, far = before[:, i, :3, 3], after[:, i, :3, 3]
        if sphere:
            near, far = _on_sphere(sphere, near, first), _on_sphere(sphere, far, second)
        feet.append((add(near), add(far)))
        last = graph.between[i][1] == graph.ground
        # what slides; the other side has the rail, of a joint that leads to the ground the ground
        slider, way = (near, first) if last else (far, second)

        def along(middle: Floats, axis: Floats, half: float, to: Floats | None = None) -> tuple[int, int]:
            end = middle if to is None else to
            # not by closure errors, which would swap the ends from row to row
            back = ((end - middle) * axis).sum(axis=1, keepdims=True) < -1e-3 * span
            way = np.where(back, -1.0, 1.0) * axis
            return add(middle - half * span * way), add(end + half * span * way)

        shape = shape_of(joint.row)
        if joint.row.has_plane:
            # as wide as it slides; a slot on the link after it runs under the pin on that before
            base, pin, carrier = (far, near, after) if joint.row.slot_on_after else (near, far, before)
            across = carrier[:, i, :3, :2]
            slid = np.einsum("nij,ni->nj", across, pin - base)
            low, high = np.nanmin(slid, axis=0, initial=0.0), np.nanmax(slid, axis=0, initial=0.0)
            low, high = reach[i] = like.reach[i] if like else (low, high)
            margins = PLATE * span * np.array(shape.margins)
            ends = np.stack([low - margins, high + margins])
            corners = [(ends[a, 0], ends[b, 1]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))]
            if joint.row.has_plate:
                marks.append((i, "axis", along(near + across @ ((low + high) / 2), first, AXIS)))
            marks.append((i, "axis", along(pin, second, AXIS)))
            outline = tuple(add(base + across @ np.array(corner)) for corner in corners)
            marks.append((i, "plate", outline))
            marks += [(i, word, along(pin, second, shape.half)) for word in shape.marks]
            continue
        if joint.row.rides:
            slid = ((far - near) * first).sum(axis=1)
            low, high = np.nanmin(slid, initial=0.0)[None], np.nanmax(slid, initial=0.0)[None]
            low, high = reach[i] = like.reach[i] if like else (low, high)
            start, end = low - RAIL * span, high + RAIL * span
            rail = (near + start * first, near + end * first)
            if last:
                rail = (far - end * second, far - start * second)
            marks.append((i, "rail", (add(rail[0]), add(rail[1]))))
        if shape.half:
            # where nothing slides, a closure error would turn the axis round between two rows
            marks.append((i, "axis", along(near, first, AXIS, far if joint.row.rides else None)))
        stretches = [(slider, way)]
        if joint.row.has_cross:
            marks.append((i, "axis", along(far, second, AXIS)))
            stretches = [(near, first), (far, second)]
        for stretch in stretches:
            drawn: tuple[int, ...] = along(*stretch, shape.half) if shape.half else (feet[i][1],)
            marks += [(i, word, drawn) for word in shape.marks]
    rods = [
        tuple(
            add((frames[:, link - 1] @ (*end, 1.0))[:, :3])
            for link, end in zip(rod.between, rod.at, strict=True)
        )
        for rod in linkage.rods
    ]
    tips: dict[int, list[int]] = {link: [] for link in graph.links}
    for rod, pair in zip(linkage.rods, rods, strict=True):
        for link, tip in zip(rod.between, pair, strict=True):
            tips[link].append(tip)
    for link in graph.links:
        steps = [feet[joint][graph.side(joint, link)] for joint in graph.joints_of(link)] + tips[link]
        line = steps[:1]
        for start, end in pairwise(steps):
            if sphere:
                line += [add(place) for place in _arc_between(sphere, places[start], places[end])]
            elif in_rows:
                corner = _corner(after[:, graph.joints_of(link)[0]], places[start], places[end])
                bends = len(like.along(link)) > 2 if like else _bends(corner, places[start], places[end])
                line += [add(corner)] if bends else []
            line.append(end)
        if linkage.net is not None and link != graph.ground and len(steps) > MOST_ENDS:
            line.append(steps[0])
        links.append(tuple(line))
    solid = len(places)
    named = [""] * solid
    for i, joint in enumerate(linkage.joints):
        rides = graph.between[i][1] == graph.ground and joint.row.rides
        named[feet[i][not (rides or joint.row.slot_on_after)]] = joint_label(linkage, i)
    for point, place in zip(points, carried, strict=True):
        add(place)
        named.append(short(point.name, 24))
    own = tuple(range(solid, len(places)))
    return Skeleton(
        linkage,
        np.stack(places, axis=1),
        tuple(named),
        polylines=tuple(links),
        rods=tuple(rods),
        marks=tuple(marks),
        feet=tuple(feet),
        points=own,
        stays=tuple(
            (links[point.link - 1][0], place, links[point.link - 1][-1])
            for place, point in zip(own, points, strict=True)
        ),
        owners=tuple(point.link - 1 for point in points),
        extent=span,
        reach=reach,
        sphere=sphere,
    )


def _extent(places: Floats) -> float:
    """The largest extent of places (n, k, 3) along x, y or z [length]; those that are NaN aside."""
    high, low = (one.reduce(one.reduce(places, axis=0), axis=0) for one in (np.fmax, np.fmin))
    return float((high - low).max())


def _corner(frame: Floats, start: Floats, end: Floats) -> Floats:
    """The corner (n, 3) of a link of Denavit-Hartenberg rows, between its offset and its common normal."""
    axis = frame[:, :3, 2]
    return np.asarray(start + ((end - start) * axis).sum(axis=1, keepdims=True) * axis)


def _bends(corner: Floats, start: Floats, end: Floats) -> bool:
    """Whether the corner of a link is a place of its own in any pose."""
    small = 1e-9 * max(1e-300, float(np.nanmax(np.abs(end - start), initial=0.0)))
    return not min(np.nanmax(np.abs(corner - start)), np.nanmax(np.abs(corner - end))) <= small


def _sphere(linkage: Loop, named: Sequence[Floats]) -> DrawnSphere | None:
    """The sphere on which a loop with the places (n, 3) of its points is drawn, if it is spherical."""
    # a joint whose axes cross in the centre, universal or a ball, has no place on the sphere
    result = sphere_of(linkage) if set(linkage.kind) == {"R"} else None
    if result is None:
        return None
    at = (
        linkage.joint_on(j, link)[:3, 3]
        for link in linkage.graph.moving
        for j in linkage.graph.joints_of(link)
    )
    free = not named and all(np.abs(place).max() <= 1e-9 for place in at)
    # a point keeps its distance from the centre, while a joint may be drawn anywhere on its axis
    away = [np.nanmax(np.linalg.norm(places - result.centre, axis=1), initial=0.0) for places in named]
    farthest = float(max(away, default=0.0))
    return DrawnSphere(result.centre, farthest if farthest > LARGER * result.radius else result.radius, free)


def _on_sphere(sphere: DrawnSphere, places: Floats, axes: Floats) -> Floats:
    """Where axes (n, 3) through places (n, 3) leave the sphere, on the side of the places."""
    side = ((places - sphere.centre) * axes).sum(axis=1, keepdims=True)
    outward: Floats = np.where(side < -1e-9 * sphere.radius, -1.0, 1.0) * axes
    return sphere.centre + sphere.radius * outward


def _arc_between(sphere: DrawnSphere, start: Floats, end: Floats) -> list[Floats]:
    """Places (n, 3) on the great circle of a sphere from start to end."""
    shares = np.linspace(0, 1, 14)[1:-1]
    chords = [start + share * (end - start) - sphere.centre for share in shares]
    lengths = [np.linalg.norm(chord, axis=1, keepdims=True) / sphere.radius for chord in chords]
    return [
        sphere.centre + chord / np.where(n > 1e-9, n, 1.0) for chord, n in zip(chords, lengths, strict=True)
    ]


def skeleton(motion: Motion, circuit: Circuit) -> Skeleton:
    """The places of the linkage along the walk of a circuit."""
    frames = poses_along(motion.linkage, circuit, walk(circuit).rows)
    if np.isnan(frames).any(axis=(1, 2, 3)).all():
        raise RequestError(
            f"circuit: circuit {circuit.index} has no pose at the inputs of the law; nothing to draw"
        )
    return skeleton_of(motion.linkage, frames, motion.linkage.added_points)


def places_of(q: Floats, frame: Skeleton) -> Floats:
    """The places (n, k, 3) of poses given by joint values (n, columns), in the order of those of `frame`."""
    linkage = frame.linkage
    return skeleton_of(linkage, poses(linkage, q), linkage.added_points, like=frame).places


def one_pose(frame: Skeleton, row: int) -> Skeleton:
    """The places of one row alone."""
    return replace(frame, places=frame.places[row : row + 1])
