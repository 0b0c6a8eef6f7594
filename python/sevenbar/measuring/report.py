"""The report of a comparison and of a calibration: a page for people, an object for programs, a folder."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from sevenbar.kinematics.loop.columns import unit_in_column
from sevenbar.measuring.calibrate import Calibration, Parameter
from sevenbar.measuring.compare import Comparison, alike, name_of, per_cent
from sevenbar.measuring.extremes import Extent, ExtremesComparison
from sevenbar.measuring.measured import Ends
from sevenbar.measuring.passes import PassFit
from sevenbar.reporting.csv_tables import write_columns, write_csv
from sevenbar.reporting.files import Report, columns_file, figure_files, text_file
from sevenbar.reporting.page import Facts, Page, number_table, page, page_report, prints_its_page
from sevenbar.reporting.shown import drive_text
from sevenbar.text.words import retold, say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Decimals of values whose interval has no width, or is not known.
EXACT_DIGITS = 6

#: Candidates on the page that do not explain the data; the JSON has all.
MOST_CANDIDATES = 4


def comparison_page(comparison: Comparison | ExtremesComparison) -> Page:
    """What explains the data, the paper's Table 1, the differences; plain values in radians."""
    heading, table = comparison.linkage.heading, _extents_table(comparison.table, comparison.ends)
    sides = ("computed", "measured", "error", "per_cent")
    extents = [
        {"quantity": extent.quantity}
        | {name: dict(zip(sides, values, strict=True)) for name, *values in extent.rows()}
        for extent in comparison.table
    ]
    if isinstance(comparison, ExtremesComparison):
        measured = say("{source}, lowest and highest values", source=comparison.source)
        facts = _facts(comparison, comparison.speed, measured)
        first, *others = (
            _with_residual(say("circuit {number}", number=i), m) for i, m in comparison.residuals
        )
        facts.add("explained by", first, style="bold", circuit=comparison.circuit)
        _add_others(facts, others)
        residuals = [{"circuit": i, "residual": m} for i, m in comparison.residuals]
        how = say("residual: root mean square of the errors relative to the measured range")
        facts.add("", how, candidates=residuals, table=extents)
        return page(heading, facts, table)
    chosen = comparison.chosen
    rows = say("{count} rows", count=np.isfinite(next(iter(comparison.computed.values()))).sum())
    facts = _facts(comparison, comparison.speed, _measured(comparison, rows))
    facts.also(rows=len(comparison.line))
    facts.add("explained by", _candidate(chosen), style="bold", **_chosen(comparison))
    others, named = [], [chosen]
    for candidate in comparison.candidates[1:]:
        if not any(alike(candidate, other) for other in named):
            named.append(candidate)
            others.append(_candidate(candidate))
    _add_others(facts, others)
    facts.add("", say("residual: root mean square of the differences relative to the measured range"))
    aligned = comparison.aligned
    phase = say("{value} added to the measured input", value=_value(comparison.ends, "input", chosen.phase))
    offset = say(
        "{value} subtracted from the measured output", value=_value(comparison.ends, "angle", chosen.offset)
    )
    facts.also(aligned=list(aligned))
    facts.add("phase", phase if "phase" in aligned else "", phase=chosen.phase)
    facts.add("offset", offset if "offset" in aligned else "", offset=chosen.offset)
    facts.also(
        candidates=[{**vars(fit), "branches": list(fit.branches)} for fit in comparison.candidates],
        table=extents,
        differences={q: vars(comparison.spread(q)) for q in comparison.outputs},
        notes=list(comparison.notes),
    )
    facts.add_all(("note", retold(note)) for note in comparison.notes)
    return page(heading, facts, table, _spread_table(comparison))


def calibration_page(calibration: Calibration) -> Page:
    """Each dimension with its interval, or why it has none; plain values in radians, NaN for no interval."""
    ends, before = calibration.ends, calibration.before
    count, places = len(calibration.line), calibration.places
    rows = say("{count} rows", count=count)
    if places < count:
        rows = say("{count} rows at {places} places", count=count, places=places)
    facts = _facts(calibration, before.speed, _measured(calibration, rows))
    facts.also(rows=count)
    facts.add("explained by", _named(before.chosen), **_chosen(before), confidence=calibration.confidence)
    rms = {quantity: _rms(calibration, quantity) for quantity in calibration.outputs}
    for quantity, (nominal, calibrated) in rms.items():
        text = say(
            "{before:.4g} before, {after:.4g} after [{unit}]",
            before=nominal, after=calibrated, unit=ends.unit(quantity),
        )  # fmt: skip
        facts.add(say("rms of the {quantity}", quantity=say(ends.word(quantity))), text)
    names, freedom = [p.name for p in calibration.calibrated], calibration.freedom
    fitted = say("{count} parameters, {freedom} degrees of freedom", count=len(names), freedom=freedom)
    facts.add("fitted", fitted, degrees_of_freedom=freedom, places=places, exact=calibration.exact)
    facts.add("held", calibration.held.text, **calibration.held.as_dict)
    for parameter in calibration.parameters:
        if parameter.status == "unidentified":
            facts.add("not identifiable", _unidentified(parameter, ends))
    if opening := ", ".join(p.name for p in calibration.parameters if p.status == "opens the loop"):
        facts.add(
            "held", say("{names}: a change of one alone would open this overconstrained loop", names=opening)
        )
    facts.also(
        parameters=[{**vars(p), "undone_by": list(p.undone_by)} for p in calibration.parameters],
        covariance={"parameters": names, "values": calibration.covariance.tolist()},
        noise=dict(calibration.noise),
        rms={q: dict(zip(("nominal", "calibrated"), sides, strict=True)) for q, sides in rms.items()},
        notes=list(calibration.notes),
    )
    facts.add_all(("note", retold(note)) for note in calibration.notes)
    return page(calibration.linkage.heading, facts, _parameter_table(calibration))


