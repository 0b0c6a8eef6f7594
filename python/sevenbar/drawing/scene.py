"""The linkage in space: the artists that draw its places."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, withStroke
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3D, Poly3DCollection  # type: ignore[import-untyped]

from sevenbar.arrays import Floats
from sevenbar.drawing.skeleton import A0, B0, LINK_ENDS, A, B, Chain, Skeleton, short
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.joints import KINDS
from sevenbar.kinematics.motion import Motion

#: Colours of Okabe and Ito, told apart by colour-blind readers too.
INPUT, OUTPUT, COUPLER, GROUND = "#0072B2", "#D55E00", "#009E73", "#808080"


JOINT, PATH = "#9a9a9a", "#b5c7bd"


POINT_COLOURS = ("#CC79A7", "#E69F00", "#56B4E9", "#000000")


#: The thinnest side of the drawn box, as a share of its longest.
THINNEST_BOX = 0.4


def stage(axes: Any, motion: Motion, frame: Skeleton) -> None:
    """Draws into 3D axes what stands still: paths, ground, bearings, joint axes; and sets the view."""
    if isinstance(frame, Chain):
        return stage_chain(axes, motion.linkage, frame)
    axes.computed_zorder = False
    axes.view_init(*view(frame))
    axes.set_proj_type("ortho")
    drawn = [frame.places.reshape(-1, 3)]
    for place, colour in zip(frame.moving, (*_ends_colours(motion), *_point_colours(frame)), strict=True):
        path = _arc(frame, place) if place in (A, B) else frame.places[:, place]
        axes.plot(*path.T, color=colour, lw=1.1, alpha=0.85, zorder=2)
    unit = 0.02 * frame.span
    ground = frame.pose(0)[[A0, B0]]
    axes.plot(*ground.T, color=GROUND, lw=3, alpha=0.6, zorder=2, solid_capstyle="round")
    middle = np.nanmean(frame.places.reshape(-1, 3), axis=0)
    for centre, axis, arm in zip(ground, frame.axes, _arms(frame), strict=True):
        away = float(axis @ (centre - middle))
        down = -math.copysign(1.0, axis[2] or 1.0)
        side = axis * (math.copysign(1.0, away) if abs(away) > 0.1 * frame.span else down)
        drawn.append(_bearing(axes, centre, side, unit, min(unit, max(0.4 * unit, 0.4 * arm))))
    _equal_box(axes, np.concatenate(drawn), motion.linkage.length_unit)
    return None


def stage_chain(
    axes: Any, linkage: Loop, frame: Chain, *, around: Chain | None = None, fill: float = 0.74
) -> None:
    """Draws into 3D axes what stands still of any loop: the paths and the ground; and sets the view.

    The view shows all places of `around`, of the frame itself where none is given.
    """
    prepare_view(axes, (around or frame).places.reshape(-1, 3), linkage.length_unit, fill)
    if len(frame.places) > 1:
        for place in frame.joints[1:-1]:
            axes.plot(*frame.places[:, place].T, color=PATH, lw=0.8, zorder=1)
        for place, colour in zip(frame.points, _point_colours(frame), strict=True):
            axes.plot(*frame.places[:, place].T, color=colour, lw=1.4, alpha=0.9, zorder=2)
    ground = frame.pose(0)[list(frame.links[-1])]
    axes.plot(*ground.T, color=GROUND, lw=4, alpha=0.6, zorder=2, solid_capstyle="round")


def prepare_view(axes: Any, places: Floats, unit: str, fill: float = 0.74) -> None:
    """Sets the view and the limits of 3D axes to show places (n, 3) [length] well, over a share `fill`."""
    axes.computed_zorder = False
    axes.view_init(*_wide_view(places))
    axes.set_proj_type("ortho")
    _equal_box(axes, places, unit, fill)
    for scale in (axes.xaxis, axes.yaxis):  # the last ones would fall together in the corner
        scale.get_major_locator().set_params(prune="both")


def view(frame: Skeleton) -> tuple[float, float]:
    """Elevation and azimuth [deg] from which the whole motion of a frame is seen well."""
    return _wide_view(frame.places.reshape(-1, 3)) if isinstance(frame, Chain) else _view(frame)


def _wide_view(places: Floats) -> tuple[float, float]:
    """Elevation and azimuth [deg] from which places (n, 3) cover the most."""
    azimuths = (np.arange(-180.0, 180.0, 90.0)[:, None] + [25.0, 45.0, 65.0]).ravel()
    elevation, azimuth = (grid.ravel() for grid in np.meshgrid([20.0, 30.0, 45.0], azimuths))
    kept = places[~np.isnan(places).any(axis=1)]
    spread = (kept - kept.mean(axis=0)).T @ (kept - kept.mean(axis=0))
    screens = [_directions(*view) for view in zip(elevation, azimuth, strict=True)]
    covered = np.array([np.sqrt(max(np.linalg.det(s @ spread @ s.T), 0.0)) for s in screens])
    # among like views the usual one, x to the right and y away
    unusual = (1 - np.cos(np.radians(azimuth + 60.0))) / 2 + np.abs(elevation - 30.0) / 100
    best = int(np.argmax(covered / (covered.max() or 1.0) - 0.3 * unusual))
    return float(elevation[best]), float(azimuth[best])


def _arc(frame: Skeleton, ball: int) -> Floats:
    """The arc of a circle that A or B runs over, smooth however coarse the rows are."""
    end = 0 if ball == A else 1
    centre = frame.pose(0)[(A0, B0)[end]]
    arms = frame.places[:, ball] - centre
    arms = arms[~np.isnan(arms).any(axis=1)]
    across = np.cross(frame.axes[end], arms[0])
    turn = np.unwrap(np.arctan2(arms @ across, arms @ arms[0]))
    grid = np.linspace(turn.min(), turn.max(), 241)[:, None]
    arc: Floats = centre + np.cos(grid) * arms[0] + np.sin(grid) * across
    return arc


def _arms(frame: Skeleton) -> tuple[float, float]:
    distances = np.linalg.norm(frame.places[:, [A, B]] - frame.places[:, [A0, B0]], axis=2)
    crank, rocker = np.nanmax(distances, axis=0)
    return float(crank), float(rocker)


def _view(frame: Skeleton) -> tuple[float, float]:
    """Elevation and azimuth [deg] that show both circles open and the ground link from the side."""
    # none along an axis of the box, whose labels would fall together
    azimuths = (np.arange(-180.0, 180.0, 90.0)[:, None] + [20.0, 30.0, 45.0, 60.0, 70.0]).ravel()
    elevation, azimuth = (grid.ravel() for grid in np.meshgrid([20.0, 30.0, 40.0, 50.0], azimuths))
    up, round_ = np.radians(elevation), np.radians(azimuth)
    towards = np.stack([np.cos(up) * np.cos(round_), np.cos(up) * np.sin(round_), np.sin(up)], axis=1)
    opened = np.abs(towards @ frame.axes.T).min(axis=1)
    ground = frame.pose(0)[B0] - frame.pose(0)[A0]
    end_on = np.abs(towards @ ground) / (np.linalg.norm(ground) or 1.0)
    # among like views the usual one, x to the right and y away
    unusual = (1 - np.cos(np.radians(azimuth + 60.0))) / 2 + np.abs(elevation - 30.0) / 100
    best = int(np.argmax(np.minimum(opened, 0.6) - 0.4 * end_on**2 - 0.3 * unusual))
    return float(elevation[best]), float(azimuth[best])


def _bearing(axes: Any, centre: Floats, side: Floats, unit: float, radius: float) -> Floats:
    """An R joint on the ground: cylinder, axis, hatched plate on the far side; returns their hull (n, 3)."""
    across = np.cross(side, np.eye(3)[np.argmin(np.abs(side))])
    u = across / np.linalg.norm(across)
    v = np.cross(side, u)
    turn = np.linspace(0, math.tau, 17)
    ring = radius * (np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v)
    near, far = centre - 1.8 * unit * side + ring, centre + 1.8 * unit * side + ring
    wall = [np.stack([near[i], near[i + 1], far[i + 1], far[i]]) for i in range(16)]
    foot = centre + 4.5 * unit * side
    corners = [foot + 2.8 * unit * (p * u + q * v) for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    plate = Poly3DCollection([corners], facecolors="#e4e4e4", edgecolors=GROUND, lw=0.8, zorder=3)
    axes.add_collection3d(plate)
    # strokes at 45 degrees behind the plate's edge say "ground"
    for p in np.linspace(-1, 0.6, 6):
        ends = foot + 2.8 * unit * np.stack([p * u - v, (p + 0.4) * u - v + 0.4 * side])
        axes.plot(*ends.T, color=GROUND, lw=0.8, zorder=3)
    axes.plot(*np.stack([centre, foot]).T, color=GROUND, lw=2.2, zorder=3)
    ends = np.stack([centre - 8 * unit * side, centre + 8 * unit * side])
    axes.plot(*ends.T, color="#404040", lw=0.9, ls=(0, (7, 2, 1.5, 2)), zorder=4)
    # apart, for faces of unlike corner counts in one collection are padded with what the memory held
    for faces in (wall, [near[:-1], far[:-1]]):
        look = {"facecolors": "#b8b8b8", "edgecolors": "#707070", "lw": 0.25, "zorder": 5}
        axes.add_collection3d(Poly3DCollection(faces, **look, shade=True))
    return np.concatenate([ends, near, far, np.stack(corners)])


def _equal_box(axes: Any, drawn: Floats, unit: str, fill: float = 0.74) -> None:
    """Limits round everything drawn, a length unit as long along each axis, as large as the axes can hold."""
    low, high = np.nanmin(drawn, axis=0), np.nanmax(drawn, axis=0)
    extent = np.maximum(high - low, THINNEST_BOX * (high - low).max()) * 1.04
    middle = (low + high) / 2
    for index, name in enumerate("xyz"):
        ends = (middle[index] - extent[index] / 2, middle[index] + extent[index] / 2)
        getattr(axes, f"set_{name}lim3d")(*ends, view_margin=0)
        scale = getattr(axes, f"{name}axis")
        scale.set_major_locator(MaxNLocator(max(2, round(6 * extent[index] / extent.max()))))
        # labels stand off by a share of the other two sides
        stand_off = max(1.0, 0.9 * extent.max() / float(np.linalg.norm(np.delete(extent, index))))
        scale.set_tick_params(labelsize=7.5, pad=10 * stand_off - 8)
        scale.set_label_text(f"{name} [{unit}]")
        scale.labelpad = 25 * stand_off - 21
    right, above = _screen(axes)
    seen = max(np.abs(right) @ extent, np.abs(above) @ extent * 1.06) / np.linalg.norm(extent)
    axes.set_box_aspect(extent, zoom=fill / seen)


def _ends_colours(motion: Motion) -> tuple[str, str]:
    """The colours of links 1 and 3."""
    return (INPUT, OUTPUT) if motion.input == motion.linkage.joints[0].name else (OUTPUT, INPUT)


def _point_colours(frame: Skeleton) -> list[str]:
    return [POINT_COLOURS[i % len(POINT_COLOURS)] for i in range(len(frame.names) - frame.solid)]


Bars = list[tuple[Any, tuple[int, ...]]]


def bars(axes: Any, motion: Motion, frame: Skeleton, *, ghost: bool = False) -> Bars:
    """New artists for one pose, each with the places it joins: bars, balls, points; `put` moves them."""
    if isinstance(frame, Chain):
        return chain_bars(axes, motion.linkage, frame, (motion.input, motion.output), ghost=ghost)
    first, second = _ends_colours(motion)
    order, width = (3, 2.0) if ghost else (6, 5.0)
    look = {"alpha": 0.28 if ghost else 1.0, "zorder": order}
    made: Bars = []

    def add(places: tuple[int, ...], **style: Any) -> None:
        line = Line3D([], [], [], solid_capstyle="round", **look | style)
        axes.add_line(line)
        made.append((line, places))

    for places in frame.stays:
        add(places, color=COUPLER if places[::2] == LINK_ENDS[2] else GROUND, lw=width / 3)
    for link, colour in ((2, COUPLER), (1, first), (3, second)):
        outline = [] if ghost else [withStroke(linewidth=width + 1.6, foreground="#202020"), Normal()]
        add(LINK_ENDS[link], color=colour, lw=width, path_effects=outline)
    ball = {"ls": "", "marker": "o", "zorder": order + 1}
    size = 3.0 if ghost else 9.0
    add((A, B), **ball, color="#303030", ms=size)
    if not ghost:
        add((A, B), **ball, color="#f4f4f4", ms=size / 2.6)
    for place, colour in zip(range(4, len(frame.names)), _point_colours(frame), strict=True):
        add((place,), **ball, color=colour, ms=0.6 * size)
    return made


def chain_colours(linkage: Loop, ends: tuple[str, str]) -> tuple[list[str], list[str]]:
    """The colours of the moving links and of the joints, from the columns of input and output."""
    owner = {column: i for i, joint in enumerate(linkage.joints) for column in joint.columns}
    count = len(linkage.joints)
    links, joints = [COUPLER] * (count - 1), [JOINT] * count
    # the output first, so that the input wins a link that both move
    for column, colour in zip(ends[::-1], (OUTPUT, INPUT), strict=True):
        joint = owner[column]
        joints[joint] = colour
        links[min(joint, count - 2)] = colour
    return links, joints


def chain_bars(
    axes: Any,
    linkage: Loop,
    frame: Chain,
    ends: tuple[str, str],
    *,
    ghost: bool = False,
    scale: float = 1.0,
) -> Bars:
    """`bars` of any loop; `ends` are the columns of input and output, `scale` that of the widths."""
    colours, joint_colours = chain_colours(linkage, ends)
    order, width = (3, 1.5) if ghost else (6, 4.0 * scale)
    look = {"alpha": 0.25 if ghost else 1.0, "zorder": order, "solid_capstyle": "round"}
    made: Bars = []

    def add(places: tuple[int, ...], **style: Any) -> None:
        line = Line3D([], [], [], **look | style)
        axes.add_line(line)
        made.append((line, places))

    if not ghost:
        for stay in frame.stays:
            add(stay, color=COUPLER, lw=width / 3)
    for places, colour in zip(frame.links[:-1], colours, strict=True):
        outline = [] if ghost else [withStroke(linewidth=width + 1.4 * scale, foreground="#202020"), Normal()]
        add(places, color=colour, lw=width, path_effects=outline)
    if not ghost:
        for joint, word, joined in frame.marks:
            add(joined, **_mark(word, joint_colours[joint], scale), zorder=order + (word != "axis"))
    for place, colour in zip(frame.points, _point_colours(frame), strict=True):
        add((place,), ls="", marker="o", color=colour, ms=3.0 if ghost else 7.0 * scale, zorder=order + 2)
    return made


def _mark(word: str, colour: str, scale: float = 1.0) -> dict[str, Any]:
    """The look of a joint's mark."""
    outline = [withStroke(linewidth=9.6 * scale, foreground="#202020"), Normal()]
    return {
        "axis": {"color": "#404040", "lw": 0.9 * scale, "ls": (0, (7, 2, 1.5, 2))},
        "cylinder": {"color": colour, "lw": 8 * scale, "solid_capstyle": "butt", "path_effects": outline},
        "thread": {"color": "white", "lw": 7 * scale, "ls": (0, (0.22, 0.22)), "dash_capstyle": "butt"},
        "arm": {"color": colour, "lw": 5 * scale, "solid_capstyle": "butt"},
        "plate": {"color": colour, "lw": 1.6 * scale},
        "block": {"color": colour, "ls": "", "marker": "s", "ms": 9 * scale, "mec": "#202020", "mew": 0.8},
        "ball": {"color": "#f4f4f4", "ls": "", "marker": "o", "ms": 8 * scale, "mec": "#303030", "mew": 2.4},
    }[word]


