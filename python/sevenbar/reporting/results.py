"""What linkages, modes, motions, circuits and traces print of themselves, and their pictures in notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

import sevenbar.reporting.pose_text  # noqa: F401  what a pose prints
from sevenbar.arrays import Floats, Words
from sevenbar.errors import check_word
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes, Sensitivity, Trace
from sevenbar.kinematics.circuits.instant_centres import InstantCentre, InstantCentres
from sevenbar.kinematics.circuits.modes import Modes, Output
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.screw_axes import ScrewAxes
from sevenbar.reporting.circuit_quantities import way_round
from sevenbar.reporting.facts import (
    closure_text,
    completeness_text,
    dimensions_text,
    facts_of,
    joints_text,
)
from sevenbar.reporting.shown import Shown, drive_text, rows_text, turned
from sevenbar.reporting.summary import circuit_facts
from sevenbar.text.printing import figure_of, lines, picture_of, text_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Facts of a report that a motion prints, by their names there; the others are its linkage's.
OF_MOTION = (
    *("drive", "law", "motion type", "circuits", "input limits", "change point", "isolated pose"),
    *("completeness", "idle freedom", "redundant", "closure error"),
)

#: Functions of `sevenbar.plot` that draw a motion.
OF_A_MOTION = ("curves", "configuration", "joints")

#: Circuits of a motion that are printed one by one.
MOST_CIRCUITS = 8

#: Size of a picture [inch].
SIZE = (4.6, 2.8)


@text_of.register(Linkage)
def _(linkage: Linkage) -> str:
    drive = linkage.drive
    facts = [
        ("loop" if linkage.net is None else "joints", joints_text(linkage)),
        ("dimensions", dimensions_text(linkage) or _rows(linkage)),
        ("drive", drive_text(drive.joint, drive.speed, linkage.unit_of(drive.joint), drive.output)),
        ("points", ", ".join(f"{point.name} on {linkage.link_name(point.link)}" for point in linkage.points)),
        ("length unit", linkage.length_unit),
    ]
    return lines(f"Linkage '{linkage.heading}'", facts)


def _rows(linkage: Linkage) -> str:
    """Denavit-Hartenberg rows: which numbers there are of each link."""
    words = dict.fromkeys(name.partition("_")[0] for name in linkage.dimensions)
    return f"{' '.join(words)} of {linkage.graph.ground} links" if words else ""


@text_of.register(Modes)
def _(modes: Modes) -> str:
    count = len(modes)
    worst = f"at most {modes.residual.max():.1e}" if count else ""
    facts = [
        ("q", f"{modes.q.shape}: {', '.join(modes.columns)}"),
        ("status", rows_text(modes.status)),
        ("residual", worst),
        ("completeness", completeness_text(modes.completeness, curve=modes.on_curve is not None)),
    ]
    return lines(f"{count} assembly mode{'s' * (count != 1)} at input {modes.input:.6g}", facts)


@text_of.register(Motion)
def _(motion: Motion) -> str:
    facts: list[tuple[str, str]] = []
    selected = False
    for label, text in facts_of(motion):
        # a line without a name goes on with the one above
        selected = label in OF_MOTION if label else selected
        # whether a four-bar can be put together at all is seen by its sum of links
        selected = selected or (label == "Grashof" and not motion.circuits)
        if selected:
            facts.append((label, text))
        if label == "circuits":
            facts += _circuits(motion)
    return lines(f"Motion of '{motion.linkage.heading}'", facts)


def _circuits(motion: Motion) -> list[tuple[str, str]]:
    """A line for each circuit: its type where they differ, its ranges; one line where all agree."""
    rows = []
    for circuit in motion.circuits[:MOST_CIRCUITS]:
        facts = circuit_facts(motion, circuit, brief=True)
        texts = (
            text if label == "motion type" else f"{label.removeprefix('range of ')} {text}"
            for label, text in facts
        )
        rows.append((f"  {circuit.index}", ", ".join(texts)))
    if len({text for _, text in rows}) == 1:
        return [("", rows[0][1])]
    more = len(motion.circuits) - len(rows)
    return rows + [("", f"and {more} more")] * (more > 0)


@text_of.register(Circuit)
def _(circuit: Circuit) -> str:
    place, result = (Shown("rad" if turns else "") for turns in (circuit.input_turns, circuit.output_turns))

    def extent(ends: tuple[float, float] | None, show: Shown, *, as_limits: bool = False) -> str:
        if ends is None:
            return "full turns"
        if circuit.output_turns and not as_limits:
            turn = turned(*ends)
            ends = ends[0] + turn, ends[1] + turn
        return " to ".join(show.range(*ends) if as_limits else map(show, ends))

    def still(kind: str) -> str:
        places = [place(d.input, whole=True) for d in circuit.dead_centres if d.kind == kind]
        return ", ".join(places[:MOST_CIRCUITS]) + (" .." if len(places) > MOST_CIRCUITS else "")

    def range_of(extremes: Extremes | None, show: Shown | None = None) -> str:
        if extremes is None:
            return ""
        low, high = (show(x) if show else f"{x:.6g}" for x in (extremes.lowest, extremes.highest))
        return f"{low} to {high}"

    # as far as it has been found: to print is not to solve
    transmission: Extremes | None = vars(circuit).get("transmission", circuit._transmission)
    return lines(
        f"Circuit {circuit.index}: {circuit.motion_type}, {way_round(circuit)}",
        [
            ("rows", f"{len(circuit.time)}: {rows_text(circuit.status)}"),
            ("columns", ", ".join(circuit.columns)),
            (circuit.columns[circuit.input_column], extent(circuit.input_range, place, as_limits=True)),
            (circuit.columns[circuit.output_column], extent(circuit.output_range, result)),
            ("input dead centres", still("input")),
            ("output dead centres", still("output")),
            ("time ratio", _time_ratio(circuit)),
            ("transmission angle", range_of(transmission, Shown("rad"))),
            ("velocity", range_of(circuit.velocity)),
            ("acceleration", range_of(circuit.acceleration)),
            ("closure error", closure_text([circuit]).rstrip()),
        ],
    )


def _time_ratio(circuit: Circuit) -> str:
    if circuit.many_strokes:
        return "not defined: more than two strokes"
    return "" if circuit.time_ratio is None else f"{circuit.time_ratio:.6g}"


def _of_rows(head: str, status: Words, quantities: Iterable[tuple[str, Floats]]) -> str:
    """A head, how many rows have each status, and from where to where each quantity goes."""
    extents = ((name, _extent(values)) for name, values in quantities)
    return lines(head, [("status", rows_text(status)), *extents])


def _extent(values: Floats) -> str:
    known = values[np.isfinite(values)]
    return f"{known.min() + 0.0:.6g} to {known.max() + 0.0:.6g}" if known.size else "no value"


@text_of.register(Trace)
def _(trace: Trace) -> str:
    rates = (("speed", trace.velocity), ("acceleration", trace.acceleration))
    sizes = ((name, np.linalg.norm(values, axis=1)) for name, values in rates)
    places = zip("xyz", trace.position.T, strict=True)
    return _of_rows(f"Trace of a point: {len(trace.position)} rows", trace.status, (*places, *sizes))


@text_of.register(ScrewAxes)
def _(axes: ScrewAxes) -> str:
    head = f"Screw axes of link {axes.link} against link {axes.relative_to}: {len(axes.status)} rows"
    result = (("pitch", axes.pitch), ("rate", axes.rate), ("slide rate", axes.slide_rate))
    return _of_rows(head, axes.status, result)


@text_of.register(InstantCentre)
def _(centre: InstantCentre) -> str:
    first, second = centre.links
    head = f"Instant centre of links {first} and {second}: {len(centre.status)} rows"
    return _of_rows(head, centre.status, zip("xy", centre.in_plane.T, strict=True))


@text_of.register(InstantCentres)
def _(result: InstantCentres) -> str:
    facts = [(f"{a}-{b}", rows_text(centre.status)) for (a, b), centre in result.centres.items()]
    return lines(f"{len(result)} instant centres", facts)


@text_of.register(Sensitivity)
def _(result: Sensitivity) -> str:
    rows, columns, numbers = result.position.shape
    # each number by what it moves most, its unit and the greatest derivative; 0 where none is known
    sizes = np.nan_to_num(np.abs(result.position)).max(axis=0, initial=0.0)
    moved = [result.columns[place] for place in sizes.argmax(axis=0)]
    most = [
        f"{name} [{unit}]: " + (f"{column} {value:.3g}" if value else "moves nothing")
        for name, unit, column, value in zip(
            result.names, result.units, moved, sizes.max(axis=0).tolist(), strict=True
        )
    ]
    facts = [
        ("status", rows_text(result.status)),
        ("greatest", "; ".join(most[:MOST_CIRCUITS]) + (" .." if len(most) > MOST_CIRCUITS else "")),
        ("points", ", ".join(result.points)),
        ("opening", ", ".join(result.opening)),
    ]
    return lines(f"Sensitivity of {columns} columns by {numbers} numbers: {rows} rows", facts)


@text_of.register(Output)
def _(output: Output) -> str:
    head = f"Output of both branches at {output.position.shape[1]} inputs"
    names = ("position", "velocity", "acceleration", "jerk")
    result = [(name, getattr(output, name)) for name in names if getattr(output, name) is not None]
    return _of_rows(head, output.status.ravel(), result)


@figure_of.register(Linkage)
def _(linkage: Linkage, *, kind: str = "configuration", **options: Any) -> Figure:
    # curves and joints are of a motion: that over the whole range
    if kind == "modes_overview":
        from sevenbar.drawing.plot import modes_overview

        return modes_overview(linkage, linkage.assembly_modes(0.0), **options)
    return _figure(linkage.motion(), kind, options)


@figure_of.register(Motion)
def _(motion: Motion, *, kind: str = "curves", **options: Any) -> Figure:
    return _figure(motion, kind, options)


def _figure(motion: Motion, kind: str, options: dict[str, Any]) -> Figure:
    """The figure of a motion that a function of `sevenbar.plot` draws."""
    from sevenbar.drawing import plot

    check_word("kind", kind, OF_A_MOTION, "a figure of a motion")
    figure: Figure = getattr(plot, kind)(motion, **options)
    return figure


def _axes() -> tuple[Figure, Axes]:
    from sevenbar.drawing.figure import new_figure

    figure = new_figure(*SIZE)
    figure.set_layout_engine("constrained")
    return figure, figure.add_subplot()


@picture_of.register(Linkage)
def _(linkage: Linkage) -> Figure | None:
    from sevenbar.drawing.configuration import modes_overview

    # only what closes at once: a loop with screws is searched for its modes
    if "H" in linkage.kind:
        return None
    modes = linkage.assembly_modes(0.0)
    if not len(modes):
        return None
    figure = modes_overview(linkage, replace(modes, q=modes.q[:1], residual=modes.residual[:1]))
    figure.suptitle("")
    figure.axes[0].set_title(f"{linkage.drive.joint} at 0, one of {len(modes)}", fontsize=10)
    return figure


@picture_of.register(Motion)
def _(motion: Motion) -> Figure | None:
    from sevenbar.drawing.output_curves import panel, passes

    if not motion.circuits:
        return None
    figure, axes = _axes()
    panel(axes, motion, passes(motion), "angle", "input")
    return figure


@picture_of.register(Circuit)
def _(circuit: Circuit) -> Figure:
    figure, axes = _axes()
    across = np.degrees(circuit.input) if circuit.input_turns else circuit.input
    axes.plot(across, np.degrees(circuit.output) if circuit.output_turns else circuit.output)
    axes.set_xlabel(circuit.columns[circuit.input_column] + " [deg]" * circuit.input_turns)
    axes.set_ylabel(circuit.columns[circuit.output_column] + " [deg]" * circuit.output_turns)
    return figure


@picture_of.register(Trace)
def _(trace: Trace) -> Figure:
    figure, axes = _axes()
    for axis, values in zip("xyz", trace.position.T, strict=True):
        axes.plot(values, label=axis)
    axes.set_xlabel("row")
    axes.legend(frameon=False)
    return figure