def _facts(result: Comparison | ExtremesComparison | Calibration, speed: float, measured: str) -> Facts:
    """What every page begins with."""
    ends, facts = result.ends, Facts()
    facts.also(format=1, linkage=result.linkage.name)
    facts.add("measured", measured, measured=result.source)
    facts.also(units={"length": ends.length_unit, "angle": "rad", "time": "s"})
    drive = {"input": ends.input, "output": ends.output, "speed": speed}
    facts.add("drive", drive_text(ends.input, speed, ends.unit("input"), ends.output), drive=drive)
    return facts


def _add_others(facts: Facts, others: Sequence[str]) -> None:
    """Adds the candidates that do not explain the data, those beyond `MOST_CANDIDATES` by their number."""
    more = len(others) - MOST_CANDIDATES
    rest = [say("{count} more", count=more)] if more > 0 else []
    if others:
        facts.add("not by", say("; ").join([*others[:MOST_CANDIDATES], *rest]))


def _measured(result: Comparison | Calibration, rows: str) -> str:
    quantities = say(", ").join(say(result.ends.word(quantity)) for quantity in result.outputs)
    return say("{source}, {rows} of {quantities}", source=result.source, rows=rows, quantities=quantities)


def _unidentified(parameter: Parameter, ends: Ends) -> str:
    """Why a parameter was held, and at what."""
    name, others = parameter.name, ", ".join(parameter.undone_by)
    at = f"{_shown(parameter, parameter.value):.6g} {_parameter_unit(parameter, ends)}".rstrip()
    if not others:
        return say("{name}, held at {value}: a change of it does not show in these data", name=name, value=at)
    return say(
        "{name}, held at {value}: changes of {others} would hide a change of it",
        name=name, value=at, others=others,
    )  # fmt: skip


def _chosen(before: Comparison) -> dict[str, Any]:
    fit = before.chosen
    return {"circuit": fit.circuit, "branch": fit.branch, "branches": list(fit.branches)}


def comparison_report(figures: Sequence[str] = ("png",)) -> Report[Comparison | ExtremesComparison]:
    """How a comparison is reported; rows.csv and the figure are of measured rows only."""
    files = {"table.csv": _write_extents, "rows.csv": _write_compared}
    drawn = figure_files("comparison", figures, _comparison_figure)
    return page_report(comparison_page, "comparison", {**files, **drawn})


def _write_extents(comparison: Comparison | ExtremesComparison, path: Path) -> None:
    ends = comparison.ends
    lines = [
        (extent.quantity, ends.unit(extent.quantity), *row)
        for extent in comparison.table
        for row in extent.rows()
    ]
    write_csv(path, ("quantity", "unit", "value", "computed", "measured", "error", "per_cent"), lines)


def _write_compared(comparison: Comparison | ExtremesComparison, path: Path) -> None:
    if isinstance(comparison, Comparison):
        sides = {"measured": comparison.measured, "computed": comparison.computed}
        write_columns(path, _rows(comparison.ends, comparison.line, comparison.input, sides))


def _comparison_figure(comparison: Comparison | ExtremesComparison) -> Figure | None:
    # matplotlib takes longer to load than a comparison to make
    from sevenbar.measuring.figures import comparison_figure

    return comparison_figure(comparison) if isinstance(comparison, Comparison) else None


def _calibration_figure(calibration: Calibration) -> Figure:
    from sevenbar.measuring.figures import calibration_figure

    return calibration_figure(calibration)


def calibration_report(
    toml: Callable[[Calibration], str], figures: Sequence[str] = ("png",)
) -> Report[Calibration]:
    """How a calibration is reported; `toml` makes the text of the calibrated linkage's file."""
    return page_report(
        calibration_page,
        "calibration",
        {
            "calibrated.toml": text_file(toml),
            "parameters.csv": _write_parameters,
            "rows.csv": columns_file(_calibrated_rows),
            **figure_files("calibration", figures, _calibration_figure),
        },
    )


def _write_parameters(calibration: Calibration, path: Path) -> None:
    head = ["parameter", "unit", "status", "nominal", "value", "standard_error", "low", "high", "undone_by"]
    lines = [
        (
            p.name,
            _parameter_unit(p, calibration.ends),
            p.status,
            *(_shown(p, v) for v in (p.nominal, p.value, p.error, p.low, p.high)),
            " ".join(p.undone_by),
        )
        for p in calibration.parameters
    ]
    write_csv(path, head, lines)