def put(made: Bars, pose: Floats) -> None:
    """Moves the artists of `bars` to a pose, places (4 + k, 3)."""
    for artist, places in made:
        artist.set_data_3d(*pose[list(places)].T)


def label(axes: Any, frame: Skeleton, pose: Floats, places: Sequence[int]) -> None:
    """Writes the names of places of a pose, each on its freest side; what falls together shares one label."""
    screen = _screen(axes)
    seen = pose @ screen.T
    lines = frame.lines(pose, screen)
    named: dict[int, list[str]] = {}
    for i in (place for place in places if frame.names[place]):
        near = [k for k in named if np.linalg.norm(seen[k] - seen[i]) < 0.03 * frame.span]
        named.setdefault(near[0] if near else i, []).append(frame.names[i])
    turns = np.linspace(0, math.tau, 24, endpoint=False)
    for i, names in named.items():
        spots = seen[i] + 0.06 * frame.span * np.stack([np.cos(turns), np.sin(turns)], axis=1)
        best = turns[int(np.argmax([min(_distance(spot, line) for line in lines) for spot in spots]))]
        place = pose[i] + 0.045 * frame.span * np.array([math.cos(best), math.sin(best)]) @ screen
        side = "center" if abs(math.cos(best)) < 0.5 else "left" if math.cos(best) > 0 else "right"
        halo = [withStroke(linewidth=2.5, foreground="white")]
        axes.text(
            *place,
            ", ".join(dict.fromkeys(names)),
            fontsize=11,
            ha=side,
            va="center",
            zorder=9,
            path_effects=halo,
        )


