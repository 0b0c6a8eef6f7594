"""Figures of designs: a function and the wanted one, and the error; a swing and its transmission angle."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from sevenbar.design.candidates import Candidate
from sevenbar.design.closure import outputs, row_of, transmissions
from sevenbar.design.task.figures import GENERATED, POINTS, WANTED, Curve, readings_figure
from sevenbar.design.wish import Wish
from sevenbar.drawing.figure import headline, page_figure
from sevenbar.drawing.names import short
from sevenbar.drawing.style import styled
from sevenbar.drawing.ticks import DegreeLocator
from sevenbar.text.words import say

#: Pairs of angles beyond which they are small dots.
MANY = 40

#: Inputs of a turn at which a swing is drawn.
TURN = 721


def function_figure(candidate: Candidate, wish: Wish) -> Figure:
    """The wanted and the generated readings of the output over those of the input; below, the error [deg]."""
    figures = candidate.claim.figures
    zeros = [math.radians(figures[name]) for name in ("input_zero_deg", "output_zero_deg")]
    inputs = np.degrees(candidate.claim.inputs - zeros[0])
    readings = np.degrees(candidate.claim.outputs - zeros[1])
    at = inputs if wish.function is not None else np.degrees(wish.input)
    errors = np.degrees(candidate.claim.errors)
    # both sides on the same turn
    near = np.interp(at, inputs, readings) - errors
    turn = 360.0 * np.round((near[0] - math.degrees(wish.output[0])) / 360.0)
    size = 5.0 if len(wish.input) <= MANY or wish.function is not None else 2.2
    curves: list[Curve] = [(inputs, readings - turn, {**GENERATED, "label": say("generated")})]
    points = {**POINTS, "ms": size}
    if wish.function is not None:
        curves.append((inputs, near - turn, {**WANTED, "label": say("wanted")}))
        below: list[Curve] = [(inputs, errors, GENERATED)]
    else:
        curves.append((at, near - turn, {**points, "label": say("wanted")}))
        below = [(at, errors, points)]
    if wish.function is not None and wish.exact:
        met = np.degrees(wish.point_input)
        curves.append((met, np.degrees(wish.point_output), {**points, "label": say("precision point")}))
        below.append((met, np.interp(met, inputs, errors), points))
    labels = say("output reading [deg]"), say("generated less\nwanted [deg]"), say("input reading [deg]")
    return readings_figure(_title(candidate, wish), curves, below, labels, DegreeLocator(9))


def _title(candidate: Candidate, wish: Wish) -> str:
    greatest, rms = (math.degrees(e) for e in (candidate.error_greatest, candidate.error_rms))
    if wish.pairs:
        met = say("{count} precision points, met to {error:.1e}°", count=len(wish.input), error=greatest)
        return f"{short(candidate.name, 60)}\n{met}"
    reached = say("error at most {greatest:.3g}°, RMS {rms:.3g}°", greatest=greatest, rms=rms)
    return f"{short(candidate.name, 60)}\n{reached}"


def swing_figure(candidate: Candidate) -> Figure:
    """The output over a turn of the crank with the ends of its swing; below, the transmission angle [deg]."""
    figures = candidate.claim.figures
    row = row_of(candidate.draft.linkage.dimensions)[None]
    inputs = np.linspace(0.0, math.tau, TURN)
    # the branch whose output is the claimed one
    apart = [
        np.abs(np.exp(1j * (outputs(row, candidate.claim.inputs, b)[0] - candidate.claim.outputs)) - 1).max()
        for b in (0, 1)
    ]
    angles = np.degrees(np.unwrap(outputs(row, inputs, int(np.argmin(apart)))[0]))
    angles -= 360.0 * np.round(angles.mean() / 360.0)
    across = np.degrees(inputs)
    with styled():
        figure = page_figure(6.4, 6.0, pads=(0.05, 0.06))
        top, below = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (3.0, 1.6)})
        top.plot(across, angles, **GENERATED)
        for name in ("input_at_low_deg", "input_at_high_deg"):
            for axes in (top, below):
                axes.axvline(figures[name], color="#808080", lw=0.9, ls="--", zorder=1)
            top.plot(figures[name], np.interp(figures[name], across, angles), ms=5.0, **POINTS)
        below.plot(across, np.degrees(np.arcsin(np.sqrt(transmissions(row, inputs)[0]))), **GENERATED)
        below.set_ylim(0.0, 90.0)
        below.yaxis.set_major_locator(DegreeLocator(4))
        top.set_ylabel(say("output: {joint}", joint="rocker [deg]"))
        below.set_ylabel(say("transmission\nangle [deg]"))
        below.set_xlabel(say("input: {joint}", joint="crank [deg]"))
        below.set_xlim(0.0, 360.0)
        below.xaxis.set_major_locator(DegreeLocator(9))
        for axes in (top, below):
            axes.grid(lw=0.6)
        figure.align_ylabels()
        lowest = math.degrees(candidate.transmission_lowest or 0.0)
        least = say("transmission angle at least {lowest:.3g}°", lowest=lowest)
        headline(figure, f"{short(candidate.name, 60)}\n{least}")
    return figure
