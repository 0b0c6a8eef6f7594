"""The studio's curves: one quantity of a motion as a picture, and the cursor that is laid over it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.figure import input_label, shown_value
from sevenbar.drawing.output_curves import inputs_between
from sevenbar.drawing.quantities import LARGEST, Over, Quantity, QuantityCurve, Span, curve_of
from sevenbar.drawing.style import circuit_colour
from sevenbar.drawing.ticks import FLAT
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.ranges.reach import within
from sevenbar.studio.state.view import View
from sevenbar.studio.svg import picture
from sevenbar.studio.svg.scale import Scale, scale

#: Circuits in the background are drawn with about so many rows.
FAINT_ROWS = 180


def panels(
    views: Sequence[View],
    picked: Sequence[Quantity],
    circuit: int = 0,
    *,
    over: Over = "input",
    width: int = 420,
    height: int = 170,
) -> tuple[picture.Panel, ...]:
    """A panel for each quantity: every circuit over the input, or over the time of the chosen one's cycle.

    `views` are those of all circuits of a motion, `circuit` is the index of the one drawn strong; `width` and
    `height` [px] are those of one picture. Without values a frame says so.
    """
    motion = views[circuit].motion
    labelled = over == "input" and motion.limits.size > 0
    frame = picture.Frame(width, height, picture.LABELLED if labelled else picture.MARGINS[1])
    across = [
        shown_value(motion, motion.input, each.path.input) if over == "input" else each.path.time
        for each in views
    ]
    reach = _reach(motion, across if over == "input" else [across[circuit]], over)
    made = []
    for quantity in picked:
        curves = [curve_of(quantity, each) for each in views]
        own_span = curves[circuit].span()
        if own_span is None or reach is None:
            made.append(_empty(frame, quantity, quantity.absence(views[circuit])))
        else:
            made.append(_panel(frame, quantity, curves, circuit, reach, own_span, over))
    return tuple(made)


def _panel(
    frame: picture.Frame,
    quantity: Quantity,
    curves: Sequence[QuantityCurve],
    circuit: int,
    reach: Span,
    own_span: Span,
    over: Over,
) -> picture.Panel:
    own = curves[circuit]
    motion, colour = own.walked.motion, circuit_colour(circuit)
    left, top, right, bottom = frame.box
    wide, tall = right - left, bottom - top
    label = input_label(motion) if over == "input" else "time [s]"
    name, _, unit = label.removesuffix("]").rpartition(" [")
    below = scale(*reach, max(2, wide // 50), degrees=unit == "deg")
    others = [span for each in curves if each is not own and (span := each.span()) is not None]
    least = max(FLAT * own.natural, 1e-9 * max(map(abs, own_span)))
    low, high = _shown_range(quantity, own_span, others, least)
    beside = scale(low, high, max(2, tall // 18), degrees=quantity.unit == "deg")
    places = [(frame.x(below, each.across(over)), frame.y(beside, each.values)) for each in curves]
    x, y = places[circuit]
    faint = [
        f'<g stroke="{_pale(circuit_colour(i))}">{_lines(each, frame, *place, FAINT_ROWS)}</g>'
        for i, (each, place) in enumerate(zip(curves, places, strict=True))
        if each is not own
    ]
    content = [
        f'<rect width="{frame.width}" height="{frame.height}" fill="{picture.GROUND}"/>',
        picture.head(frame, quantity.heading, beside.unit(quantity.unit), _keys(own), colour),
        picture.grid(frame, below, beside, name, unit),
        _limits(own.walked, frame, below, unit) if over == "input" else "",
        f'<svg x="{left}" y="{top}" width="{wide}" height="{tall}" viewBox="0 0 {wide}0 {tall}0" '
        'fill="none" stroke-linejoin="round">',
        f'<g stroke-width="12">{"".join(faint)}</g>',
        _strong(own, frame, x, y, colour),
        "</svg>",
        _marks(own, frame, below, beside, over, colour) if own_span[1] - own_span[0] > least else "",
    ]
    svg = frame.svg("".join(content), name=f"{quantity.name}, circuit {circuit}")
    return picture.Panel(frame, svg, x, y, own.values, beside, quantity.unit, colour)


def _strong(own: QuantityCurve, frame: picture.Frame, x: Floats, y: Floats, colour: str) -> str:
    """The chosen circuit's line, pale where a stop of the linkage keeps it from going."""
    whole = _lines(own, frame, x, y, len(x))
    if not own.walked.linkage.stops.stops:
        return f'<g stroke-width="20" stroke="{colour}">{whole}</g>'
    usable = _lines(own, frame, x, np.where(within(own.walked), y, np.nan), len(x))
    return (
        f'<g stroke-width="20" stroke="{_pale(colour)}">{whole}</g>'
        f'<g stroke-width="20" stroke="{colour}">{usable}</g>'
    )


def _lines(curve: QuantityCurve, frame: picture.Frame, x: Floats, y: Floats, most: int) -> str:
    """The passes as SVG, in tenths of px from the plot area's corner, with at most about `most` rows."""
    left, top, _, _ = frame.box
    step = max(1, round(len(x) / most))
    drawn = []
    for part in curve.passes:
        rows = np.arange(part.start, part.stop)
        if step > 1:
            rows = np.append(rows[:-1:step], rows[-1:])
        inputs = curve.input[part]
        falls = len(curve.passes) > 1 and inputs[-1] < inputs[0]
        look = ' stroke-dasharray="50 30"' if falls else ""
        drawn.append(f'<path d="{picture.stroke(x[rows] - left, y[rows] - top)}"{look}/>')
    return "".join(drawn)


