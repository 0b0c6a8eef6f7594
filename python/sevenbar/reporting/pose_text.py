"""One pose in words and plain values: joints with their rates, points, links, and what acts on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.forces.result import OPEN, Reaction
from sevenbar.kinematics.circuits.one_pose import OnePose
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.paths.circuit_path import NotFollowedError
from sevenbar.reporting.force_words import OPEN as OPEN_WORD
from sevenbar.reporting.force_words import ROUNDING
from sevenbar.reporting.shown import REST, Shown, degrees, drive_text, number, six_digits
from sevenbar.reporting.summary import Column, Sheet, wide_sheets
from sevenbar.text.printing import lines, text_of
from sevenbar.text.words import retold, say

#: Rates of a pose by their order.
RATES = ("position", "velocity", "acceleration")


def driven_text(linkage: Loop, pose: OnePose) -> str:
    """How the input moves in a pose: its speed, whose that is, and its acceleration."""
    unit = linkage.unit_of(pose.input)
    column = linkage.columns.index(pose.input)
    own = pose.speed == linkage.speed_of(column)
    written = linkage.speed_written(column) if own else ""
    text = drive_text(pose.input, pose.speed, unit, written=written)
    if own and "speed" in linkage.description.get("drive", {}):
        text = say("{driven}, the speed of the file", driven=text)
    if pose.acceleration:
        return say("{driven} and {value}", driven=text, value=f"{pose.acceleration:.6g} {unit}/s^2")
    return text


def stops_text(pose: OnePose) -> str:
    """Whether a pose lies beyond a stop, in words; empty of a linkage without stops."""
    if not pose._linkage.stops.stops:
        return ""
    try:
        names = pose.stopped_by
    except NotFollowedError:
        return say("not known")
    beyond = say(", ").join(retold(name) for name in names.split(", "))
    return say("beyond {stops}", stops=beyond) if names else say("within")


def settled(linkage: Loop, pose: OnePose, values: Floats, order: int, *, length: bool) -> Floats:
    """Rates of an order, of an angle or a `length`, without what is rounding of the input's own."""
    own = 1.0 if linkage.turns(pose.input) else linkage.size
    quick = abs(pose.speed) / own + math.sqrt(abs(pose.acceleration) / own)
    natural = (linkage.size if length else 1.0) * quick**order
    return np.where(np.abs(values) < REST * natural, 0.0, values)


def joint_rates(linkage: Loop, pose: OnePose, order: int) -> Floats:
    """The velocities (order 1) or accelerations (2) of all columns (columns,)."""
    values = (pose.q, pose.dq, pose.ddq)[order]
    return np.array(
        [
            settled(linkage, pose, value, order, length=not turns)
            for value, turns in zip(values, linkage.turning, strict=True)
        ]
    )


def pose_dict(pose: OnePose) -> dict[str, Any]:
    """A pose as plain values: radians, the linkage's length unit, seconds; null without a value."""
    return {
        "circuit": pose.circuit,
        "branch": pose.branch,
        "rates": pose.status,
        "velocity": pose.dq.tolist(),
        "acceleration": pose.ddq.tolist(),
        "transmission": pose.transmission_angle,
        "mechanical_advantage": pose.mechanical_advantage,
        **stops_dict(pose),
        "points": {
            name: {word: getattr(trace, word)[0].tolist() for word in RATES}
            for name, trace in pose.points.items()
        },
        "links": {
            str(link): {
                "angular_velocity": own.velocity[0].tolist(),
                "angular_acceleration": own.acceleration[0].tolist(),
            }
            for link, own in pose.links.items()
        },
    }


def stops_dict(pose: OnePose) -> dict[str, Any]:
    """The stops that a pose lies beyond, of a linkage with stops: a list of names; null if not known."""
    if not pose._linkage.stops.stops:
        return {}
    try:
        names = pose.stopped_by
    except NotFollowedError:
        return {"stopped_by": None}
    return {"stopped_by": names.split(", ") if names else []}


