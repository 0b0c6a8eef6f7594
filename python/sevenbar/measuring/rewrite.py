"""A linkage file with calibrated dimensions: the same form, with every other key and all comments kept."""

from __future__ import annotations

import math

from sevenbar.description.draft import Draft
from sevenbar.measuring.calibrate import Calibration


def calibrated_toml(text: str, calibration: Calibration) -> str:
    """The TOML text of a linkage with its calibrated dimensions in place of the nominal ones.

    L2 of an RSSR is written out, since left out it would follow from the others. What the form has no key
    for, the zeros of the measured joints, stands in the comment above. Raises `MissingExtraError` without
    tomlkit.
    """
    draft = Draft.of(text, "calibrated.toml")
    found = {p.name: p.value for p in calibration.calibrated if not p.name.endswith("_offset")}
    if found and "L2" in calibration.linkage.dimensions:
        found = {"L2": calibration.parameter("L2").value} | found
    units = {dimension.name: dimension.scale for dimension in draft.dimensions}
    written = draft.with_values({name: value / units[name] for name, value in found.items()}).toml()
    return "".join(f"# {line}\n" for line in _head(calibration)) + "\n" + written


def _head(calibration: Calibration) -> list[str]:
    per_cent = f"{100 * calibration.confidence:g} %"
    lines = [
        f"Calibrated by sevenbar from {calibration.source}, {len(calibration.line)} rows. "
        f"Half widths of {per_cent} intervals:"
    ]
    for p in calibration.calibrated:
        degrees = p.kind == "angle"
        value, reach = ((math.degrees(v) if degrees else v) for v in (p.value, (p.high - p.low) / 2))
        unit = {"angle": " deg", "number": ""}.get(p.kind, f" {calibration.ends.length_unit}")
        lines.append(f"  {p.name} = {value:.9g}{unit}, +- {reach:.2g}")
    unidentified = [p.name for p in calibration.parameters if p.status == "untold"]
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
