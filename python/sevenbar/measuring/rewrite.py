"""A linkage file with calibrated dimensions: the same form, with every other key and all comments kept."""

from __future__ import annotations

import math
from typing import Any

from sevenbar.errors import MissingExtraError
from sevenbar.files import loads
from sevenbar.measuring.calibrate import Calibration, Parameter
from sevenbar.units import ANGLES


def calibrated_toml(text: str, calibration: Calibration) -> str:
    """The TOML text of a linkage with its calibrated dimensions in place of the nominal ones.

    L2 of an RSSR is written out, since left out it would follow from the others. What the form has no key
    for, the zeros of the measured joints, stands in the comment above. Raises `MissingExtraError` without
    tomlkit.
    """
    try:
        import tomlkit
    except ImportError:
        raise MissingExtraError(
            "calibrate needs scipy and tomlkit; install them with: pip install 'sevenbar[calibrate]'"
        ) from None
    document: Any = tomlkit.parse(text)
    angle = ANGLES[str(document.get("angle_unit", "deg"))]
    for parameter in calibration.calibrated:
        name, _, number = parameter.name.partition("_")
        if parameter.name.endswith("_offset"):
            continue
        if number:
            document["link"][int(number) - 1][name] = _written(parameter, angle)
        else:
            document["rssr"][name] = parameter.value
    if "rssr" in document and calibration.calibrated and "L2" not in document["rssr"]:
        document["rssr"]["L2"] = calibration.parameter("L2").value
    head = "".join(f"# {line}\n" for line in _head(calibration))
    written = head + "\n" + tomlkit.dumps(document)
    # what is written must be what was found
    loads(written, "calibrated.toml")
    return written


def _written(parameter: Parameter, angle: float) -> float:
    """A value in the file's unit."""
    if parameter.kind != "angle":
        return parameter.value
    return math.degrees(parameter.value) if angle != 1.0 else parameter.value


def _head(calibration: Calibration) -> list[str]:
    per_cent = f"{100 * calibration.confidence:g} %"
    lines = [
        f"Calibrated by sevenbar from {calibration.source}, {len(calibration.line)} rows. "
        f"Half widths of {per_cent} intervals:"
    ]
    for p in calibration.calibrated:
        degrees = p.kind == "angle"
        value, reach = ((math.degrees(v) if degrees else v) for v in (p.value, (p.high - p.low) / 2))
        unit = "deg" if degrees else calibration.ends.length_unit
        lines.append(f"  {p.name} = {value:.9g} {unit}, +- {reach:.2g}")
    untold = [p.name for p in calibration.parameters if p.status == "untold"]
    if untold:
        lines.append(f"Held at nominal values, since the data do not tell them: {', '.join(untold)}.")
    if any(p.name.endswith("_offset") and p.status == "calibrated" for p in calibration.parameters):
        lines.append(
            "Input of the linkage = measured input + input_offset; measured output = output + output_offset."
        )
    # a name of a file may hold what a comment may not
    return ["".join(c if c.isprintable() else "?" for c in line) for line in lines]
