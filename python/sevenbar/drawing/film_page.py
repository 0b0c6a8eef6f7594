"""A film as one HTML page that needs nothing else: the linkage on a canvas, its curves with a cursor each."""

from __future__ import annotations

import json
import re
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import column_label
from sevenbar.drawing.names import named_together
from sevenbar.drawing.output_curves import curves_of
from sevenbar.drawing.scene import SAME, link_colours, paths, stays
from sevenbar.drawing.skeleton import Skeleton
from sevenbar.drawing.style import GROUND, PATH, ROD, circuit_colour
from sevenbar.drawing.view import Projection
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.poses import walk
from sevenbar.text.words import say, spoken

#: Digits that places [share of the extent] and values keep.
DIGITS = 5

#: A place of the page where text is put.
PLACE = re.compile("@(LANGUAGE|PAUSE|TITLE|HEADING|FILM)@")

#: Letters that HTML reads as more than text; within JSON, which is ASCII, they stand in strings alone.
OF_MARKUP = "<>&"


def film_page(
    motion: Motion,
    circuit: Circuit,
    frame: Skeleton,
    view: Projection,
    rows: Floats,
    times: Floats,
    *,
    fps: float,
    title: str,
) -> str:
    """The HTML of a film: a picture at each of `rows` (n,) of the walk with its time [s], at `fps` [1/s]."""
    result = _script_value(
        {
            "fps": fps,
            "linkage": _linkage(motion, frame, view, rows),
            "curves": _curves(motion, circuit, rows),
            "reading": _plain(times),
            "words": {
                "play": say("Play"),
                "pause": say("Pause"),
                "cut": say("{quantity}, cut at dead centres"),
            },
        }
    )
    heading = escape(title or motion.linkage.heading).replace("\n", "<br>")
    page = files("sevenbar.drawing").joinpath("film.html").read_text(encoding="utf-8")
    put = {
        "LANGUAGE": spoken(),
        "PAUSE": say("Pause"),
        "TITLE": escape(motion.linkage.heading),
        "HEADING": heading,
        "FILM": result,
    }
    # in one pass: what is put in is never read for places again, whatever a name holds
    return PLACE.sub(lambda place: put[place[1]], page)


def _script_value(value: Any) -> str:
    """A value as JSON that neither ends a script nor opens another within it."""
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return text.translate({ord(letter): f"\\u{ord(letter):04x}" for letter in OF_MARKUP})


def _linkage(motion: Motion, frame: Skeleton, view: Projection, rows: Floats) -> dict[str, Any]:
    """What is drawn of the linkage: places in each picture as shares of the extent, and what joins them."""
    ends = motion.input, motion.output
    shown = frame.places[:, frame.shown].reshape(-1, 3)
    shown = shown[np.isfinite(shown).all(axis=1)]
    centre, size = (shown.min(axis=0) + shown.max(axis=0)) / 2, frame.span or 1.0
    poses = np.stack([frame.pose(float(row)) for row in rows])
    links, joints = link_colours(frame.linkage, ends)
    riding = {joint for joint, word, _ in frame.marks if word == "rail"}
    hidden = {"axis"} if view.planar else set()
    marks = [
        {"joint": joint, "word": word, "at": list(places), "colour": joints[joint]}
        for joint, word, places in frame.marks
        if word not in hidden and not (word == "axis" and joint in riding)
    ]
    traces = [
        {"colour": colour, "thin": colour == PATH, "at": _plain((frame.places[:, place] - centre) / size)}
        for place, colour in paths(frame, ends)
        if place not in frame.far and np.nanmax(np.ptp(frame.places[:, place], axis=0)) > SAME * size
    ]
    points = [
        {"at": place, "colour": colour}
        for place, colour in paths(frame, ends)
        if place in frame.points and place not in frame.far
    ]
    named = named_together(frame.names, frame.places, SAME * frame.span, frame.far)
    sphere = frame.sphere
    return {
        "poses": _plain((poses - centre) / size),
        "links": [
            {"at": list(places), "colour": colour}
            for places, colour in zip(
                # the ground is the last
                (*frame.rods, *frame.polylines),
                [*(ROD for _ in frame.rods), *links, GROUND],
                strict=True,
            )
        ],
        "marks": marks,
        "stays": [{"at": list(stay), "colour": colour} for stay, colour in stays(frame, ends)],
        "points": points,
        "names": [{"at": place, "text": ", ".join(names)} for place, names in named.items()],
        "paths": traces,
        "joints": list(frame.joints),
        "sphere": None
        if sphere is None
        else {"at": _plain((sphere.centre - centre) / size), "radius": round(sphere.radius / size, DIGITS)},
        "view": _plain(np.vstack([view.screen, view.towards])),
        "flat": view.flat,
    }


def _curves(motion: Motion, circuit: Circuit, rows: Floats) -> list[dict[str, Any]]:
    """The output's curves over the input, and where the film is on them in each picture."""
    count = np.arange(len(walk(circuit).time))
    return [
        {
            "name": curve.quantity.label(),
            "lines": [
                {"x": _plain(curve.input[part]), "y": _plain(curve.values[part])} for part in curve.passes
            ],
            "turns": curve.quantity.unit == "deg",
            "across": column_label(motion, motion.input),
            "acrossTurns": bool(circuit.input_turns),
            "x": _plain(np.interp(rows, count, curve.input)),
            "y": _plain(np.interp(rows, count, curve.values)),
            "colour": circuit_colour(circuit.index),
            "cut": curve.cut,
        }
        for curve in curves_of(motion, circuit).values()
    ]


def _plain(values: Floats) -> Any:
    """Values as lists, rounded; null for those that are none."""
    if values.ndim > 1:
        return [_plain(part) for part in values]
    # significant digits, as small rates count, too
    return [float(f"{value:.7g}") if np.isfinite(value) else None for value in values.tolist()]