def _screen(axes: Any) -> Floats:
    """The directions, unit vectors (2, 3), that are seen as right and up."""
    return _directions(axes.elev, axes.azim)


def _directions(elevation: float, azimuth: float) -> Floats:
    up, round_ = math.radians(elevation), math.radians(azimuth)
    above = [-math.sin(up) * math.cos(round_), -math.sin(up) * math.sin(round_), math.cos(up)]
    return np.array([[-math.sin(round_), math.cos(round_), 0.0], above])


def _distance(spot: Floats, line: Floats) -> float:
    along = line[1] - line[0]
    share = np.clip((spot - line[0]) @ along / ((along @ along) or 1.0), 0, 1)
    return float(np.linalg.norm(spot - line[0] - share * along))


def link_keys(motion: Motion, frame: Skeleton) -> list[Line2D]:
    """The legend's entries of a 3D view."""
    if isinstance(frame, Chain):
        paths = [
            Line2D([], [], color=colour, lw=1.4, label=f"path of {frame.names[place]}")
            for place, colour in zip(frame.points, _point_colours(frame), strict=True)
        ]
        inner = frame.places[:, list(frame.joints[1:-1])]
        if np.nanmax(np.ptp(inner[~np.isnan(inner).any(axis=(1, 2))], axis=0)) > 1e-6 * frame.span:
            paths.insert(0, Line2D([], [], color=PATH, lw=0.8, label="paths of the joints"))
        return [*chain_keys(motion.linkage, (motion.input, motion.output)), *paths]
    keys = [
        Line2D([], [], color=INPUT, lw=5, label=f"input: {short(motion.input, 24)}"),
        Line2D([], [], color=COUPLER, lw=5, label="coupler"),
        Line2D([], [], color=OUTPUT, lw=5, label=f"output: {short(motion.output, 24)}"),
        Line2D([], [], color=GROUND, lw=3, alpha=0.6, label="ground"),
    ]
    for place, colour in zip(frame.moving, (*_ends_colours(motion), *_point_colours(frame)), strict=True):
        keys.append(Line2D([], [], color=colour, lw=1.1, label=f"path of {frame.names[place]}"))
    return [*keys, Line2D([], [], color="#404040", lw=0.9, ls=(0, (7, 2, 1.5, 2)), label="joint axis")]


