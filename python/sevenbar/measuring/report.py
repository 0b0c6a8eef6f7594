"""The report of a comparison and of a calibration: a page for people, an object for programs, a folder."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import RenderableType
from rich.table import Table

from sevenbar.kinematics.loop.columns import unit_in_column
from sevenbar.measuring.calibrate import Calibration, Parameter
from sevenbar.measuring.compare import Comparison, alike, name_of, per_cent
from sevenbar.measuring.extremes import Extent, ExtremesComparison
from sevenbar.measuring.measured import Ends
from sevenbar.measuring.passes import PassFit
from sevenbar.reporting.files import Report, columns_file, figure_files, json_file, text_file
from sevenbar.reporting.folder import write_columns, write_csv
from sevenbar.reporting.page import Facts, number_table, opening, page
from sevenbar.reporting.shown import drive_text
from sevenbar.text.printing import text_of
from sevenbar.text.words import retold, say

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Decimals of values that exact rows give.
EXACT_DIGITS = 6

#: The JSON has all candidates and notes; the page has as many candidates.
MOST_CANDIDATES = 4


def comparison_text(comparison: Comparison | ExtremesComparison) -> RenderableType:
    """The comparison for people: what explains the data, the paper's Table 1, the differences."""
    ends, heading, facts = comparison.ends, comparison.linkage.heading, Facts()
    drive = drive_text(ends.input, comparison.speed, ends.unit("input"), ends.output)
    if isinstance(comparison, ExtremesComparison):
        facts.add("measured", say("{source}, lowest and highest values", source=comparison.source))
        facts.add("drive", drive)
        first, *others = (
            _with_residual(say("circuit {number}", number=i), m) for i, m in comparison.residuals
        )
        facts.add("explained by", first, style="bold")
        if others:
            facts.add("not by", say("; ").join(others[:MOST_CANDIDATES]))
        facts.add("", say("residual: root mean square of the errors relative to the measured range"))
        return page(heading, facts, _extents_table(comparison.table, ends))
    chosen = comparison.chosen
    rows = np.isfinite(next(iter(comparison.computed.values()))).sum()
    facts.add(
        "measured",
        say(
            "{source}, {rows} of {quantities}",
            source=comparison.source,
            rows=say("{count} rows", count=rows),
            quantities=say(", ").join(_words(ends, comparison.outputs)),
        ),
    )
    facts.add("drive", drive)
    facts.add("explained by", _candidate(chosen), style="bold")
    others, named = [], [chosen]
    for candidate in comparison.candidates[1:]:
        if not any(alike(candidate, other) for other in named):
            named.append(candidate)
            others.append(_candidate(candidate))
    if others:
        more = len(others) - MOST_CANDIDATES
        rest = [say("{count} more", count=more)] if more > 0 else []
        facts.add("not by", say("; ").join([*others[:MOST_CANDIDATES], *rest]))
    facts.add("", say("residual: root mean square of the differences relative to the measured range"))
    for name, value, quantity, asked in (
        ("phase", chosen.phase, "input", "phase"),
        ("offset", chosen.offset, "angle", "offset"),
    ):
        if asked in comparison.aligned:
            shown = _value(ends, quantity, value)
            facts.add(
                name,
                say("{value} added to the measured input", value=shown)
                if name == "phase"
                else say("{value} subtracted from the measured output", value=shown),
            )
    for note in comparison.notes:
        facts.add("note", retold(note))
    return page(heading, facts, _extents_table(comparison.table, ends), _spread_table(comparison))


