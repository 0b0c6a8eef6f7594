"""The parts of a linkage as it would be built, from rods, bars and balls: what meshes, CAD and others share.

Each turning or sliding joint has a hub with a hole on either link, side by side on the axis, and a shaft
through both; a universal joint a cross between two hubs; a ball joint a ball in an open socket; a joint that
slides in a plane a disc, as wide as it slides, and a slipper on it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.joint_shapes import HINGE_HALF, Seat, shape_of
from sevenbar.drawing.scene import link_colours
from sevenbar.drawing.style import GROUND, JOINT
from sevenbar.export.pose import Pose, extent_of, shortest_link
from sevenbar.kinematics.loop.rigid import inverse, perpendicular, placed
from sevenbar.kinematics.loop.rigid import pose as matrix
from sevenbar.kinematics.loop.rigid import unit as unit_vector
from sevenbar.kinematics.loop.single import check_single

#: Sizes as shares of the height of a hub. A hole is wider than its shaft by what a fit would never be, so
#: that no two parts touch.
HUB, HOLE, SHAFT, ARM, BALL = 0.72, 0.36, 0.33, 0.30, 0.62
#: Distance of the middles of two neighbouring hubs; how far a shaft stands out; the thickness of a hub's lid.
SPACING, STANDS_OUT, LID = 1.06, 0.18, 0.45
#: A socket's outer radius, and where its mouth is cut, in radii of the ball.
SOCKET, MOUTH = 1.42, 0.1
#: The greatest cosine of the mouth's direction and the arm that holds the socket.
AWAY = -0.35
#: Distance of a hub of a universal joint from the middle of its cross.
REACH = 1.5
#: Below this cosine between an arm and the axis, the arm first goes so far off, round the other hub.
PAST_THE_OTHER, ELBOW = -0.35, 1.6
#: The thickness of a disc and of the slipper that slides on it, and the gap between the two.
DISC, SLIPPER, GAP = 0.4, 0.6, 0.04
#: Above this cosine between an arm and the axis, the arm leaves through the hub's end, which then has a lid.
THROUGH_THE_END = 0.5
#: Below this distance [heights of a hub] two places of a link are one: copies up to rounding.
SAME = 1e-6


@dataclass(frozen=True, eq=False)
class Rod:
    """A round rod with flat ends, between two places (3,)."""

    start: Floats
    end: Floats
    radius: float


@dataclass(frozen=True, eq=False)
class Bar:
    """A square bar between two places (3,); `side` (3,) is the unit vector of its width."""

    start: Floats
    end: Floats
    width: float
    side: Floats


@dataclass(frozen=True, eq=False)
class Ball:
    """A ball about a place (3,)."""

    centre: Floats
    radius: float


Solid = Rod | Bar | Ball


def length_of(solid: Rod | Bar) -> float:
    """The length of a rod or a bar."""
    return float(np.linalg.norm(solid.end - solid.start))


def frame_of(solid: Solid) -> Floats:
    """A frame (4, 4) in the middle of a solid: z along it, x along a bar's side; of a ball as the body's."""
    if isinstance(solid, Ball):
        return matrix(np.eye(3), solid.centre)
    along = (solid.end - solid.start) / length_of(solid)
    side = solid.side if isinstance(solid, Bar) else perpendicular(along)
    turn = np.stack([side, np.cross(along, side), along], axis=1)
    return matrix(turn, (solid.start + solid.end) / 2)


def foot_of(solid: Solid) -> Floats:
    """The frame (4, 4) from which programs build a solid: in a ball's middle, a rod's end, a bar's corner."""
    frame = frame_of(solid)
    if not isinstance(solid, Ball):
        frame[:3, 3] = solid.start
    if isinstance(solid, Bar):
        frame[:3, 3] -= solid.width / 2 * (frame[:3, 0] + frame[:3, 1])
    return frame


