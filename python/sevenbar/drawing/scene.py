"""The linkage as it is drawn: the artists of its links, joints, ground and paths, and their legend."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, withStroke

from sevenbar.arrays import Floats
from sevenbar.drawing.joint_shapes import shape_of
from sevenbar.drawing.names import amount_text, shown_name
from sevenbar.drawing.skeleton import DrawnSphere, Skeleton
from sevenbar.drawing.smooth import smooth_line
from sevenbar.drawing.space import Box, ViewAxes, box_round, draw_axes, draw_frame
from sevenbar.drawing.style import (
    COUPLER,
    GROUND,
    INPUT,
    JOINT,
    OUTPUT,
    PATH,
    POINT_COLOURS,
    ROD,
    paler,
    stroke,
)
from sevenbar.drawing.view import Projection, wide_view
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.kinematics.loop.rigid import perpendicular, unit
from sevenbar.text.words import say

#: A path shorter than this share of the linkage's extent is none.
SAME = 1e-6
#: How much of the colour of a faint pose is white.
FAINT = 0.72
#: The same of the face of a link with more than two joints, its least number of sides, and its order.
PALE, SIDES, BELOW = 0.8, 3, 0.8
#: Half the width of the ground under a hinge, its depth, and the lengths of its strokes, as shares of the
#: linkage's extent.
FOOT, DEPTH, HATCH = 0.035, 0.055, 0.022
#: How far the axes through the centre of a sphere reach, as a share of its radius.
REACH = 1.3
#: The same with their letters.
LETTERED = 1.6
#: Lines on a sphere: their distance [deg], and how many places each has.
MERIDIANS, PLACES = 30.0, 121

Bars = list[tuple[Any, tuple[int, ...]]]


def shown_places(frame: Skeleton) -> Floats:
    """The places (n, 3) that a picture of all poses of a frame shows, with its sphere and its feet."""
    places = [frame.places[:, frame.shown].reshape(-1, 3)]
    if frame.sphere is not None:
        reach = frame.sphere.radius * np.concatenate([REACH * np.eye(3), -np.eye(3)])
        places.append(frame.sphere.centre + reach)
    return np.concatenate([*places, *(plate for plate, _ in _feet(frame))])


def stage(space: ViewAxes, frame: Skeleton, ends: tuple[str, str], *, around: Skeleton | None = None) -> None:
    """Draws what stands still: the paths, the sphere, rails and ground.

    `ends` are the columns of input and output. The frame of the axes is drawn by `box_of`, before or after.
    """
    whole = around or frame
    if frame.sphere is not None:
        _draw_sphere(space, frame.sphere)
    if len(frame.places) > 1:
        for place, colour in paths(frame, ends):
            if place not in frame.far:
                look = {"lw": 0.8, "zorder": 1} if colour == PATH else {"lw": 1.2, "zorder": 2}
                space.line(smooth_line(frame.places[:, place]), color=colour, **look)
    ground = frame.pose(0)[list(frame.along(frame.graph.ground))]
    space.line(ground, color=paler(GROUND, 0.35), lw=3.4, zorder=2, solid_capstyle="round")
    rails = _ground_rails(frame)
    for rail in rails.values():
        space.line(rail, color=GROUND, lw=2.0, zorder=2.5, solid_capstyle="round")
    if space.view.planar:
        _flat_feet(space, whole, rails)
        return
    for plate, (stem, *strokes) in _feet(whole):
        space.face(plate, "#e4e4e4", GROUND, 0.8, 2.2)
        space.strokes(strokes, GROUND, 0.8, 2.2)
        space.line(stem, color=GROUND, lw=2.2, zorder=2.3)


def frame_box(frame: Skeleton, view: Projection) -> Box:
    """What shows all of a frame in a view."""
    outline, sphere = None, frame.sphere
    if sphere is not None and not view.flat:
        # a disc as it is seen, the ends of the axes, and what is outside it
        turns = np.linspace(0, math.tau, PLACES)
        disc = np.stack([np.cos(turns), np.sin(turns)], axis=1) @ view.screen
        ways = sphere.radius * np.concatenate([disc, LETTERED * np.eye(3)])
        outline = np.concatenate([sphere.centre + ways, frame.places[:, frame.shown].reshape(-1, 3)])
        outline = outline[np.isfinite(outline).all(axis=1)]
    return box_round(shown_places(frame), view, outline)


def draw_box(space: ViewAxes, frame: Skeleton, box: Box) -> None:
    """Draws the frame of the axes with their names and units, once they have their place on the page."""
    sphere = frame.sphere
    if sphere is not None and not space.view.flat:
        draw_axes(space, sphere.centre, sphere.radius, REACH * sphere.radius)
        return
    # on a sphere of any radius, lengths are shares of it
    draw_frame(space, box, frame.linkage.length_unit if sphere is None or not sphere.free else "radius")


def _ground_rails(frame: Skeleton) -> dict[int, Floats]:
    """The ends (2, 3) of rails on the ground, by the joint."""
    pose, still = frame.pose(0), frame.graph.standing
    return {i: pose[list(ends)] for i, word, ends in frame.marks if word == "rail" and i in still}


def _feet(frame: Skeleton) -> list[tuple[Floats, list[Floats]]]:
    """The ground where an axis stands still: plates (4, 3) on the far side, or below; stems and hatches."""
    pose, size = frame.pose(0), 0.05 * frame.span
    rails = _ground_rails(frame)
    feet = []
    ground = frame.graph.ground
    for joint in frame.graph.standing:
        axes = [ends for i, word, ends in frame.marks if i == joint and word in ("cylinder", "arm")]
        if not axes or joint in rails:
            continue
        start, end = pose[list(axes[-frame.graph.side(joint, ground)])]
        centre, side = pose[frame.foot(joint, ground)], unit(end - start)
        away = float(side @ (centre - np.nanmean(frame.places[:, : frame.solid], axis=(0, 1))))
        side = side * math.copysign(1.0, away if abs(away) > 0.1 * frame.span else -side[2] or 1.0)
        u, foot = perpendicular(side), centre + 1.7 * size * side
        v = np.cross(side, u)
        plate = foot + size * np.stack([-u - v, u - v, u + v, v - u])
        # strokes at 45 degrees behind the plate's edge
        strokes = [np.stack([p * u - v, (p + 0.4) * u - v + 0.4 * side]) for p in np.linspace(-1, 0.6, 6)]
        feet.append((plate, [np.stack([centre, foot]), *(foot + size * line for line in strokes)]))
    return feet


def _flat_feet(space: ViewAxes, frame: Skeleton, rails: dict[int, Floats]) -> None:
    """The ground of a planar loop, as it is drawn on paper: triangles under hinges, hatches along rails."""
    pose, size = frame.pose(0), frame.span
    right, up = space.view.screen
    middle = np.nanmean(frame.places[:, : frame.solid], axis=(0, 1))
    for joint in frame.graph.standing:
        place = frame.foot(joint, frame.graph.ground)
        if joint in rails:
            start, end = rails[joint]
            along = unit(end - start)
            normal = (along @ right) * up - (along @ up) * right
            # below, or to the left of one that is upright
            side = -normal * math.copysign(1.0, normal @ up + 1e-6 * (normal @ right))
            # clear of the block that slides on it
            line = np.stack([start, end]) + 0.62 * DEPTH * size * side
            space.line(line, color=GROUND, lw=1.2, zorder=2.2)
            _hatch(space, line, along, side, size)
            continue
        word = next((word for i, word, _ in frame.marks if i == joint and word != "axis"), "")
        if word == "block":
            continue
        down = -up if (pose[place] - middle) @ up <= 0.15 * size else up
        base = pose[place] + size * (DEPTH * down + FOOT * np.stack([-right, right]))
        space.face(np.concatenate([pose[place][None], base]), "#ececec", GROUND, 1.0, 2.2)
        line = base + 0.5 * FOOT * size * np.stack([-right, right])
        space.line(line, color=GROUND, lw=1.2, zorder=2.2)
        _hatch(space, line, right, down, size)


def _hatch(space: ViewAxes, line: Floats, along: Floats, side: Floats, size: float) -> None:
    """Short strokes behind a line that stands for the ground."""
    length = float(np.linalg.norm(line[1] - line[0]))
    count = max(4, round(length / (0.7 * HATCH * size)))
    start = line[0] if (line[1] - line[0]) @ along > 0 else line[1]
    stroke_ = HATCH * size * (side - along)
    feet = [start + along * length * share for share in (np.arange(count) + 0.9) / count]
    space.strokes([np.stack([foot, foot + stroke_]) for foot in feet], GROUND, 0.8, 2.2)


def _draw_sphere(space: ViewAxes, sphere: DrawnSphere) -> None:
    """The sphere of a spherical loop: its outline, and the front of its meridians and parallels."""
    view = space.view
    turns = np.linspace(0, math.tau, PLACES)
    circle = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    outline = sphere.centre + sphere.radius * circle @ view.screen
    space.face(outline, "#f4f6f8", "#b9c0c7", 0.9, 0.5)
    rings = []
    for angle in np.arange(-90 + MERIDIANS, 90, MERIDIANS):
        high, wide = math.sin(math.radians(angle)), math.cos(math.radians(angle))
        rings.append(np.column_stack([wide * circle, np.full(PLACES, high)]))
    for angle in np.radians(np.arange(0, 180, MERIDIANS)):
        flat = np.outer(circle[:, 0], [math.cos(angle), math.sin(angle)])
        rings.append(np.column_stack([flat, circle[:, 1]]))
    for ring in rings:
        ring[ring @ view.towards < 0] = np.nan
        space.line(sphere.centre + sphere.radius * ring, color="#dbe0e5", lw=0.6, zorder=0.6)


def paths(frame: Skeleton, ends: tuple[str, str]) -> list[tuple[int, str]]:
    """The places whose paths are drawn, and the colour of each: named points, then joints that carry none.

    The hinges of one pin have one path. The far ends of links on the ground have their link's colour where it
    is that of input or output, all other joints a pale one.
    """
    colours, graph = link_colours(frame.linkage, ends)[0], frame.graph
    result = [(place, POINT_COLOURS[i % len(POINT_COLOURS)]) for i, place in enumerate(frame.points)]
    grounded = graph.neighbours(graph.ground)
    for joint, place in frame.inner.items():
        pin = [other for other, _ in result if frame.names[other] == frame.names[place]]
        apart = np.abs(frame.places[:, [*frame.points, *pin]] - frame.places[:, [place]])
        if not (np.nanmax(apart, axis=(0, 2)) < SAME * frame.span).any():
            runs = [colours[link - 1] for link in graph.between[joint] if link in grounded]
            result.append((place, runs[-1] if runs and runs[-1] != COUPLER else PATH))
    return result


def view(frame: Skeleton) -> tuple[float, float]:
    """Elevation and azimuth [deg] from which the whole motion of a frame is seen well."""
    return wide_view(frame.places[:, frame.shown].reshape(-1, 3))


def link_colours(linkage: Loop, ends: tuple[str, str]) -> tuple[list[str], list[str]]:
    """The colours of the moving links and of the joints, from the columns of input and output."""
    graph = linkage.graph
    links, joints = [COUPLER for _ in graph.moving], [JOINT for _ in graph.joints]
    # the output first, so that the input wins a link that both move
    for column, colour in zip(ends[::-1], (OUTPUT, INPUT), strict=True):
        joint = linkage.column_of(column).joint
        if joint is None:
            apart = next(one for one in linkage.links_apart if column in one.columns)
            links[apart.link - 1] = colour
        else:
            joints[joint] = colour
            links[graph.moving_link(joint) - 1] = colour
    return links, joints


def stays(frame: Skeleton, ends: tuple[str, str]) -> list[tuple[tuple[int, int, int], str]]:
    """The places that tie each named point to its link, and that link's colour."""
    colours = link_colours(frame.linkage, ends)[0] + [to_hex(paler(GROUND, 0.35))]
    return [
        (stay, colours[link])
        for stay, link in zip(frame.stays, frame.owners, strict=True)
        if stay[1] not in frame.far
    ]