def calibration_text(calibration: Calibration) -> RenderableType:
    """The calibration for people: each dimension with its interval, or why it has none."""
    ends, chosen = calibration.ends, calibration.before.chosen
    facts = Facts()
    facts.add(
        "measured",
        say(
            "{source}, {rows} of {quantities}",
            source=calibration.source,
            rows=_rows_and_places(calibration),
            quantities=say(", ").join(_words(ends, calibration.outputs)),
        ),
    )
    speed = calibration.before.speed
    facts.add("drive", drive_text(ends.input, speed, ends.unit("input"), ends.output))
    facts.add("explained by", _named(chosen))
    for quantity in calibration.outputs:
        before, after = (
            _rms(calibration.measured[quantity] - side[quantity])
            for side in (calibration.nominal, calibration.computed)
        )
        facts.add(
            say("rms of the {quantity}", quantity=say(ends.word(quantity))),
            say(
                "{before:.4g} before, {after:.4g} after [{unit}]",
                before=before,
                after=after,
                unit=ends.unit(quantity),
            ),
        )
    count = len(calibration.calibrated)
    facts.add(
        "fitted",
        say("{count} parameters, {freedom} degrees of freedom", count=count, freedom=calibration.freedom),
    )
    if held := calibration.held.text:
        facts.add("held", held)
    for parameter in calibration.parameters:
        if parameter.status == "unidentified":
            facts.add("not identifiable", unidentified_sentence(parameter, calibration))
    opening = [p.name for p in calibration.parameters if p.status == "opens the loop"]
    if opening:
        names = ", ".join(opening)
        facts.add(
            "held", say("{names}: a change of one alone would open this overconstrained loop", names=names)
        )
    for note in calibration.notes:
        facts.add("note", retold(note))
    return page(calibration.linkage.heading, facts, _parameter_table(calibration))


def _rows_and_places(calibration: Calibration) -> str:
    """How many rows there are, and at how many places where some repeat an input."""
    rows = len(calibration.line)
    if calibration.places < rows:
        return say("{count} rows at {places} places", count=rows, places=calibration.places)
    return say("{count} rows", count=rows)


def unidentified_sentence(parameter: Parameter, calibration: Calibration) -> str:
    """Why a parameter was held, and at what."""
    at = _parameter_value(parameter, parameter.value, calibration.ends)
    if not parameter.undone_by:
        return say(
            "{name}, held at {value}: a change of it does not show in these data",
            name=parameter.name, value=at,
        )  # fmt: skip
    return say(
        "{name}, held at {value}: changes of {others} would hide a change of it",
        name=parameter.name,
        value=at,
        others=", ".join(parameter.undone_by),
    )


def comparison_dict(comparison: Comparison | ExtremesComparison) -> dict[str, Any]:
    """The comparison as plain values; angles in radians."""
    ends = comparison.ends
    common = {
        "format": 1,
        "linkage": comparison.linkage.name,
        "measured": comparison.source,
        "units": _units(ends),
        "drive": {"input": ends.input, "output": ends.output, "speed": comparison.speed},
    }
    table = [
        {
            "quantity": extent.quantity,
            **{
                name: {"computed": c, "measured": m, "error": error, "per_cent": share}
                for name, c, m, error, share in extent.rows()
            },
        }
        for extent in comparison.table
    ]
    if isinstance(comparison, ExtremesComparison):
        residuals = [{"circuit": i, "residual": m} for i, m in comparison.residuals]
        return common | {"circuit": comparison.circuit, "candidates": residuals, "table": table}
    return common | {
        "rows": len(comparison.line),
        "circuit": comparison.chosen.circuit,
        "branch": comparison.chosen.branch,
        "branches": list(comparison.chosen.branches),
        "aligned": list(comparison.aligned),
        "phase": comparison.chosen.phase,
        "offset": comparison.chosen.offset,
        "candidates": [_candidate_dict(c) for c in comparison.candidates],
        "table": table,
        "differences": {q: vars(comparison.spread(q)) for q in comparison.outputs},
        "notes": list(comparison.notes),
    }


def _candidate_dict(fit: PassFit) -> dict[str, Any]:
    return {**vars(fit), "branches": list(fit.branches)}


