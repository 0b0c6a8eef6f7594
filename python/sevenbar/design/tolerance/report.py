"""What tolerances do: a page for people, an object for programs, a folder."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.console import RenderableType
from rich.table import Table

from sevenbar.arrays import counted
from sevenbar.design.tolerance.figures import deviation_figure, shares_figure
from sevenbar.design.tolerance.linear import Linear
from sevenbar.design.tolerance.samples import LEVELS, MonteCarlo
from sevenbar.design.tolerance.tolerances import CUT
from sevenbar.design.tolerance.worst import WorstCase
from sevenbar.kinematics.loop.columns import unit_in_column
from sevenbar.kinematics.measures import MEASURES
from sevenbar.reporting.files import Report, columns_file, figure_files, json_file
from sevenbar.reporting.page import Facts, number_table, page
from sevenbar.reporting.shown import drive_text
from sevenbar.text.listed import named
from sevenbar.text.words import retold, say, spoken

#: Dimensions of a corner design that the page names; the JSON has all.
MOST_NAMED = 8

#: An effect relative to the greatest that is rounding.
NO_EFFECT = 1e-9


@dataclass(frozen=True, eq=False)
class Findings:
    """The linear estimate, the worst case and, where samples were drawn, Monte Carlo."""

    linear: Linear
    worst: WorstCase
    exact: MonteCarlo | None


def text(findings: Findings) -> RenderableType:
    """The findings for people."""
    linear, worst, exact = findings.linear, findings.worst, findings.exact
    result = linear.found
    facts = Facts()
    circuit, turns = result.circuit, say(result.circuit.motion_type)
    output = {"output": linear.words, "number": circuit.index, "motion_type": turns}
    facts.add("output", say("{output}, circuit {number} ({motion_type})", **output))
    unit = result.linkage.unit_of(result.input_name)
    facts.add("drive", drive_text(result.input_name, result.speed, unit))
    if linear.held.left_to_the_program:
        facts.add("held", linear.held.text)
    errors = say("independent, {distribution}", distribution=say(linear.distribution))
    if linear.distribution == "normal":
        errors = say("{errors}, the tolerance being {count:g} standard deviations", errors=errors, count=CUT)
    facts.add("errors", errors)
    most = float(linear.shown(linear.worst)[worst.at])
    facts.add("worst case", _linear_text(linear, most, worst.at))
    facts.add("", _corner_text(worst))
    if tried := _tried_text(worst):
        facts.add("", tried)
    row = int(np.argmax(linear.deviation))
    three = 3 * float(linear.shown(linear.deviation)[row])
    facts.add("3 sigma", _linear_text(linear, three, row))
    if exact is not None:
        facts.add("Monte Carlo", _samples_text(exact))
        facts.add("", exact.verdict, style="bold")
    for note in linear.left_out():
        facts.add("note", retold(note))
    measures = [_measures_table(linear)] if result.measures else []
    return page(result.linkage.heading, facts, _effects_table(linear), *measures)


def as_dict(findings: Findings) -> dict[str, Any]:
    """The findings as plain values: outputs in rad and length, dimensions in the units of the file."""
    linear, worst, exact = findings.linear, findings.worst, findings.exact
    result = linear.found
    plain_values: dict[str, Any] = {
        "format": 1,
        "linkage": result.linkage.name,
        "drive": {"input": result.input_name, "output": result.output_name, "speed": result.speed},
        "circuit": result.circuit.index,
        "reported": {"output": linear.output, "quantity": linear.quantity, "unit": linear.unit},
        "distribution": linear.distribution,
        **linear.held.as_dict,
        "dimensions": [
            {
                **named(effect.dimension, "name", "unit", "value"),
                "tolerance": effect.width,
                "from": effect.source,
                "greatest_effect": effect.greatest,
                "at_input": effect.at,
                "share_of_variance": effect.share,
            }
            for effect in linear.effects
        ],
        "opening": list(result.opening),
        "worst_case": {
            "linear": float(linear.worst[worst.at]),
            "at_input": float(linear.input[worst.at]),
            **named(worst, "corner", "corner_low", "corners"),
            "corners_tried": worst.tried,
            "corners_that_do_not_close": worst.open,
            "exact_high": float(worst.high[worst.at]),
            "exact_low": float(worst.low[worst.at]),
        },
        "deviation": float(linear.deviation.max()),
        "measures": [
            named(one, "name", "unit", "value")
            | dict(zip(("worst_case", "deviation"), linear.measure(one.name), strict=True))
            for one in result.measures
        ],
        "rows": counted(linear.status),
        "notes": list(linear.left_out()),
    }
    if exact is not None:
        plain_values["monte_carlo"] = {
            **named(exact, "count", "seed", "lost"),
            "reasons": dict(exact.reasons),
            "greatest": exact.greatest,
            "deviation": float(exact.deviation.max()),
            **named(exact, "ratio", "ratio_error", "bias", "bias_error"),
            "linear_estimate_holds": exact.holds,
            "verdict": exact.verdict,
        }
    return plain_values


def tolerance_report(figures: Sequence[str] = ("png",)) -> Report[Findings]:
    """How findings are reported, with the figures in these formats."""
    return Report(
        text,
        as_dict,
        {
            "tolerance.json": json_file(as_dict),
            "dimensions.csv": columns_file(_dimensions),
            "deviation.csv": columns_file(_deviation),
            "sensitivities.csv": columns_file(_sensitivities),
            **figure_files("shares", figures, lambda found: shares_figure(found.linear)),
            **figure_files("deviation", figures, lambda found: deviation_figure(found.linear, found.exact)),
        },
        spoken=True,
    )


def _dimensions(findings: Findings) -> dict[str, Any]:
    linear = findings.linear
    effects = linear.effects
    greatest = linear.shown([effect.greatest for effect in effects])
    return {
        "dimension": [effect.dimension.name for effect in effects],
        "unit": [effect.dimension.unit for effect in effects],
        "value": [effect.dimension.value for effect in effects],
        "tolerance": [effect.width for effect in effects],
        "from": [effect.source for effect in effects],
        f"greatest_effect_{_suffix(linear)}": greatest,
        "share_of_variance": [effect.share for effect in effects],
    }


def _deviation(findings: Findings) -> dict[str, Any]:
    linear, worst, exact = findings.linear, findings.worst, findings.exact
    unit = _suffix(linear)
    columns = {
        "input": linear.input,
        f"worst_case_{unit}": linear.shown(linear.worst),
        f"corner_high_{unit}": linear.shown(worst.high),
        f"corner_low_{unit}": linear.shown(worst.low),
        f"deviation_{unit}": linear.shown(linear.deviation),
    }
    if exact is not None:
        columns[f"monte_carlo_mean_{unit}"] = linear.shown(exact.mean)
        columns[f"monte_carlo_deviation_{unit}"] = linear.shown(exact.deviation)
        for level, quantile in zip(LEVELS, exact.quantiles, strict=True):
            columns[f"monte_carlo_q{100 * level:g}_{unit}"] = linear.shown(quantile)
    return columns


def _sensitivities(findings: Findings) -> dict[str, Any]:
    linear = findings.linear
    slopes = {"input": linear.input}
    for dimension, column in zip(linear.found.dimensions, linear.slopes.T, strict=True):
        per = f"{_suffix(linear)}_per_{unit_in_column(dimension.unit) or 'one'}"
        slopes[f"{dimension.name}_{per}"] = linear.shown(column)
    return slopes


def _suffix(linear: Linear) -> str:
    return unit_in_column(linear.shown_unit)


def _linear_text(linear: Linear, value: float, row: int) -> str:
    """An estimate by derivatives at a row."""
    shown = f"± {value:.4g} {linear.shown_unit}"
    return say("{value} at {input}, linear", value=shown, input=linear.shown_input(linear.input[row]))


def _corner_text(worst: WorstCase) -> str:
    """What the corner designs do exactly."""
    linear = worst.linear
    named = [f"{name} {value:.7g}" for name, value in list(worst.corner.items())[:MOST_NAMED]]
    more = len(worst.corner) - len(named)
    design = ", ".join(named)
    if more:
        design = say("{dimensions} and {count} more", dimensions=design, count=more)
    high, low = (float(linear.shown(side)[worst.at]) for side in (worst.high, worst.low))
    if not (math.isfinite(high) and math.isfinite(low)):
        return say(
            "{open} of {tried} designs with every dimension at an end of its tolerance do not close there, "
            "one of them with {design}, so this is no bound",
            open=worst.open, tried=worst.tried, design=design,
        )  # fmt: skip
    share = f"{abs(100 * worst.difference):.2g} %"
    other = say("the opposite errors") if worst.opposite else say("other ends")
    more_or_less = (
        say("{share} more than linear", share=share)
        if worst.difference > 0
        else say("{share} less than linear", share=share)
    )
    return say(
        "exactly {high:+.4g} with {design}; {low:+.4g} with {other}: {comparison}",
        high=high, design=design, low=low, other=other, comparison=more_or_less,
    )  # fmt: skip


def _tried_text(worst: WorstCase) -> str:
    """Which corner designs were computed; empty where that is shown already."""
    if worst.tried < worst.corners:
        rest = worst.corners - worst.tried
        return say(
            "of the {tried} designs with every dimension at an end of its tolerance that the derivatives "
            "name; the other {rest:,} were not tried",
            tried=worst.tried, rest=rest,
        )  # fmt: skip
    if worst.open:
        return ""
    return say("of all {count} designs with every dimension at an end of its tolerance", count=worst.corners)


def _samples_text(exact: MonteCarlo) -> str:
    linear = exact.linear
    three = 3 * float(linear.shown(exact.deviation).max())
    return say(
        "{count} designs (seed {seed}): 3 sigma ± {sigma}, greatest {seen:.4g}; their standard deviation is "
        "{ratio} times the linear one, their mean is off by {bias} of it",
        **named(exact, "count", "seed"),
        sigma=f"{three:.4g} {linear.shown_unit}",
        seen=float(linear.shown(exact.greatest)),
        ratio=_with_error(exact.ratio, exact.ratio_error),
        bias=_with_error(exact.bias, exact.bias_error),
    )


def _with_error(value: float, error: float) -> str:
    """A number with its statistical error, both to the error's first digits."""
    digits = min(max(1 - math.floor(math.log10(error)), 0), 6) if error > 0 else 6
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def _effects_table(linear: Linear) -> Table:
    heads = ("dimension", "value", "tolerance", "effect", "at", "share", "from")
    least = NO_EFFECT * max(effect.greatest for effect in linear.effects)
    rows = (
        (
            effect.dimension.name,
            f"{effect.dimension.value:.7g}",
            f"± {effect.width:.4g} {effect.dimension.unit}".rstrip(),
            f"± {float(linear.shown(effect.greatest)):.4g} {linear.shown_unit}"
            if effect.greatest > least
            else say("none"),
            linear.shown_input(effect.at) if effect.greatest > least else "-",
            f"{100 * effect.share:.1f} %",
            effect.source,
        )
        for effect in linear.effects
    )
    return number_table(heads, rows, words=[6])


def _measures_table(linear: Linear) -> Table:
    rows = []
    for one in linear.found.measures:
        worst, deviation = linear.measure(one.name)
        cells = [f"± {value:.4g}" if math.isfinite(value) else "-" for value in (worst, 3 * deviation)]
        unit = f" [{one.unit.replace('^2', '²')}]" if one.unit else ""
        measure, colon, joint = one.name.partition(":")
        title = MEASURES[measure].title if measure in MEASURES and spoken() != "en" else measure
        words = say(title.replace("_", " "))
        rows.append((words + colon + joint + unit, f"{one.value:.6g}", *cells))
    return number_table(("measure", "nominal", "worst case", "3 sigma"), rows)