def rates_sheets(linkage: Loop, poses: Sequence[tuple[str, OnePose | None]], room: int) -> list[Sheet]:
    """The rates of some poses, each by its number: joints, points, links, transmission."""
    known = [(name, pose) for name, pose in poses if pose is not None]
    first = [name for name, _ in known]
    sheets = []
    for order, end in ((1, "/s"), (2, "/s²")):
        rates = np.array([joint_rates(linkage, pose, order) for _, pose in known])
        columns = [
            (f"{column.name}\n[{column.unit}{end}]", [_cell(x) for x in own])
            for column, own in zip(linkage.each_column, rates.T, strict=True)
        ]
        sheets += wide_sheets([(say("mode"), first)], columns, room)
    sheets += _vectors(linkage, known, room)
    head = [(say("mode"), first), (say("circuit"), [f"{pose.circuit}" for _, pose in known])]
    columns = [(say("pass"), [f"{pose.branch}" for _, pose in known])]
    angles = [pose.transmission_angle for _, pose in known]
    if any(angle is not None for angle in angles):
        columns.append((say("transmission\n[deg]"), [_angle(angle) for angle in angles]))
    columns.append((say("mechanical\nadvantage"), [_cell(pose.mechanical_advantage) for _, pose in known]))
    columns.append((say("rates"), [say(pose.status) for _, pose in known]))
    if linkage.stops.stops:
        columns.append((say("stops"), [stops_text(pose) for _, pose in known]))
    return sheets + wide_sheets(head, columns, room)


def _vectors(linkage: Loop, known: Sequence[tuple[str, OnePose]], room: int) -> list[Sheet]:
    """Places and rates of the named points, then how the links turn, along x, y and z."""
    unit = linkage.length_unit
    sheets = []
    points = [(mode, pose, point.name) for mode, pose in known for point in linkage.points]
    if points:
        first = [(say("mode"), [mode for mode, *_ in points]), (say("point"), [name for *_, name in points])]
        selected: list[Column] = []
        for order, (mark, end) in enumerate((("", ""), ("v", "/s"), ("a", "/s²"))):
            rows = np.array(
                [
                    settled(linkage, pose, getattr(pose.points[name], RATES[order])[0], order, length=True)
                    for _, pose, name in points
                ]
            )
            columns = [
                (f"{mark}{axis}\n[{unit}{end}]", [_cell(x) for x in own])
                for axis, own in zip("xyz", rows.T, strict=True)
            ]
            # places and velocities in one table
            selected = [*selected, *columns]
            if order:
                sheets += wide_sheets(first, selected, room)
                selected = []
    links = [(mode, pose, link) for mode, pose in known for link in pose.links]
    first = [
        (say("mode"), [mode for mode, *_ in links]),
        (say("link"), [linkage.link_label(link) for *_, link in links]),
    ]
    columns = []
    for order, (mark, end) in enumerate((("ω", "rad/s"), ("α", "rad/s²")), start=1):
        rows = np.array(
            [
                settled(linkage, pose, getattr(pose.links[link], RATES[order])[0], order, length=False)
                for _, pose, link in links
            ]
        )
        columns += [
            (f"{mark}{axis}\n[{end}]", [_cell(x) for x in own])
            for axis, own in zip("xyz", rows.T, strict=True)
        ]
    return sheets + wide_sheets(first, columns, room)


def _cell(value: float) -> str:
    return f"{value + 0.0:.6g}" if not math.isnan(value) else "-"


def _angle(angle: float | None) -> str:
    return "-" if angle is None or math.isnan(angle) else f"{math.degrees(angle):.3f}"


def in_report(reaction: Reaction, word: str) -> Floats:
    """The force or moment (3,) of a reaction of one row along x, y, z of the report frame; NaN if open.

    A component is known where the open ones of the joint's own frame have no part in it.
    """
    first = 3 if word == "force" else 0
    known = reaction.determinate[first : first + 3]
    axes, own = reaction.axes[0], getattr(reaction, word)[0]
    result = axes[:, known] @ own[known]
    return np.where(np.abs(axes[:, ~known]).max(axis=1, initial=0.0) > OPEN, np.nan, result)


