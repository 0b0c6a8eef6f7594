"""Angles that may have been written in another unit: a doubt, which the answer does not wait for."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Any

from sevenbar.description.written import entries
from sevenbar.errors import AngleUnitWarning
from sevenbar.text.units import ANGLES

#: The greatest twist [deg] of a file is more likely in radians between these: pi is 3.14, and links whose
#: axes all lean by less than 0.1 rad are rare.
LEAST_DEG, MOST_DEG = 0.1, 3.2


def angle_doubt(description: Mapping[str, Any]) -> str:
    """Why the twists of Denavit-Hartenberg rows may be in another unit, in words; empty where nothing is odd.

    >>> angle_doubt({"angle_unit": "rad", "link": [{"twist": 1.5}, {"twist": 80}]})
    'twist of link 2 is 80 rad, more than a turn; is it in degrees?'
    """
    unit = str(description.get("angle_unit", "deg"))
    rows = [row.get("twist", 0.0) for row in entries(description, "link")]
    twists = {i: float(x) for i, x in enumerate(rows, 1) if isinstance(x, int | float)}
    for link, twist in twists.items():
        if abs(twist) * ANGLES.get(unit, 1.0) > math.tau * (1 + 1e-12):
            doubt = f"twist of link {link} is {twist:.6g} {unit}, more than a turn"
            return f"{doubt}; is it in degrees?" if unit == "rad" else doubt
    turned = [abs(twist) for twist in twists.values() if twist]
    # one alone may be an error of a parallel axis
    if unit == "deg" and len(turned) > 1 and LEAST_DEG <= max(turned) < MOST_DEG:
        return f"all twists are at most {max(turned):.6g} deg; are they in radians?"
    return ""


def warn_of_angles(description: Mapping[str, Any], source: str = "") -> None:
    """Warns with `AngleUnitWarning` where the unit of angles is in doubt; `source` is the file, if any."""
    doubt = angle_doubt(description)
    if not doubt:
        return
    unit = description.get("angle_unit", "deg")
    text = (
        f'{source}: {doubt} (angle_unit is "{unit}")'
        if source
        else f"{doubt} (numbers are in radians; '80 deg' is a text with its unit)"
    )
    warnings.warn(text, AngleUnitWarning, stacklevel=4)
