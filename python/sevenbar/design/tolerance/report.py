"""What tolerances do: a page for people, an object for programs, a folder."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sevenbar.arrays import counted
from sevenbar.design.tolerance.figures import deviation_figure, shares_figure
from sevenbar.design.tolerance.linear import Effect, Linear
from sevenbar.design.tolerance.samples import LEVELS, MonteCarlo
from sevenbar.design.tolerance.tolerances import CUT
from sevenbar.design.tolerance.worst import WorstCase
from sevenbar.kinematics.loop.columns import unit_in_column
from sevenbar.kinematics.measures import MEASURES
from sevenbar.kinematics.numbers.gradients import MeasureSlopes
from sevenbar.reporting.files import Report, columns_file, figure_files
from sevenbar.reporting.page import Facts, Page, facts_table, page, page_report
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


def page_of(findings: Findings) -> Page:
    """The findings; plain values are in rad and length, dimensions in the units of the file."""
    linear, worst, exact = findings.linear, findings.worst, findings.exact
    result = linear.found
    circuit, turns = result.circuit, say(result.circuit.motion_type)
    facts = Facts()
    facts.also(format=1, linkage=result.linkage.name)
    output = {"output": linear.words, "number": circuit.index, "motion_type": turns}
    facts.add("output", say("{output}, circuit {number} ({motion_type})", **output))
    unit = result.linkage.unit_of(result.input_name)
    drive = {"input": result.input_name, "output": result.output_name, "speed": result.speed}
    facts.add("drive", drive_text(result.input_name, result.speed, unit), drive=drive)
    facts.also(circuit=circuit.index, reported=named(linear, "output", "quantity", "unit"))
    facts.also(distribution=linear.distribution)
    held = linear.held.text if linear.held.left_to_the_program else ""
    facts.add("held", held, **linear.held.as_dict)
    errors = say("independent, {distribution}", distribution=say(linear.distribution))
    if linear.distribution == "normal":
        errors = say("{errors}, the tolerance being {count:g} standard deviations", errors=errors, count=CUT)
    facts.add("errors", errors)
    effects = [_effect(linear, effect) for effect in linear.effects]
    facts.also(dimensions=[effect.as_dict for effect in effects], opening=list(result.opening))
    most = float(linear.shown(linear.worst)[worst.at])
    corners = {
        "linear": float(linear.worst[worst.at]),
        "at_input": float(linear.input[worst.at]),
        **named(worst, "corner", "corner_low", "corners"),
        "corners_tried": worst.tried,
        "corners_that_do_not_close": worst.open,
        "exact_high": float(worst.high[worst.at]),
        "exact_low": float(worst.low[worst.at]),
    }
    facts.add("worst case", _linear_text(linear, most, worst.at), worst_case=corners)
    facts.add("", _corner_text(worst))
    facts.add("", _tried_text(worst))
    row = int(np.argmax(linear.deviation))
    three = 3 * float(linear.shown(linear.deviation)[row])
    facts.add("3 sigma", _linear_text(linear, three, row), deviation=float(linear.deviation.max()))
    measures = [_measure(linear, one) for one in result.measures]
    facts.also(measures=[measure.as_dict for measure in measures], rows=counted(linear.status))
    facts.also(notes=list(linear.left_out()))
    if exact is not None:
        drawn = {
            **named(exact, "count", "seed", "lost"),
            "reasons": dict(exact.reasons),
            "greatest": exact.greatest,
            "deviation": float(exact.deviation.max()),
            **named(exact, "ratio", "ratio_error", "bias", "bias_error"),
            "linear_estimate_holds": exact.holds,
            "verdict": exact.verdict,
        }
        facts.add("Monte Carlo", _samples_text(exact), monte_carlo=drawn)
        facts.add("", exact.verdict, style="bold")
    for note in linear.left_out():
        facts.add("note", retold(note))
    tables = [facts_table(effects, words=[6]), *([facts_table(measures)] if measures else [])]
    return page(result.linkage.heading, facts, *tables)


def tolerance_report(figures: Sequence[str] = ("png",)) -> Report[Findings]:
    """How findings are reported, with the figures in these formats."""
    return page_report(
        page_of,
        "tolerance",
        {
            "dimensions.csv": columns_file(_dimensions),
            "deviation.csv": columns_file(_deviation),
            "sensitivities.csv": columns_file(_sensitivities),
            **figure_files("shares", figures, lambda result: shares_figure(result.linear)),
            **figure_files(
                "deviation", figures, lambda result: deviation_figure(result.linear, result.exact)
            ),
        },
    )


def _dimensions(findings: Findings) -> dict[str, Any]:
    linear = findings.linear
    greatest = f"greatest_effect_{_suffix(linear)}"
    heads = {"name": "dimension", "greatest_effect": greatest}
    rows = [_effect(linear, effect).as_dict for effect in linear.effects]
    columns = {heads.get(key, key): [row[key] for row in rows] for key in rows[0] if key != "at_input"}
    return columns | {greatest: linear.shown(columns[greatest])}


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


def _effect(linear: Linear, effect: Effect) -> Facts:
    """What the tolerance of one dimension does."""
    dimension, row = effect.dimension, Facts()
    unit = dimension.unit
    row.add("dimension", dimension.name, name=dimension.name, unit=unit)
    row.add("value", f"{dimension.value:.7g}", value=dimension.value)
    row.add("tolerance", f"± {effect.width:.4g} {unit}".rstrip(), tolerance=effect.width)
    row.also(**{"from": effect.source})
    greatest, at = say("none"), "-"
    if effect.greatest > NO_EFFECT * max(other.greatest for other in linear.effects):
        greatest = f"± {float(linear.shown(effect.greatest)):.4g} {linear.shown_unit}"
        at = linear.shown_input(effect.at)
    row.add("effect", greatest, greatest_effect=effect.greatest)
    row.add("at", at, at_input=effect.at)
    row.add("share", f"{100 * effect.share:.1f} %", share_of_variance=effect.share)
    row.add("from", effect.source)
    return row


def _measure(linear: Linear, one: MeasureSlopes) -> Facts:
    """What tolerances do to a measure."""
    worst, deviation = linear.measure(one.name)
    unit = f" [{one.unit.replace('^2', '²')}]" if one.unit else ""
    measure, colon, joint = one.name.partition(":")
    title = MEASURES[measure].title if measure in MEASURES and spoken() != "en" else measure
    words, row = say(title.replace("_", " ")), Facts()
    row.add("measure", words + colon + joint + unit, name=one.name, unit=one.unit)
    row.add("nominal", f"{one.value:.6g}", value=one.value)
    row.add("worst case", _both_ways(worst), worst_case=worst)
    row.add("3 sigma", _both_ways(3 * deviation), deviation=deviation)
    return row


def _both_ways(value: float) -> str:
    return f"± {value:.4g}" if math.isfinite(value) else "-"