def bars(
    space: ViewAxes, frame: Skeleton, ends: tuple[str, str], *, ghost: bool = False, scale: float = 1.0
) -> Bars:
    """New artists for one pose, each with the places it joins: links, joints, points; `put` moves them.

    `ends` are the columns of input and output, `scale` is that of the widths.
    """
    colours, joint_colours = link_colours(frame.linkage, ends)
    order, width = (3, 1.5) if ghost else (6, 4.0 * scale)
    look = {"zorder": order, "solid_capstyle": "round"}
    made: Bars = []
    nowhere = np.empty((0, 3))

    def add(places: tuple[int, ...], **style: Any) -> None:
        made.append((space.line(nowhere, **look | style), places))

    if not ghost:
        if space.view.flat:
            # below all paths; the first in a film
            for places, colour in zip(map(frame.along, frame.graph.moving), colours, strict=True):
                if len(places) > SIDES and places[0] == places[-1]:
                    made.append((space.panel(paler(colour, PALE), BELOW), places))
        for stay, colour in stays(frame, ends):
            add(stay, color=colour, lw=width / 3)
    for rod in frame.rods:
        add(rod, color=paler(ROD, FAINT) if ghost else ROD, lw=0.7 * width, zorder=order - 0.5)
    for places, colour in zip(map(frame.along, frame.graph.moving), colours, strict=True):
        ink = stroke() * (width + 1.4 * scale)
        outline = [] if ghost else [withStroke(linewidth=ink, foreground="#202020"), Normal()]
        add(places, color=paler(colour, FAINT) if ghost else colour, lw=width, path_effects=outline)
    if not ghost:
        still = _ground_rails(frame)
        riding = {joint for joint, word, _ in frame.marks if word == "rail"}
        for joint, word, joined in frame.marks:
            hidden = {"rail": joint in still, "axis": joint in riding or space.view.planar}
            if hidden.get(word):
                continue
            colour = joint_colours[joint]
            if space.view.flat and word in ("cylinder", "arm") and joint not in riding:
                # seen along its axis, a cylinder is a ring
                ring = {"ls": "", "marker": "o", "mfc": "white", "mew": 2.0, "ms": 8 * scale}
                # dark where the joint has no colour of its own
                edge = "#303030" if colour == JOINT else colour
                add((frame.joints[joint],), **ring, mec=edge, zorder=order + 1)
            # a block is under the pin that it carries
            above = {"axis": 0.0, "rail": 0.0, "block": -0.5}.get(word, 1.0)
            add(joined, **_mark(word, colour, scale) | {"zorder": order + above})
    for place, colour in paths(frame, ends)[: len(frame.points)]:
        if place not in frame.far:
            shade, size = (paler(colour, FAINT), 3.0) if ghost else (colour, 6.5 * scale)
            add((place,), ls="", marker="o", color=shade, ms=size, zorder=order + 2)
    return made


