"""The page's figures, as SVG, from the results alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evidence.accuracy.quantiles import QUANTITIES, ROUNDING
from sevenbar.drawing.style import STYLE

Results = Mapping[str, Any]

#: Colours of position, velocity, acceleration and jerk.
COLOURS = dict(zip(QUANTITIES, ("#000000", "#0072B2", "#009E73", "#D55E00"), strict=True))

#: Corners of lines with more than two decimals of a pixel, which nobody sees.
FINE = re.compile(r"([ML]) (-?\d+\.\d\d)\d* (-?\d+\.\d\d)\d*")

#: What stands for an error of exactly zero on an axis of powers of ten.
LEAST = 1e-18


def _styled(axes: Axes) -> None:
    axes.grid(True, which="major", linewidth=0.6)
    axes.set_axisbelow(True)
    # a file of half the size
    axes.minorticks_off()
    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "log":
            axis.set_major_formatter(lambda value, _: f"{value:.0e}")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _joined(axes: Axes, curves: Sequence[tuple[Sequence[float], Sequence[float]]], **style: Any) -> None:
    """Many curves (x, y) of one style as a single line with gaps, which makes a small file."""
    gap = [np.nan]
    x = np.concatenate([np.append(xs, gap) for xs, _ in curves] or [gap])
    y = np.concatenate([np.append(ys, gap) for _, ys in curves] or [gap])
    axes.plot(x, y, **style)


def quantiles(results: Results) -> Figure:
    """Median to greatest error of the joints and of points, a linkage a line."""
    rows = results["rows"]
    figure = Figure(figsize=(9.0, 0.27 * len(rows) + 1.3), layout="constrained")
    for axes, what, title in zip(
        figure.subplots(1, 2, sharey=True, sharex=True),
        ("joints", "points"),
        ("joints", "a point of a link"),
        strict=True,
    ):
        for place, quantity in enumerate(QUANTITIES):
            errors = [found["random"][what][quantity]["errors"] for found in rows.values()]
            low, high = ([max(error[share], LEAST) for error in errors] for share in ("median", "greatest"))
            heights = np.arange(len(rows)) + 0.17 * (place - 1.5)
            _joined(
                axes,
                [([a, b], [y, y]) for a, b, y in zip(low, high, heights, strict=True)],
                color=COLOURS[quantity],
                linewidth=1.6,
                solid_capstyle="butt",
            )
            axes.plot(high, heights, ".", color=COLOURS[quantity], markersize=4)
        axes.set_xscale("log")
        axes.axvline(ROUNDING, color="#888888", linewidth=0.8, linestyle="--")
        axes.set_title(title, fontsize=9)
        axes.set_xlabel("error, in parts of its scale")
        axes.set_yticks(range(len(rows)), list(rows))
        _styled(axes)
    axes.invert_yaxis()
    handles = [
        axes.plot([], [], color=COLOURS[quantity], linewidth=1.6, label=quantity)[0]
        for quantity in QUANTITIES
    ]
    handles.append(axes.plot([], [], color="#888888", linewidth=0.8, linestyle="--", label="one rounding")[0])
    figure.legend(handles=handles, loc="outside upper center", ncols=5, frameon=False)
    return figure


def dead_centres(results: Results) -> Figure:
    """Errors of the joints' rates over how far the dead centre is, and over their bound."""
    figure = Figure(figsize=(9.0, 3.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    for closed_form, style in (
        (False, {"linewidth": 0.8, "alpha": 0.75}),
        (True, {"linewidth": 2.2}),
    ):
        driven = [
            one["steps"]
            for found in results["dead_centres"].values()
            if found["closed form"] == closed_form
            for one in found["driven"]
        ]
        for order, quantity in enumerate(QUANTITIES):
            for axes, measure, least in ((left, "errors", LEAST), (right, "bounds", 1e-6)):
                # a bound is given for rates
                if axes is left or order:
                    curves = [
                        (
                            [step["apart"] for step in steps],
                            [max(step[measure][order], least) for step in steps],
                        )
                        for steps in driven
                    ]
                    _joined(axes, curves, color=COLOURS[quantity], **style)
    for axes, label in (
        (left, "greatest error, in parts of its scale"),
        (right, "the same in parts of the bound"),
    ):
        axes.set(
            xscale="log", yscale="log", xlabel="distance from the dead centre [rad, or size]", ylabel=label
        )
        axes.invert_xaxis()
        _styled(axes)
    right.axhline(1.0, color="#888888", linewidth=0.8, linestyle="--")
    handles = [left.plot([], [], color=COLOURS[name], label=name)[0] for name in QUANTITIES]
    handles.append(left.plot([], [], color="#888888", linewidth=2.2, label="RSSR in closed form (thick)")[0])
    figure.legend(handles=handles, loc="outside upper center", ncols=5, frameon=False)
    return figure


def differences(results: Results) -> Figure:
    """Errors of forward and central differences over the step, beside the exact rates."""
    found = results["differences"]["all"]["by_step"]
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    axes = figure.subplots()
    for order, quantity in enumerate(QUANTITIES[1:]):
        colour = COLOURS[quantity]
        for scheme, style in (("forward", "--"), ("central", "-")):
            axes.plot(found["steps"], found[scheme][order], style, color=colour, linewidth=1.3)
        axes.axhline(max(found["exact rates"][order], LEAST), color=colour, linewidth=1.3, linestyle=":")
    axes.set(xscale="log", yscale="log", ylim=(1e-17, 10), xlabel="step [rad]")
    axes.set_ylabel("greatest error, in parts of the greatest rate")
    axes.axvline(np.radians(1.0), color="#888888", linewidth=0.8)
    axes.annotate(
        "one degree",
        (np.radians(1.0), 1e-13),
        rotation=90,
        ha="right",
        va="center",
        color="#555555",
        fontsize=8,
    )
    handles = [axes.plot([], [], color=COLOURS[name], label=name)[0] for name in QUANTITIES[1:]]
    for style, label in (("--", "forward, as in the paper"), ("-", "central"), (":", "exact rates")):
        handles.append(axes.plot([], [], style, color="#555555", label=label)[0])
    figure.legend(handles=handles, loc="outside upper center", ncols=6, frameon=False)
    _styled(axes)
    return figure


#: Marks of the references.
MARKS = {
    "40 digits and more": ("o", "#0072B2"),
    "closed form": ("D", "#009E73"),
    "Exudyn": ("s", "#E69F00"),
    "MuJoCo": ("^", "#CC79A7"),
}


def references(results: Results) -> Figure:
    """The greatest difference of velocities from each reference, a linkage a line."""
    rows = results["rows"]
    figure = Figure(figsize=(9.0, 0.23 * len(rows) + 1.2), layout="constrained")
    axes = figure.subplots()
    found: dict[str, dict[str, float]] = {name: {} for name in MARKS}
    for name in rows:
        found["40 digits and more"][name] = rows[name]["random"]["joints"]["velocity"]["errors"]["greatest"]
        closed = results.get("closed_forms", {}).get(name)
        if closed:
            found["closed form"][name] = closed["output"]["velocity"]["errors"]["greatest"]
        for section, label in (("exudyn", "Exudyn"), ("mujoco", "MuJoCo")):
            run = results.get(section, {}).get(name, {})
            if "output" in run:
                found[label][name] = run["output"]["velocity"]["greatest"]
    lines = {name: line for line, name in enumerate(rows)}
    for label, (mark, colour) in MARKS.items():
        errors = [max(error, LEAST) for error in found[label].values()]
        places = [lines[name] for name in found[label]]
        axes.plot(errors, places, mark, color=colour, markersize=5, label=label)
    axes.set_xscale("log")
    axes.set_xlabel("greatest difference of velocities, in parts of their scale")
    axes.set_yticks(range(len(rows)), list(rows))
    axes.invert_yaxis()
    _styled(axes)
    figure.legend(loc="outside upper center", ncols=4, frameon=False)
    return figure


#: The figures by the end of their names.
FIGURES: dict[str, Callable[[Results], Figure]] = {
    "quantiles": quantiles,
    "dead_centres": dead_centres,
    "differences": differences,
    "references": references,
}


def write(results: Results, folder: Path) -> list[Path]:
    """`accuracy_NAME.svg`, each; the same bytes from the same results."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for name, draw in FIGURES.items():
        path = folder / f"accuracy_{name}.svg"
        with rc_context(STYLE):
            drawn = StringIO()
            draw(results).savefig(drawn, format="svg", metadata={"Date": None})
        path.write_text(FINE.sub(r"\1 \2 \3", drawn.getvalue()), encoding="utf-8")
        paths.append(path)
    return paths