@dataclass(frozen=True, eq=False)
class Part:
    """One piece: the union of `add` less the union of `cut`, in the frame of the body that carries it.

    `body` counts the links from 0, the ground last; from n on, the crosses of universal joints.
    """

    name: str
    body: int
    add: tuple[Solid, ...]
    cut: tuple[Solid, ...]
    colour: str


@dataclass(frozen=True, eq=False)
class Assembly:
    """All parts of a linkage, and where their bodies are in the pose: `frames` (bodies, 4, 4)."""

    pose: Pose
    parts: tuple[Part, ...]
    frames: Floats
    bodies: tuple[str, ...]
    #: The height of a hub [length].
    unit: float


def hub_height(pose: Pose) -> float:
    """The height of a hub [length]: as the figures draw it, less where links are short."""
    return min(HINGE_HALF * extent_of(pose), 0.25 * shortest_link(pose))


def assemble(pose: Pose, seats: tuple[Seat, ...], unit: float) -> Assembly:
    """All parts in a pose, each joint at its seat; raises `NotCoveredError` for a net."""
    check_single(pose.linkage)
    linkage, graph = pose.linkage, pose.linkage.graph
    colours = _link_colours(pose)
    lines = pose.polylines()
    builds = [_Build(f"link_{k}", k - 1, colour) for k, colour in enumerate(colours, 1)]
    builds.append(_Build("ground", graph.ground - 1, GROUND))
    frames, bodies = list(pose.frames), [build.name for build in builds]
    extra: list[Part] = []
    places = pose.places.places[0]
    feet = [(places[near], places[far]) for near, far in pose.places.feet]
    # where the arms of the links before and after each joint end
    ends: list[Sequence[Floats]] = [*feet]
    sides = [[builds[link - 1] for link in pair] for pair in graph.between]
    for i, joint in enumerate(linkage.joints):
        (before, after), seat = sides[i], seats[i]
        if joint.row.is_ball:
            continue
        if joint.row.has_cross:
            frame, cross, middles = _universal(before, after, pose, i, seat, unit)
            extra.append(replace(cross, body=len(frames), name=f"cross_{_word(joint.name)}"))
            frames.append(frame)
            bodies.append(f"cross_{_word(joint.name)}")
            ends[i] = middles
        else:
            # what is long stands on the ground where it can, a slot on its link
            grounded = graph.between[i][1] == graph.ground
            direction = -1 if (joint.row.slot_on_after if joint.row.has_slot else grounded) else 1
            pairs = (
                (before, after)[::direction],
                (pose.near[i], pose.far[i])[::direction],
                feet[i][::direction],
            )
            carried = _Carried(*pairs, pose, i, seat, unit, direction)
            shafts, middles = carried.plane() if joint.row.has_plane else carried.axial()
            name, body = f"shaft_{_word(joint.name)}", carried.builds[0].body
            extra += [Part(name, body, (shaft,), (), JOINT) for shaft in shafts]
            ends[i] = middles[::direction]
    arms = []
    for link, line in zip(graph.links, lines, strict=True):
        first, last = (ends[joint][graph.side(joint, link)] for joint in graph.joints_of(link))
        arms.append(np.vstack([first, _bent(line, first, last, linkage.base[:3, 3]), last]))
    for i, joint in enumerate(linkage.joints):
        if joint.row.is_ball:
            (before, after), (first, last) = sides[i], (arms[link - 1] for link in graph.between[i])
            _ball_joint(before, after, pose, i, (first, last), unit)
    for build, arm in zip(builds, arms, strict=True):
        build.arm(arm, unit)
    parts = [build.part() for build in builds]
    local = tuple(_moved(part, inverse(frames[part.body])) for part in (*parts, *extra))
    return Assembly(pose, local, np.stack(frames), tuple(bodies), unit)