def _mark(word: str, colour: str, scale: float = 1.0) -> dict[str, Any]:
    """The look of a joint's mark."""

    def outline(width: float) -> list[Any]:
        return [withStroke(linewidth=width * scale * stroke(), foreground="#202020"), Normal()]

    block = {"color": colour, "lw": 11 * scale, "solid_capstyle": "butt", "path_effects": outline(12.6)}
    return {
        "axis": {"color": "#404040", "lw": 0.9 * scale, "ls": (0, (7, 2, 1.5, 2))},
        "rail": {"color": "#5c6066", "lw": 1.6 * scale},
        "cylinder": block | {"lw": 8 * scale, "path_effects": outline(9.6)},
        "thread": {"color": "white", "lw": 7 * scale, "ls": (0, (0.22, 0.22)), "dash_capstyle": "butt"},
        "arm": {"color": colour, "lw": 5 * scale, "solid_capstyle": "butt"},
        "plate": {"color": colour, "lw": 1.6 * scale},
        "block": block,
        "ball": {**shape_of(KINDS["S"]).legend, "ms": 8 * scale},
    }[word]


def put(space: ViewAxes, made: Bars, pose: Floats) -> None:
    """Moves the artists of `bars` to a pose, places (k, 3)."""
    for artist, places in made:
        space.put(artist, pose[list(places)])


