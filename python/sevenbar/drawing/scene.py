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
from sevenbar.drawing.skeleton import Skeleton, short
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.joints import KINDS
from sevenbar.kinematics.rigid import perpendicular, unit

#: Colours of Okabe and Ito, told apart by colour-blind readers too.
INPUT, OUTPUT, COUPLER, GROUND = "#0072B2", "#D55E00", "#009E73", "#808080"


JOINT, PATH = "#9a9a9a", "#b5c7bd"


POINT_COLOURS = ("#CC79A7", "#E69F00", "#56B4E9", "#000000")


#: The thinnest side of the drawn box, as a share of its longest.
THINNEST_BOX = 0.4
#: A path shorter than this share of the linkage's extent is none.
SAME = 1e-6


def stage(
    axes: Any,
    frame: Skeleton,
    ends: tuple[str, str],
    *,
    around: Skeleton | None = None,
    fill: float = 0.74,
) -> None:
    """Draws into 3D axes what stands still, the paths and the ground, and sets the view.

    `ends` are the columns of input and output. The view shows all places of `around`, of the frame itself
    where none is given.
    """
    whole = around or frame
    feet = _feet(whole)
    places = [whole.places.reshape(-1, 3), *(plate for plate, _ in feet)]
    prepare_view(axes, np.concatenate(places), frame.linkage.length_unit, fill)
    if len(frame.places) > 1:
        for place, colour in paths(frame, ends):
            look = {"lw": 0.8, "zorder": 1} if colour == PATH else {"lw": 1.2, "alpha": 0.85, "zorder": 2}
            axes.plot(*frame.places[:, place].T, color=colour, **look)
    ground = frame.pose(0)[list(frame.links[-1])]
    axes.plot(*ground.T, color=GROUND, lw=4, alpha=0.6, zorder=2, solid_capstyle="round")
    for plate, (stem, *strokes) in feet:
        face = Poly3DCollection([plate], facecolors="#e4e4e4", edgecolors=GROUND, lw=0.8, zorder=3)
        axes.add_collection3d(face)
        for line in strokes:
            axes.plot(*line.T, color=GROUND, lw=0.8, zorder=3)
        axes.plot(*stem.T, color=GROUND, lw=2.2, zorder=3)


def _feet(frame: Skeleton) -> list[tuple[Floats, list[Floats]]]:
    """The ground where an axis stands still: plates (4, 3) on the far side, or below; stems and hatches."""
    pose, size = frame.pose(0), 0.05 * frame.span
    feet = []
    for joint, place in ((0, frame.links[-1][-1]), (len(frame.joints) - 1, frame.links[-1][0])):
        axes = [ends for i, word, ends in frame.marks if i == joint and word in ("cylinder", "arm")]
        if not axes:
            continue
        start, end = pose[list(axes[-1 if joint else 0])]
        centre, side = pose[place], unit(end - start)
        away = float(side @ (centre - np.nanmean(frame.places, axis=(0, 1))))
        side = side * math.copysign(1.0, away if abs(away) > 0.1 * frame.span else -side[2] or 1.0)
        u, foot = perpendicular(side), centre + 1.7 * size * side
        v = np.cross(side, u)
        plate = foot + size * np.stack([-u - v, u - v, u + v, v - u])
        # strokes at 45 degrees behind the plate's edge
        strokes = [np.stack([p * u - v, (p + 0.4) * u - v + 0.4 * side]) for p in np.linspace(-1, 0.6, 6)]
        feet.append((plate, [np.stack([centre, foot]), *(foot + size * line for line in strokes)]))
    return feet


def paths(frame: Skeleton, ends: tuple[str, str]) -> list[tuple[int, str]]:
    """The places whose paths are drawn, and the colour of each: named points, then joints that carry none.

    The far ends of the first and the last moving link have their link's colour where it is that of input or
    output, all other joints a pale one.
    """
    colours = link_colours(frame.linkage, ends)[0]
    found = [(place, POINT_COLOURS[i % len(POINT_COLOURS)]) for i, place in enumerate(frame.points)]
    runs = {0: colours[0], len(frame.inner) - 1: colours[-1]}
    for i, place in enumerate(frame.inner):
        apart = np.abs(frame.places[:, list(frame.points)] - frame.places[:, [place]])
        if not (np.nanmax(apart, axis=(0, 2)) < SAME * frame.span).any():
            found.append((place, PATH if runs.get(i, COUPLER) == COUPLER else runs[i]))
    return found


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
    return _wide_view(frame.places.reshape(-1, 3))