class _Build:
    """A link while it is put together, in the report frame."""

    def __init__(self, name: str, body: int, colour: str) -> None:
        self.name, self.body, self.colour = name, body, colour
        self.add: list[Solid] = []
        self.cut: list[Solid] = []
        self._hubs: list[tuple[Floats, Floats, bool, Floats | None]] = []

    def hub(self, middle: Floats, outward: Floats, may_close: bool, side: Floats | None) -> None:
        """A hub about its middle; `outward` is the direction along the axis away from the other hub.

        With a `side`, the direction of its width, hub and hole are square.
        """
        self._hubs.append((middle, outward, may_close, side))

    def arm(self, line: Floats, unit: float) -> None:
        """The body along a polyline, whose ends lie in hubs or balls; then the hubs with their holes."""
        line = self._round_the_others(line, unit)
        steps = [(a, b) for a, b in pairwise(line) if np.linalg.norm(b - a) > 1e-3 * unit]
        self.add += [Rod(a, b, ARM * unit) for a, b in steps]
        self.add += [Ball(a, 1.04 * ARM * unit) for a, _ in steps[1:]]
        for middle, outward, may_close, side in self._hubs:
            near = SAME * unit
            leaves = [b - a for a, b in steps if math.dist(a, middle) < near]
            leaves += [a - b for a, b in steps if math.dist(b, middle) < near]
            closed = may_close and any(
                direction @ outward > THROUGH_THE_END * np.linalg.norm(direction) for direction in leaves
            )
            inner, outer = middle - 0.5 * unit * outward, middle + 0.5 * unit * outward
            end = outer + LID * unit * outward if closed else outer
            # the hole ends at the lid, or runs clear of both faces
            start, stop = inner - 0.25 * unit * outward, outer if closed else outer + 0.25 * unit * outward
            if side is not None:
                self.add.append(Bar(inner, end, 1.6 * HUB * unit, side))
                self.cut.append(Bar(start, stop, 1.7 * HOLE * unit, side))
            else:
                self.add.append(Rod(inner, end, HUB * unit))
                self.cut.append(Rod(start, stop, HOLE * unit))

    def _round_the_others(self, line: Floats, unit: float) -> Floats:
        """The polyline with an elbow where it would run into the hub beside its own."""
        places = list(line)
        for middle, outward, _, _ in self._hubs:
            for at_end in (False, True):
                here, ahead = (places[-1], places[-2]) if at_end else (places[0], places[1])
                direction = ahead - here
                aslant = direction @ outward < PAST_THE_OTHER * np.linalg.norm(direction)
                if not aslant or math.dist(here, middle) > SAME * unit:
                    continue
                off = direction - (direction @ outward) * outward
                length = float(np.linalg.norm(off))
                off = (
                    off / length
                    if length > 1e-3 * float(np.linalg.norm(direction))
                    else perpendicular(outward)
                )
                places.insert(len(places) - 1 if at_end else 1, here + ELBOW * unit * off)
        return np.array(places)

    def part(self) -> Part:
        """What has been put together."""
        return Part(self.name, self.body, tuple(self.add), tuple(self.cut), self.colour)


def _bent(line: Floats, first: Floats, last: Floats, centre: Floats) -> Floats:
    """The inner places of a link whose ends have moved; an arc on a sphere moves in or out with them."""
    inner = line[1:-1]
    if len(inner) < 2:
        return inner
    low, high = (
        np.linalg.norm(end - centre) / np.linalg.norm(foot - centre)
        for end, foot in ((first, line[0]), (last, line[-1]))
    )
    ratios = np.linspace(low, high, len(line))[1:-1, None]
    moved: Floats = centre + ratios * (inner - centre)
    return moved


