"""Elements of MJCF: how numbers and places are written."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.rigid import quaternion


def add(parent: Element, tag: str, **attributes: str) -> Element:
    """A new element at the end of another."""
    return SubElement(parent, tag, attributes)


def numbers(values: object) -> str:
    """Numbers with all their digits, a zero without its sign."""
    return " ".join(f"{float(value) + 0.0:.17g}" for value in np.asarray(values, dtype=float).reshape(-1))


def placed(frame: Floats, metre: float) -> dict[str, str]:
    """Where a frame (4, 4) is in its parent, lengths times `metre`."""
    return {"pos": numbers(frame[:3, 3] * metre), "quat": numbers(quaternion(frame[:3, :3]))}