def _empty(frame: picture.Frame, quantity: Quantity, reason: str) -> picture.Panel:
    left, top, right, bottom = frame.box
    middle, text = ((left + right) / 2, (top + bottom) / 2 + 4), picture.fitted(reason, frame.width - 4)
    content = [
        f'<rect width="{frame.width}" height="{frame.height}" fill="{picture.GROUND}"/>',
        f'<rect x="{left}" y="{top}" width="{right - left}" height="{bottom - top}" fill="#f4f5f7"/>',
        picture.head(frame, quantity.heading, quantity.unit, (), picture.INK),
        picture.words(frame, *middle, text, anchor="middle", look=f'fill="{picture.QUIET}"'),
    ]
    nothing = np.empty(0)
    svg = frame.svg("".join(content), name=f"{quantity.name}: {reason}")
    return picture.Panel(frame, svg, nothing, nothing, nothing)


def _reach(motion: Motion, places: Sequence[Floats], over: Over) -> Span | None:
    """The range of the axis below; `None` where there is no place on it."""
    across = np.concatenate(places)
    across = across[np.abs(across) < LARGEST]
    if not across.size:
        return None
    low, high = float(across.min()), float(across.max())
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-9):
        return low - 0.5, high + 0.5
    room = 0.02 * (high - low) if over == "input" and motion.limits.size else 0.0
    return low - room, high + room


def _shown_range(quantity: Quantity, own: Span, others: Sequence[Span], least: float) -> Span:
    """The range of the axis at the left: the chosen circuit, and what of the others is near it."""
    span = own[1] - own[0]
    low, high = own
    for other in others:
        if span <= least:
            low, high = min(low, other[0]), max(high, other[1])
        elif other[0] < own[1] + span and other[1] > own[0] - span:
            # at least a third of the height is left to the chosen circuit
            low, high = min(low, max(other[0], own[0] - span)), max(high, min(other[1], own[1] + span))
    if quantity.row.is_size:
        low = 0.0
    if high - low <= least:
        half = 0.1 * max(abs(low + high) / 2, least / FLAT) or 1.0
        return (low + high) / 2 - half, (low + high) / 2 + half
    room = 0.07 * (high - low)
    return low - (0.2 * room if quantity.row.is_size else room), high + room


def _keys(own: QuantityCurve) -> tuple[tuple[str, str], ...]:
    """Short words, with their dashes, that tell the passes apart and that rates are cut."""
    keys = [("axis cut", "")] if own.cut else []
    if len(own.passes) > 1 and own.walked.motion.law is None:
        keys += [("rising", "20 0"), ("falling", "5 3")]
    if own.walked.linkage.stops.stops and not within(own.walked).all():
        keys.append(("pale: beyond a stop", ""))
    return tuple(keys)


def _limits(walked: TimedWalk, frame: picture.Frame, below: Scale, unit: str) -> str:
    """Dashed lines with values at input limits, paler for other circuits; dotted ones at change points."""
    motion = walked.motion
    left, top, _, bottom = frame.box
    own = shown_value(
        motion, motion.input, np.array([d.input for d in walked.circuit.dead_centres if d.kind == "input"])
    )
    parts: list[str] = []
    free = 0.0
    sorts = ((motion.limits, "4 3", "input limit"), (motion.change_point_inputs, "1 3", "change point"))
    for inputs, dashes, name in sorts:
        values = np.sort(inputs_between(motion, inputs, below.low, below.high))
        for value, x in zip(values.tolist(), frame.x(below, values).tolist(), strict=True):
            label = below.reading(value, unit)
            colour = picture.QUIET if (np.abs(own - value) < 1e-6 * (1 + abs(value))).any() else picture.ZERO
            parts.append(
                f'<path d="M{x:.1f} {top}V{bottom}" stroke="{colour}" stroke-dasharray="{dashes}">'
                f"<title>{escape(f'{name} {label}')}</title></path>"
            )
            # a number without room beside its neighbour is left to the tooltip
            wide = picture.breadth(label)
            start = max(x - wide / 2, left)
            if name == "input limit" and start >= free:
                parts.append(picture.words(frame, start, top - 3, label, look=f'fill="{picture.QUIET}"'))
                free = start + wide + 4
    return "".join(parts)


def _pale(colour: str) -> str:
    """A colour (#rrggbb) as it stands behind, opaque, so that lines that meet do not mix."""
    return "#" + "".join(f"{round(255 - 0.4 * (255 - int(colour[i : i + 2], 16))):02x}" for i in (1, 3, 5))


def _marks(
    own: QuantityCurve, frame: picture.Frame, below: Scale, beside: Scale, over: Over, colour: str
) -> str:
    """Small circles at the extremes of the output's angle or rates, each with its value as a tooltip."""
    parts: list[str] = []
    _, top, _, bottom = frame.box
    for mark in own.marks:
        across = own.place(mark, over)
        x, y = float(frame.x(below, np.array(across))), float(frame.y(beside, np.array(mark.value)))
        if math.isfinite(x) and top <= y <= bottom:
            label = escape(f"{mark.word} {beside.reading(mark.value, own.quantity.unit)}")
            look = f'fill="{picture.GROUND}" stroke="{colour}" stroke-width="1.5"'
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.2" {look}><title>{label}</title></circle>')
    return "".join(parts)