class _Carried(NamedTuple):
    """A joint on one axis or in one plane while it is built; of each pair the carrier is first.

    `frames` are the joint's on either link, so that parts are in line only as far as the loop closes; `feet`
    are where the links end. The `direction` is 1 where the carrier is the link before, else -1.
    """

    builds: Sequence[_Build]
    frames: Sequence[Floats]
    feet: Sequence[Floats]
    pose: Pose
    i: int
    seat: Seat
    unit: float
    direction: int

    def axial(self) -> tuple[list[Solid], tuple[Floats, Floats]]:
        """Hubs and shaft of a joint on one axis; returns the shaft and the middles of both hubs."""
        seat, unit, frames = self.seat, self.unit, self.frames
        bases = [
            foot + unit * (seat.aside[0] * frame[:3, 0] + seat.aside[1] * frame[:3, 1])
            for foot, frame in zip(self.feet, frames, strict=True)
        ]
        axis, side_way = frames[0][:3, 2], frames[0][:3, 0]
        # measured along the axis from the carrier's foot
        low, high = self.direction * self.pose.travel[self.i][:: self.direction]
        shift = (seat.shift + seat.side * SPACING / 2) * unit
        stand = (low + shift - SPACING * unit) if seat.side > 0 else (high + shift + SPACING * unit)
        carrier = bases[0] + stand * axis
        sleeve = bases[1] + shift * frames[1][:3, 2]
        direction = seat.side * axis
        travels = high - low > 1e-9 * unit
        square = shape_of(self.pose.linkage.joints[self.i].row).square
        near, far = self.builds
        near.hub(carrier, -direction, True, side_way if square else None)
        far.hub(sleeve, seat.side * frames[1][:3, 2], not travels, frames[1][:3, 0] if square else None)
        reach = (0.5 + (STANDS_OUT if travels else -0.04)) * unit
        last = bases[0] + ((high if seat.side > 0 else low) + shift) * axis + reach * direction
        first = carrier - 0.46 * unit * direction
        square_bar = Bar(first, last, 1.7 * SHAFT * unit, side_way)
        return [square_bar if square else Rod(first, last, SHAFT * unit)], (carrier, sleeve)

    def plane(self) -> tuple[list[Solid], tuple[Floats, Floats]]:
        """Disc, or bar of a slot, and slipper, parts of their links; returns no shaft, and the arms' ends."""
        pose, seat, unit, (frame, other) = self.pose, self.seat, self.unit, self.frames
        joint, own = pose.linkage.joints[self.i], pose.linkage.places[self.i]
        q = np.vstack([pose.circuit.q, pose.q])[:, own]
        moves = joint.motion(q[~np.isnan(q).any(axis=1)])
        places = (moves if self.direction > 0 else np.linalg.inv(moves))[:, :2, 3]
        middle = (places.min(axis=0) + places.max(axis=0)) / 2
        radius = np.linalg.norm(places - middle, axis=1).max() + 1.2 * HUB * unit
        foot, slipper = self.feet
        direction = seat.side * frame[:3, 2]
        top = foot + frame[:3, :2] @ middle + seat.shift * unit * frame[:3, 2]
        up = unit * seat.side * other[:3, 2]
        face = slipper + seat.shift * unit * other[:3, 2] + GAP * up
        near, far = self.builds
        if joint.row.has_plate:
            near.add.append(Rod(top - DISC * unit * direction, top, float(radius)))
        else:
            under = top - HUB * unit * direction
            near.add.append(
                Bar(
                    under - radius * frame[:3, 1], under + radius * frame[:3, 1], 2 * HUB * unit, frame[:3, 0]
                )
            )
        far.add.append(Rod(face, face + SLIPPER * up, HUB * unit))
        return [], (top - 0.5 * DISC * unit * direction, face + 0.5 * SLIPPER * up)