def keys(frame: Skeleton, ends: tuple[str, str], seen: Projection) -> list[Line2D]:
    """The legend's entries: the links, the kinds of joints, and the paths where there are several poses."""
    colours, _ = link_colours(frame.linkage, ends)
    first, second = (shown_name(end, 24) for end in ends)
    links = [(INPUT, say("input: {joint}", joint=first)), (OUTPUT, say("output: {joint}", joint=second))]
    if COUPLER in colours:
        alone = colours.count(COUPLER) == 1
        links.append((COUPLER, say("coupler") if alone else say("other moving links")))
    thick = stroke()
    result = [Line2D([], [], color=colour, lw=5 * thick, label=name) for colour, name in links]
    if frame.rods:
        result.append(Line2D([], [], color=ROD, lw=3 * thick, label=say("rods")))
    result.append(Line2D([], [], color=paler(GROUND, 0.35), lw=4 * thick, label=say("ground")))
    for letter, kind in KINDS.items():
        if letter in frame.linkage.kind:
            shape = shape_of(kind)
            style = shape.legend_flat if seen.planar and shape.legend_flat else shape.legend
            look = {"color": JOINT, "ls": "", **style}
            look = {k: v * thick if k in ("ms", "mew") else v for k, v in look.items()}
            result.append(Line2D([], [], **look, label=say(kind.legend)))
    if frame.sphere is not None and not frame.sphere.free:
        radius = amount_text(frame.sphere.radius, frame.linkage.length_unit)
        look = {"color": "#f4f6f8", "mec": "#b9c0c7", "ms": 8 * thick, "ls": "", "marker": "o"}
        result.append(Line2D([], [], **look, label=say("sphere, radius {radius}", radius=radius)))
    names = {}
    for place, colour in paths(frame, ends) if len(frame.places) > 1 else ():
        line = frame.places[:, place]
        extent = np.ptp(line[~np.isnan(line).any(axis=1)], axis=0).max()
        if place in frame.points or extent > SAME * frame.span:
            name = say("path of {name}", name=frame.names[place])
            if frame.names[place].isdecimal() and place not in frame.points:
                name = say("path of joint {name}", name=frame.names[place])
            if colour == PATH:
                name = say("paths of the joints")
            if place in frame.far:
                name = say("{name} is far off, not shown", name=frame.names[place])
            width = (0.8 if colour == PATH else 1.4) * thick
            names[name] = Line2D([], [], color=colour, lw=width, label=name)
    return result + list(names.values())