def _wide_view(places: Floats) -> tuple[float, float]:
    """Elevation and azimuth [deg] from which places (n, 3) cover the most."""
    azimuths = (np.arange(-180.0, 180.0, 90.0)[:, None] + [25.0, 45.0, 65.0]).ravel()
    elevation, azimuth = (grid.ravel() for grid in np.meshgrid([20.0, 30.0, 45.0], azimuths))
    kept = places[~np.isnan(places).any(axis=1)]
    spread = (kept - kept.mean(axis=0)).T @ (kept - kept.mean(axis=0))
    screens = [directions(*view) for view in zip(elevation, azimuth, strict=True)]
    covered = np.array([np.sqrt(max(np.linalg.det(s @ spread @ s.T), 0.0)) for s in screens])
    # among like views the usual one, x to the right and y away
    unusual = (1 - np.cos(np.radians(azimuth + 60.0))) / 2 + np.abs(elevation - 30.0) / 100
    best = int(np.argmax(covered / (covered.max() or 1.0) - 0.3 * unusual))
    return float(elevation[best]), float(azimuth[best])


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
    right, above = directions(axes.elev, axes.azim)
    seen = max(np.abs(right) @ extent, np.abs(above) @ extent * 1.06) / np.linalg.norm(extent)
    axes.set_box_aspect(extent, zoom=fill / seen)


Bars = list[tuple[Any, tuple[int, ...]]]


def link_colours(linkage: Loop, ends: tuple[str, str]) -> tuple[list[str], list[str]]:
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


def bars(
    axes: Any,
    frame: Skeleton,
    ends: tuple[str, str],
    *,
    ghost: bool = False,
    scale: float = 1.0,
) -> Bars:
    """New artists for one pose, each with the places it joins: links, joints, points; `put` moves them.

    `ends` are the columns of input and output, `scale` is that of the widths.
    """
    colours, joint_colours = link_colours(frame.linkage, ends)
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
    for place, colour in paths(frame, ends)[: len(frame.points)]:
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
    screen = directions(axes.elev, axes.azim)
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


def directions(elevation: float, azimuth: float) -> Floats:
    """The directions, unit vectors (2, 3), seen as right and up from an elevation and an azimuth [deg]."""
    up, round_ = math.radians(elevation), math.radians(azimuth)
    above = [-math.sin(up) * math.cos(round_), -math.sin(up) * math.sin(round_), math.cos(up)]
    return np.array([[-math.sin(round_), math.cos(round_), 0.0], above])


def _distance(spot: Floats, line: Floats) -> float:
    along = line[1] - line[0]
    share = np.clip((spot - line[0]) @ along / ((along @ along) or 1.0), 0, 1)
    return float(np.linalg.norm(spot - line[0] - share * along))


def keys(frame: Skeleton, ends: tuple[str, str]) -> list[Line2D]:
    """The legend's entries: the links, the kinds of joints, and the paths where there are several poses."""
    colours, _ = link_colours(frame.linkage, ends)
    links = [(INPUT, f"input: {short(ends[0], 24)}"), (OUTPUT, f"output: {short(ends[1], 24)}")]
    if COUPLER in colours:
        links.append((COUPLER, "coupler" if colours.count(COUPLER) == 1 else "other moving links"))
    found = [Line2D([], [], color=colour, lw=5, label=name) for colour, name in links]
    found.append(Line2D([], [], color=GROUND, lw=4, alpha=0.6, label="ground"))
    for letter, kind in KINDS.items():
        if letter in frame.linkage.kind:
            mark = kind.shape
            style = {
                "cylinder": {"marker": "s", "ms": 7},
                "thread": {"marker": "s", "ms": 6, "mfc": "white", "mew": 2.4},
                "plate": {"marker": "D", "ms": 7, "mfc": "white", "mew": 1.6},
            }
            look = style.get(mark) or ({"marker": "P", "ms": 8} if mark == "arm" else _mark(mark, JOINT))
            found.append(Line2D([], [], **{"color": JOINT, "ls": ""} | look, label=kind.legend))
    names = {}
    for place, colour in paths(frame, ends) if len(frame.places) > 1 else ():
        line = frame.places[:, place]
        extent = np.ptp(line[~np.isnan(line).any(axis=1)], axis=0).max()
        if place in frame.points or extent > SAME * frame.span:
            name = "paths of the joints" if colour == PATH else f"path of {frame.names[place]}"
            names[name] = Line2D([], [], color=colour, lw=0.8 if colour == PATH else 1.4, label=name)
    return found + list(names.values())