def calibration_dict(calibration: Calibration) -> dict[str, Any]:
    """The calibration as plain values; angles in radians, NaN where there is no interval."""
    ends = calibration.ends
    return {
        "format": 1,
        "linkage": calibration.linkage.name,
        "measured": calibration.source,
        "units": _units(ends),
        "drive": {"input": ends.input, "output": ends.output, "speed": calibration.before.speed},
        "rows": len(calibration.line),
        "circuit": calibration.before.chosen.circuit,
        "branch": calibration.before.chosen.branch,
        "branches": list(calibration.before.chosen.branches),
        "confidence": calibration.confidence,
        "degrees_of_freedom": calibration.freedom,
        "places": calibration.places,
        "exact": calibration.exact,
        **calibration.held.as_dict,
        "parameters": [{**vars(p), "undone_by": list(p.undone_by)} for p in calibration.parameters],
        "covariance": {
            "parameters": [p.name for p in calibration.calibrated],
            "values": calibration.covariance.tolist(),
        },
        "noise": dict(calibration.noise),
        "rms": {
            q: {
                "nominal": _rms(calibration.measured[q] - calibration.nominal[q]),
                "calibrated": _rms(calibration.measured[q] - calibration.computed[q]),
            }
            for q in calibration.outputs
        },
        "notes": list(calibration.notes),
    }


def comparison_report(figures: Sequence[str] = ("png",)) -> Report[Comparison | ExtremesComparison]:
    """How a comparison is reported; rows.csv and the figure are of measured rows only."""
    return Report(
        comparison_text,
        comparison_dict,
        {
            "comparison.json": json_file(comparison_dict),
            "table.csv": _write_extents,
            "rows.csv": _write_compared,
            **figure_files("comparison", figures, _comparison_figure),
        },
        spoken=True,
    )


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
    return Report(
        calibration_text,
        calibration_dict,
        {
            "calibrated.toml": text_file(toml),
            "calibration.json": json_file(calibration_dict),
            "parameters.csv": _write_parameters,
            "rows.csv": columns_file(_calibrated_rows),
            **figure_files("calibration", figures, _calibration_figure),
        },
        spoken=True,
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


def _words(ends: Ends, quantities: Iterable[str]) -> list[str]:
    return [say(ends.word(quantity)) for quantity in quantities]


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
            digits = EXACT_DIGITS if calibration.exact else _digits(reach)
            plus_minus = say("exact") if calibration.exact else f"{reach:.{digits}f}"
            change = f"{value - nominal:+.{digits}f}"
            cells = [f"{value:.{digits}f}", plus_minus, change, say("follows") if follows else ""]
        else:
            note = {"fixed": "held", "unidentified": "not identifiable"}.get(p.status, p.status)
            cells = [f"{value:.6g}", "-", "-", say(note)]
        rows.append((label, f"{nominal:.6g}", *cells))
    return number_table(heads, rows, words=[5])


def _digits(reach: float) -> int:
    """Decimals that show two digits of an interval."""
    if not reach > 0:
        return 6
    return min(max(1 - math.floor(math.log10(reach)), 0), 12)


def _parameter_unit(parameter: Parameter, ends: Ends) -> str:
    per = "/turn" if parameter.kind == "pitch" else ""
    # the numbers of a drawn direction have no unit
    return {"angle": "deg", "number": ""}.get(parameter.kind, ends.length_unit + per)


def _shown(parameter: Parameter, value: float) -> float:
    """A value in the unit in which people read it."""
    return math.degrees(value) if parameter.kind == "angle" else value


def _parameter_value(parameter: Parameter, value: float, ends: Ends) -> str:
    return f"{_shown(parameter, value):.6g} {_parameter_unit(parameter, ends)}".rstrip()


def _rms(values: Any) -> float:
    return math.sqrt(float(np.mean(np.asarray(values) ** 2)))


def _units(ends: Ends) -> dict[str, str]:
    return {"length": ends.length_unit, "angle": "rad", "time": "s"}


def _rows(ends: Ends, line: Any, inputs: Any, sides: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """A line for each measured row: its line in the file, the input, each quantity on each side."""
    columns = {"line": line, f"input_{unit_in_column(ends.unit('input'))}": inputs}
    for quantity in next(iter(sides.values())):
        for side, values in sides.items():
            name = f"{ends.word(quantity)}_{side}_{unit_in_column(ends.unit(quantity))}"
            columns[name] = values[quantity]
    return columns


@text_of.register(Comparison)
@text_of.register(ExtremesComparison)
def _(comparison: Comparison | ExtremesComparison) -> str:
    return opening("Comparison", comparison_text(comparison))


@text_of.register(Calibration)
def _(calibration: Calibration) -> str:
    return opening("Calibration", calibration_text(calibration))
