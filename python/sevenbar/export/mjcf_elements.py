"""Elements of MJCF: how numbers, places and sites are written."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.export.prototype import Prototype
from sevenbar.kinematics.loop.rigid import quaternion
from sevenbar.text.units import LENGTHS

#: Radius of the sites that springs end at, as a part of the linkage's size.
SITE = 0.008


def add(parent: Element, tag: str, **attributes: str) -> Element:
    """A new element at the end of another."""
    return SubElement(parent, tag, attributes)


def numbers(values: object) -> str:
    """Numbers with all their digits, a zero without its sign."""
    return " ".join(f"{float(value) + 0.0:.17g}" for value in np.asarray(values, dtype=float).reshape(-1))


def placed(frame: Floats, metre: float) -> dict[str, str]:
    """Where a frame (4, 4) is in its parent, lengths times `metre`."""
    return {"pos": numbers(frame[:3, 3] * metre), "quat": numbers(quaternion(frame[:3, :3]))}


def mark(element: Element, name: str, frame: Floats, model: Prototype) -> None:
    """A site at a frame of a body, or of the ground."""
    metre = LENGTHS[model.length_unit]
    add(element, "site", name=name, size=f"{SITE * model.size * metre:.6g}", **placed(frame, metre))
