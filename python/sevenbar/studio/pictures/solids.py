"""The simple solids that stand for a linkage: tubes for links, and for joints what engineers know them by."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise

import numpy as np
from matplotlib.colors import to_rgb

from sevenbar.arrays import Floats
from sevenbar.drawing.joint_shapes import shape_of
from sevenbar.drawing.names import named_together
from sevenbar.drawing.scene import link_colours, paths
from sevenbar.drawing.skeleton import Skeleton
from sevenbar.drawing.style import GROUND, JOINT, ROD
from sevenbar.kinematics.loop.rigid import rotation_of
from sevenbar.studio.pictures.layout import NOWHERE, JointPlaces, Layout, Pair, layout
from sevenbar.studio.pictures.poses import SOLID, Colours, Poses, SolidPlan, poses, slices, turns
from sevenbar.studio.pictures.shapes import TURNS

__all__ = ["Poses", "SolidPlan", "plan", "poses", "rgb"]

#: The measure of all thicknesses, as a share of the linkage's extent.
UNIT = 0.02
#: A link thinner than it is short looks like a link: the unit is at most this share of the shortest ...
SHORTEST = 0.24
#: ... save where that made all others threads.
THINNEST = 0.4
#: A link shorter than this share of the extent is none: two joints in one place.
NO_LINK = 0.02

#: Radii, and lengths where two are given, in units.
LINK, POINT, STAY, RAIL, STEM, ROD_WIDE, TIP = 0.55, 0.9, 0.2, 0.45, 0.6, 0.42, 0.8
#: Links that lie in one line would flicker where they are equally thick: of neighbours each is thicker by
#: this share than the one before, and the ground is thinner than all, and than rails.
THICKER, THICKNESSES, GROUND_LINK = 0.09, 3, 0.36
THREAD = 0.85
#: The sides of a foot across and along, and its distance, in units.
FOOT, REACH = (5.4, 0.6), 4.2
#: Strokes behind a foot: how many, how far each leans out as a share of its width, how thick in units.
STROKES, LEAN, STROKE = 5, 0.13, 0.12
#: Where feet go that are free to choose: down, and level ones always to the same side.
DOWNWARDS = np.array([0.01, 0.1, -1.0])
#: How far a rail reaches past what slides on it, in units.
PAST = 2.6

#: Pins and rails, and the balls of ball joints.
STEEL, BRIGHT = "#5c6066", "#e6e6e6"
#: Joints that are neither input nor output, lighter than the ground; and the strokes behind a foot.
OTHER_JOINT, STROKE_COLOUR = "#c6c9ce", "#a9a9a9"
#: The least and greatest pitch of a thread that is drawn as it is, in units.
FINE, COARSE = 0.7, 1.1


@cache
def rgb(colour: str, white: float = 0.0) -> Colours:
    """The colour (3,), mixed with a share of white, as the scene takes it: 0 to 255, linear in light."""
    coded = white + (1.0 - white) * np.array(to_rgb(colour))
    light = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    return np.round(light * 255).astype(np.uint8)


@dataclass
class _Solids:
    """Solids as they are collected, by shape."""

    layout: Layout
    fixed: list[Floats] = field(default_factory=list)
    rows: dict[str, list[tuple[object, ...]]] = field(default_factory=dict)

    def anchor(self, place: Floats) -> int:
        """A new place that never moves."""
        self.fixed.append(place)
        return self.layout.count + len(self.fixed) - 1

    def add(
        self,
        shape: str,
        joins: Pair,
        sides: float | Floats,
        colour: str,
        *,
        share: float = 0.5,
        shift: float = 0.0,
        length: float = np.nan,
        guide: Pair = NOWHERE,
        roll: Pair = NOWHERE,
        slide: Pair = NOWHERE,
        twist: float = 0.0,
        moves: bool = True,
    ) -> None:
        row = ((*joins, *guide, *roll, *slide), share, shift, length, twist, sides, rgb(colour), moves)
        self.rows.setdefault(shape, []).append(row)


def plan(frame: Skeleton, ends: tuple[str, str]) -> SolidPlan:
    """The solids of a linkage along a circuit, coloured by the columns of input and output.

    Thicknesses are shares of the extent, less where a link is short. Rails reach over the whole of the
    frame's motion. The frame needs a row without NaN.
    """
    where, size = layout(frame), frame.span
    solids = _Solids(where)
    solved = ~np.isnan(frame.places.sum(axis=(1, 2)))
    every = frame.places if solved.all() else frame.places[solved]
    unit = _unit(where, every[0], size)
    links, joints = link_colours(frame.linkage, ends)
    links.append(GROUND)
    joints = [OTHER_JOINT if colour == JOINT else colour for colour in joints]
    for i, (way, colour) in enumerate(zip(frame.polylines, links, strict=True)):
        moves = colour is not GROUND
        thick = unit * (LINK * (1 + THICKER * (i % THICKNESSES)) if moves else GROUND_LINK)
        for pair in pairwise(way):
            solids.add("cylinder", pair, thick, colour, moves=moves)
        for corner in way[1:-1]:
            solids.add("ball", (corner, corner), thick, colour, length=thick, moves=moves)
    for start, *_, end in frame.rods:
        solids.add("cylinder", (start, end), ROD_WIDE * unit, ROD)
        for tip in (start, end):
            solids.add("ball", (tip, tip), TIP * unit, BRIGHT, length=TIP * unit)
    for i, (joint, colour) in enumerate(zip(where.joints, joints, strict=True)):
        if joint.kind.rides:
            _add_slide(solids, i, joint, colour, every, unit)
        else:
            _add_joint(solids, i, joint, colour, links, every, unit)
    for i in frame.graph.standing:
        if not where.joints[i].kind.rides:
            _add_ground(solids, i, every, unit, size)
    points = paths(frame, ends)[: len(frame.points)]
    for (start, place, end), (_, colour), link in zip(frame.stays, points, frame.owners, strict=True):
        for corner in (start, end):
            solids.add("cylinder", (corner, place), STAY * unit, links[link], moves=False)
        solids.add("ball", (place, place), POINT * unit, colour, length=POINT * unit, moves=False)
    return _made(solids, frame, every[0], size)


def _unit(where: Layout, pose: Floats, size: float) -> float:
    """The measure of all thicknesses [length]."""
    lines = [pose[list(way)] for way in where.frame.polylines]
    lengths = [float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines]
    shortest = min((length for length in lengths if length > NO_LINK * size), default=size)
    return UNIT * size * min(1.0, max(THINNEST, SHORTEST * shortest / (UNIT * size)))


def _made(solids: _Solids, frame: Skeleton, pose: Floats, size: float) -> SolidPlan:
    where = solids.layout
    return SolidPlan(
        slices({shape: len(result) for shape, result in solids.rows.items()}),
        np.array([row for rows in solids.rows.values() for row in rows], SOLID),
        where.count,
        np.array(solids.fixed).reshape(-1, 3),
        np.array([pair for joint in where.joints for pair in joint.axes]).reshape(-1, 2),
        _labels(frame, pose, size),
    )


def _labels(frame: Skeleton, pose: Floats, size: float) -> tuple[tuple[str, int], ...]:
    """The names of places; those in one place share a label."""
    named = named_together(frame.names, pose[None], 1e-6 * size)
    return tuple((", ".join(names), place) for place, names in named.items())


def _add_joint(
    solids: _Solids,
    index: int,
    joint: JointPlaces,
    colour: str,
    links: list[str],
    every: Floats,
    unit: float,
) -> None:
    """The solids of a joint that does not slide."""
    frame, far = solids.layout.frame, joint.far
    before, after = frame.graph.between[index]
    # the link between two ball joints has both sockets
    others = frame.graph.others_of(before, index)
    holder = before if any(solids.layout.joints[i].kind.is_ball for i in others) else after
    line = frame.along(holder)
    places = {
        "spin": [joint.spin],
        "first": joint.axes[:1],
        "last": joint.axes[-1:],
        "each": joint.axes,
        "centre": [(far, far)],
        "link": [(line[1], line[0]) if holder == after else (line[-2], line[-1])],
    }
    colours = {"joint": colour, "link": links[holder - 1], "steel": STEEL, "bright": BRIGHT}
    for one in shape_of(joint.kind).solids:
        wide = one.radius * unit
        if one.reaches:
            away = every[:, far] - every[:, list(joint.axes[0])].mean(axis=1)
            wide += float(np.linalg.norm(away, axis=1).max())
        for pair in places[one.on]:
            solids.add(one.mesh, pair, wide, colours[one.colour], share=one.share, length=one.length * unit)


def _add_slide(
    solids: _Solids, index: int, joint: JointPlaces, colour: str, every: Floats, unit: float
) -> None:
    """A rail and what slides on it, over its whole reach in poses `every` (n, places, 3)."""
    # the ground, else the link before, has the rail, and the other what slides
    graph = solids.layout.frame.graph
    before, after = graph.between[index]
    last = after == graph.ground
    start, end = joint.axes[0]
    rail, slider = (joint.far, joint.near) if last else (joint.near, joint.far)
    to_rail, to_slider = ((rail, end), (start, slider)) if last else ((start, rail), (slider, end))
    at_rail, at_slider = (0.0, 1.0) if last else (1.0, 0.0)
    carriers = (after, before) if last else (before, after)
    guide = joint.spin
    if guide == NOWHERE:
        guide = _best(
            [pair for link in carriers for pair in solids.layout.rigid(link)], to_rail, every, along=True
        )
    ways = _unit_ways(every, to_rail)
    turned = np.where(np.einsum("ij,ij->i", ways, _ways(every, guide)) < 0, -1.0, 1.0)
    slid = np.einsum("ij,ij->i", _ways(every, (rail, slider)), ways) * turned
    low, high = min(0.0, slid.min()) - PAST * unit, max(0.0, slid.max()) + PAST * unit
    if guide == NOWHERE:
        low, high = -max(-low, high), max(-low, high)
    rail_roll, roll = (_best(solids.layout.rigid(link), to_rail, every, along=False) for link in carriers)
    # where a link has nothing off the axis, the other's turn gives its own
    rate = math.tau / joint.pitch if joint.kind.is_screw and joint.pitch else 0.0
    rail_twist = -rate if rail_roll == NOWHERE else 0.0
    twist = rate if roll == NOWHERE else 0.0
    rail_roll, roll = (rail_roll if rail_roll != NOWHERE else roll), (roll if roll != NOWHERE else rail_roll)
    rod, radius, pieces, piece = "cylinder", RAIL, 1, high - low
    if joint.kind.is_screw:
        rod, radius = ("thread" if joint.pitch >= 0 else "left thread"), THREAD
        piece = TURNS * float(np.clip(abs(joint.pitch), FINE * unit, COARSE * unit))
        pieces = math.ceil((high - low) / piece)
    for k in range(pieces):
        solids.add(
            rod, to_rail, radius * unit, STEEL,
            share=at_rail, shift=low + (k + 0.5) * piece, length=piece, guide=guide,
            roll=rail_roll, slide=(rail, slider), twist=rail_twist,
        )  # fmt: skip
    slider_mesh, wide, long = shape_of(joint.kind).slider
    solids.add(
        slider_mesh,
        to_slider,
        wide * unit,
        colour,
        share=at_slider,
        length=long * unit,
        guide=guide,
        roll=roll,
        slide=(rail, slider),
        twist=twist,
    )
    if index in graph.standing:
        for reach in (low, high):
            outward = np.sign(reach) * turned[0] * ways[0]
            _add_foot(solids, every[0, rail] + abs(reach) * outward, outward, 0.6 * FOOT[0], unit)


def _ways(every: Floats, pair: Pair) -> Floats:
    """The ways (n, 3) between two places."""
    return every[:, pair[1]] - every[:, pair[0]]


def _unit_ways(every: Floats, pair: Pair) -> Floats:
    ways = _ways(every, pair)
    unit: Floats = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    return unit


def _best(pairs: list[Pair], axis: Pair, every: Floats, *, along: bool) -> Pair:
    """Of pairs rigid with a link the one most along the axis, or across it; nowhere if there is none."""
    way = _unit_ways(every[:1], axis)[0]
    best, most = NOWHERE, 1e-6
    for pair in pairs:
        other = _ways(every[:1], pair)[0]
        length = float(np.linalg.norm(other))
        part = abs(float(other @ way)) / (length or 1.0)
        share = part if along else float(np.sqrt(max(0.0, 1.0 - part**2)))
        if length > 0 and share > most + 1e-6:
            best, most = pair, share
    return best


def _add_ground(solids: _Solids, index: int, every: Floats, unit: float, size: float) -> None:
    """The foot of a joint on the ground, on the side of its axis that the moving link leaves free."""
    joint, frame, pose = solids.layout.joints[index], solids.layout.frame, every[0]
    ground = frame.graph.ground
    centre, side = pose[frame.foot(index, ground)], np.array([0.0, 0.0, -1.0])
    if joint.axes:
        axis = _unit_ways(every[:1], joint.axes[-frame.graph.side(index, ground)])[0]
        moving = frame.along(frame.graph.moving_link(index))
        beside = float((pose[list(moving)].mean(axis=0) - centre) @ axis)
        outside = float((centre - every[:: max(1, len(every) // 24)].mean(axis=(0, 1))) @ axis)
        if abs(beside) > 0.5 * unit:
            side = -np.sign(beside) * axis
        elif abs(outside) > 0.1 * size:
            side = np.sign(outside) * axis
        else:
            side = axis if axis @ DOWNWARDS >= 0 else -axis
    foot = centre + REACH * unit * side
    solids.add("cylinder", (solids.anchor(centre), solids.anchor(foot)), STEM * unit, GROUND, moves=False)
    _add_foot(solids, foot, side, FOOT[0], unit)


def _add_foot(solids: _Solids, place: Floats, outward: Floats, wide: float, unit: float) -> None:
    """A plate that stands for the ground, hatched on its far side."""
    back = place + FOOT[1] * unit * outward
    pair = solids.anchor(place), solids.anchor(back)
    solids.add("box", pair, wide * unit, GROUND, moves=False)
    # in the plate's own axes, as `poses` turns it
    across, aside, _ = rotation_of(turns(outward, np.zeros(3))).T
    sideways = solids.anchor(np.zeros(3)), solids.anchor(aside)
    for share in np.linspace(-0.5, 0.5 - LEAN, STROKES):
        start = back + share * wide * unit * across
        pair = solids.anchor(start), solids.anchor(start + LEAN * wide * unit * (across + outward))
        sides = np.array([wide, STROKE]) * unit
        solids.add("box", pair, sides, STROKE_COLOUR, roll=sideways, moves=False)