def _universal(
    before: _Build, after: _Build, pose: Pose, i: int, seat: Seat, unit: float
) -> tuple[Floats, Part, tuple[Floats, Floats]]:
    """Hubs and cross of a universal joint; returns the cross's frame, the cross, and both middles."""
    pins, middles = [], []
    near, far = pose.near[i], pose.far[i]
    centre, axes = near[:3, 3], (near[:3, 2], far[:3, 2])
    for build, frame, side in ((before, near, seat.side), (after, far, seat.other)):
        direction = side * frame[:3, 2]
        middle = frame[:3, 3] + (REACH + seat.shift) * unit * direction
        build.hub(middle, direction, True, None)
        pins.append(Rod(centre, middle + 0.46 * unit * direction, SHAFT * unit))
        middles.append(middle)
    square = unit_vector(np.cross(*axes))
    frame = matrix(np.stack([square, np.cross(axes[0], square), axes[0]], axis=1), centre)
    cross = Part("", 0, (*pins, Ball(centre, 1.5 * SHAFT * unit)), (), JOINT)
    return frame, cross, (middles[0], middles[1])


def _ball_joint(
    before: _Build, after: _Build, pose: Pose, i: int, arms: tuple[Floats, Floats], unit: float
) -> None:
    """The ball on the link before; on the link after a socket, open to the ball's arm as it is on average."""
    radius = BALL * unit
    centre = arms[1][0]
    before.add.append(Ball(centre, radius))
    mouth = _mean_arm(pose, i, arms[0][-2] - arms[0][-1])
    own = arms[1][1] - arms[1][0]
    own = own / max(float(np.linalg.norm(own)), 1e-300)
    # the socket's own arm must hold on to it
    held = min(float(mouth @ own), AWAY)
    across = mouth - (mouth @ own) * own
    if np.linalg.norm(across) > 1e-6:
        across = across / np.linalg.norm(across) * np.sqrt(1 - held * held)
    mouth = across + held * own
    mouth = mouth / np.linalg.norm(mouth)
    after.add.append(Ball(centre, SOCKET * radius))
    # a little wider than the ball, so that the two do not touch
    after.cut.append(Ball(centre, 1.03 * radius))
    after.cut.append(Rod(centre + MOUTH * radius * mouth, centre + 2 * radius * mouth, 2 * radius))


def _mean_arm(pose: Pose, i: int, arm: Floats) -> Floats:
    """The mean direction (3,) of the arm before ball i as seen from the link after it, in this pose."""
    before, after = (link - 1 for link in pose.linkage.graph.between[i])
    here = pose.frames[after, :3, :3]
    local = pose.frames[before, :3, :3].T @ arm
    seen = pose.others[:, before, :3, :3] @ local
    mean = np.einsum("mji,mj->i", pose.others[:, after, :3, :3], seen)
    length = float(np.linalg.norm(mean))
    # arms that go all the way round have no mean
    direction: Floats = here @ mean / length if length > 1e-3 * float(np.linalg.norm(seen)) else arm
    return direction / float(np.linalg.norm(direction))


def _moved(part: Part, frame: Floats) -> Part:
    """A part with all its places taken through a rigid motion."""

    def moved(solid: Solid) -> Solid:
        if isinstance(solid, Ball):
            return replace(solid, centre=placed(frame, solid.centre))
        if isinstance(solid, Bar):
            solid = replace(solid, side=frame[:3, :3] @ solid.side)
        return replace(solid, start=placed(frame, solid.start), end=placed(frame, solid.end))

    return replace(part, add=tuple(map(moved, part.add)), cut=tuple(map(moved, part.cut)))


def _link_colours(pose: Pose) -> list[str]:
    """The figures' colours of the moving links; of neighbours of one colour one is lighter."""
    colours, _ = link_colours(pose.linkage, (pose.motion.input, pose.motion.output))
    graph = pose.linkage.graph
    for link in graph.moving:
        own = colours[link - 1]
        if own in (colours[other - 1] for other in graph.neighbours(link) if other < link):
            lighter = [round(0.55 * c + 0.45 * 255) for c in bytes.fromhex(own[1:])]
            colours[link - 1] = "#" + bytes(lighter).hex().upper()
    return colours


def _word(name: str) -> str:
    """A joint's name as a part of a part's name."""
    return "".join(c if c.isalnum() or c in "_-" else "_" for c in name)