def _calibrated_rows(calibration: Calibration) -> dict[str, Any]:
    sides = {
        "measured": calibration.measured,
        "nominal": calibration.nominal,
        "calibrated": calibration.computed,
    }
    return _rows(calibration.ends, calibration.line, calibration.input, sides)


def _candidate(fit: PassFit) -> str:
    if fit.explains and fit.open_rows:
        share = per_cent(fit.closed_residual)
        return say("{circuit} (residual {share} where it closes)", circuit=_named(fit), share=share)
    return _with_residual(_named(fit), fit.residual)


def _named(fit: PassFit) -> str:
    """A candidate in the language that is spoken; messages name it in English."""
    return retold(name_of(fit))


def _with_residual(circuit: str, residual: float) -> str:
    return say("{circuit} (residual {share})", circuit=circuit, share=per_cent(residual))


def _value(ends: Ends, quantity: str, value: float) -> str:
    if ends.turns(quantity):
        return f"{math.degrees(value):.4f}\u00b0"
    return f"{value:.6g} {ends.unit(quantity)}"


def _extents_table(extents: Sequence[Extent], ends: Ends) -> Table:
    """The paper's Table 1, a line for each of its three values of each quantity."""
    rows = (
        (
            f"{say(ends.word(extent.quantity))} {say(name)} [{ends.unit(extent.quantity)}]",
            f"{computed:.6g}",
            f"{measured:.6g}",
            f"{error:+.4g}",
            "-" if share is None else f"{share:+.2f} %",
        )
        for extent in extents
        for name, computed, measured, error, share in extent.rows()
    )
    return number_table(("value", "computed", "measured", "error", "per cent"), rows)


def _spread_table(comparison: Comparison) -> Table:
    ends = comparison.ends
    rows = (
        (
            f"{say(ends.word(quantity))} [{ends.unit(quantity)}]",
            f"{spread.greatest:+.4g}",
            str(spread.line),
            f"{spread.rms:.4g}",
            f"{spread.mean:+.4g}",
        )
        for quantity in comparison.outputs
        for spread in [comparison.spread(quantity)]
    )
    return number_table(("measured minus computed", "greatest", "in line", "rms", "mean"), rows)


def _parameter_table(calibration: Calibration) -> Table:
    heads = ("dimension", "nominal", "calibrated", f"\u00b1 {100 * calibration.confidence:g} %", "change", "")
    rows = []
    for p in calibration.parameters:
        label = f"{p.name} [{_parameter_unit(p, calibration.ends)}]".removesuffix(" []")
        nominal, value = _shown(p, p.nominal), _shown(p, p.value)
        follows = p.status == "follows"
        if p.status == "calibrated" or follows:
            reach = _shown(p, (p.high - p.low) / 2)
            # two digits of the interval
            shown = reach > 0 and not calibration.exact
            digits = min(max(1 - math.floor(math.log10(reach)), 0), 12) if shown else EXACT_DIGITS
            plus_minus = say("exact") if calibration.exact else f"{reach:.{digits}f}"
            change = f"{value - nominal:+.{digits}f}"
            cells = [f"{value:.{digits}f}", plus_minus, change, say("follows") if follows else ""]
        else:
            note = {"fixed": "held", "unidentified": "not identifiable"}.get(p.status, p.status)
            cells = [f"{value:.6g}", "-", "-", say(note)]
        rows.append((label, f"{nominal:.6g}", *cells))
    return number_table(heads, rows, words=[5])


def _parameter_unit(parameter: Parameter, ends: Ends) -> str:
    per = "/turn" if parameter.kind == "pitch" else ""
    # the numbers of a drawn direction have no unit
    return {"angle": "deg", "number": ""}.get(parameter.kind, ends.length_unit + per)


def _shown(parameter: Parameter, value: float) -> float:
    """A value in the unit in which people read it."""
    return math.degrees(value) if parameter.kind == "angle" else value


def _rms(calibration: Calibration, quantity: str) -> tuple[float, float]:
    """Root mean square of the differences from the nominal and from the calibrated curve."""
    measured = calibration.measured[quantity]
    apart = (measured - side[quantity] for side in (calibration.nominal, calibration.computed))
    before, after = (math.sqrt(float(np.mean(part**2))) for part in apart)
    return before, after


def _rows(ends: Ends, line: Any, inputs: Any, sides: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """A line for each measured row: its line in the file, the input, each quantity on each side."""
    columns = {"line": line, f"input_{unit_in_column(ends.unit('input'))}": inputs}
    for quantity in next(iter(sides.values())):
        for side, values in sides.items():
            name = f"{ends.word(quantity)}_{side}_{unit_in_column(ends.unit(quantity))}"
            columns[name] = values[quantity]
    return columns


prints_its_page(Comparison, "Comparison", comparison_page)
prints_its_page(ExtremesComparison, "Comparison", comparison_page)
prints_its_page(Calibration, "Calibration", calibration_page)