def reaction_rows(reactions: Sequence[Reaction]) -> tuple[list[str], list[list[str]]]:
    """A table of what each joint bears in one pose, along the axes of the report frame."""
    head = [say("joint"), say("force\n[N]"), *(f"F{x}\n[N]" for x in "xyz"), *(f"M{x}\n[N m]" for x in "xyz")]
    both = [[in_report(one, word) for one in reactions] for word in ("force", "moment")]
    most = [float(np.nanmax(np.abs(values), initial=0.0)) for values in both]

    def cell(value: float, scale: float) -> str:
        if math.isnan(value):
            return say(OPEN_WORD)
        return number(0.0 if abs(value) < ROUNDING * scale else value)

    rows = []
    for one, force, moment in zip(reactions, *both, strict=True):
        known = force[np.isfinite(force)]
        size = float(np.linalg.norm(known)) if known.size else math.nan
        cells = [cell(size, most[0]), *(cell(x, most[0]) for x in force), *(cell(x, most[1]) for x in moment)]
        rows.append([one.joint, *cells])
    return head, rows


@text_of.register(OnePose)
def _(pose: OnePose) -> str:
    linkage = pose._linkage

    def shown(values: Floats, end: str) -> str:
        each = zip(linkage.each_column, values, strict=True)
        return ", ".join(f"{column.name} {six_digits(x + 0.0)} {column.unit}{end}" for column, x in each)

    def vector(values: Floats) -> str:
        return f"({', '.join(six_digits(x + 0.0) for x in values)})"

    value = Shown(linkage.unit_of(pose.input))(pose[pose.input])
    facts = [
        ("driven", driven_text(linkage, pose)),
        ("rates", "" if pose.status == "ok" else pose.status),
        ("stops", stops_text(pose)),
        (
            "joints",
            ", ".join(
                f"{column.name} {Shown(column.unit)(x)}"
                for column, x in zip(linkage.each_column, pose.q, strict=True)
            ),
        ),
        ("velocity", shown(joint_rates(linkage, pose, 1), "/s")),
        ("acceleration", shown(joint_rates(linkage, pose, 2), "/s^2")),
    ]
    for name, trace in pose.points.items():
        own = [
            settled(linkage, pose, getattr(trace, word)[0], order, length=True)
            for order, word in enumerate(RATES)
        ]
        unit = linkage.length_unit
        text = f"at {vector(own[0])} {unit}, velocity {vector(own[1])} {unit}/s"
        facts.append((name, f"{text}, acceleration {vector(own[2])} {unit}/s^2"))
    for link, turning in pose.links.items():
        spin, rate = (
            settled(linkage, pose, values[0], order, length=False)
            for order, values in ((1, turning.velocity), (2, turning.acceleration))
        )
        text = f"angular velocity {vector(spin)} rad/s, acceleration {vector(rate)} rad/s^2"
        facts.append((f"link {link}", text))
    if pose.transmission_angle is not None:
        facts.append(("transmission", degrees(pose.transmission_angle)))
    facts.append(("advantage", six_digits(pose.mechanical_advantage)))
    facts += [("idle freedom", f"{'; '.join(pose.idle)}, held by convention")] * bool(pose.idle)
    forces = pose.forces()
    if forces is not None:
        facts.append(
            (f"input {'force' if forces.slides else 'torque'}", f"{number(forces.torque[0])} {forces.unit}")
        )
        _, rows = reaction_rows(list(forces.reactions.values()))
        facts += [(row[0], f"force {row[1]} N: ({', '.join(row[2:5])})") for row in rows]
    return lines(f"Pose of '{linkage.heading}' at {pose.input} = {value}, on circuit {pose.circuit}", facts)
