"""A linkage file with calibrated dimensions: the same form, with every other key and all comments kept."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.description.draft import Draft
from sevenbar.description.files import loads
from sevenbar.errors import RequestError, SevenbarError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.measuring.calibrate import Calibration
from sevenbar.measuring.compare import compare, per_cent
from sevenbar.measuring.measured import Measured

#: Share of the measured range by which the residual of the file may differ from that of the calibration.
AGREES = 1e-6


def calibrated_toml(text: str, calibration: Calibration, *, source: str = "calibrated.toml") -> str:
    """The TOML text of a linkage with its calibrated dimensions in place of the nominal ones.

    L2 of an RSSR is written out, since left out it would follow from the others; it is left out where it was
    to follow. What the form has no key for, the zeros of the measured joints, is in the comment above. The
    text is read again, and the rows are compared with that linkage: `RequestError` where it does not explain
    them as well. `source` is the file of the text, in whose folder tables of loads are. Raises
    `MissingExtraError` without tomlkit.
    """
    draft = Draft.of(text, source)
    result = {p.name: p.value for p in calibration.calibrated if not p.name.endswith("_offset")}
    if result and "L2" in calibration.linkage.dimensions and "L2" not in calibration.follow:
        result = {"L2": calibration.parameter("L2").value} | result
    units = {dimension.name: dimension.scale for dimension in draft.dimensions}
    written = draft.with_values({name: value / units[name] for name, value in result.items()}).toml()
    whole = "".join(f"# {line}\n" for line in _head(calibration)) + "\n" + written
    try:
        again = loads(whole, "calibrated.toml")
    except SevenbarError as error:
        raise RequestError(
            "calibrate: the dimensions that explain these data best make no linkage, so nothing is written: "
            f"{error}"
        ) from None
    _check(again, calibration)
    return whole


def _check(linkage: Linkage, calibration: Calibration) -> None:
    """Raises `RequestError` where a linkage does not explain the rows as the calibration does."""
    before, ends = calibration.before, calibration.ends
    aside = {p.name: p.value for p in calibration.parameters}.get("output_offset", before.chosen.offset)
    values = {q: v - aside if q == "angle" else v for q, v in calibration.measured.items()}
    rows = Measured(calibration.source, calibration.line, {"input": calibration.input, **values})
    again = compare(linkage, rows, ends, speed=before.speed).chosen
    parts = [
        np.square((calibration.computed[q] - v) / ends.extent(q, v)) for q, v in calibration.measured.items()
    ]
    share = math.sqrt(float(np.mean(parts)))
    if again.open_rows or not again.residual <= share + AGREES:
        lines = f", and {again.open_rows} rows do not close" if again.open_rows else ""
        raise RequestError(
            "calibrate: the file, read again, does not explain the rows as the calibration does, so nothing "
            f"is written: residual {per_cent(again.residual)} of the measured range, not "
            f"{per_cent(share)}{lines}"
        )


def _head(calibration: Calibration) -> list[str]:
    intervals = f"Half widths of {100 * calibration.confidence:g} % intervals:"
    if calibration.exact:
        intervals = "Exact rows: no intervals."
    lines = [f"Calibrated by sevenbar from {calibration.source}, {len(calibration.line)} rows. {intervals}"]
    for p in calibration.calibrated:
        degrees = p.kind == "angle"
        value, reach = ((math.degrees(v) if degrees else v) for v in (p.value, (p.high - p.low) / 2))
        unit = {"angle": " deg", "number": ""}.get(p.kind, f" {calibration.ends.length_unit}")
        lines.append(f"  {p.name} = {value:.9g}{unit}" + ("" if calibration.exact else f", +- {reach:.2g}"))
    if held := calibration.held.text:
        lines.append(f"Held: {held}.")
    unidentified = [p.name for p in calibration.parameters if p.status == "unidentified"]
    if unidentified:
        lines.append(
            f"Held at nominal values, since the data do not identify them: {', '.join(unidentified)}."
        )
    if any(p.name.endswith("_offset") and p.status == "calibrated" for p in calibration.parameters):
        lines.append(
            "Input of the linkage = measured input + input_offset; measured output = output + output_offset."
        )
    # a name of a file may hold what a comment may not
    return ["".join(c if c.isprintable() else "?" for c in line) for line in lines]