def chain_keys(linkage: Loop, ends: tuple[str, str]) -> list[Line2D]:
    """The legend's entries of any loop: its links and the kinds of its joints."""
    colours, _ = chain_colours(linkage, ends)
    names = [f"input: {short(ends[0], 24)}", f"output: {short(ends[1], 24)}"]
    keys = [Line2D([], [], color=c, lw=5, label=name) for c, name in zip((INPUT, OUTPUT), names, strict=True)]
    if COUPLER in colours:
        keys.append(Line2D([], [], color=COUPLER, lw=5, label="other moving links"))
    keys.append(Line2D([], [], color=GROUND, lw=4, alpha=0.6, label="ground"))
    for letter, kind in KINDS.items():
        if letter in linkage.kind:
            mark = kind.shape
            style = {
                "cylinder": {"marker": "s", "ms": 7},
                "thread": {"marker": "s", "ms": 6, "mfc": "white", "mew": 2.4},
                "plate": {"marker": "D", "ms": 7, "mfc": "white", "mew": 1.6},
            }
            look = style.get(mark) or ({"marker": "P", "ms": 8} if mark == "arm" else _mark(mark, JOINT))
            keys.append(Line2D([], [], **{"color": JOINT, "ls": ""} | look, label=kind.legend))
    return keys
