"""The screw axes of links, and the instant centres of a planar loop, as a table and a page."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.console import Group, RenderableType
from rich.text import Text

from sevenbar.arrays import Floats, counted
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.loop.columns import joint_column
from sevenbar.kinematics.loop.screw_axes import ScrewAxes
from sevenbar.reporting.files import Report, columns_file, head_of, json_file
from sevenbar.reporting.page import number_table
from sevenbar.reporting.shown import REST, drive_text

#: The file with every row.
TABLE = "axodes.csv"


def axodes_report(links: Sequence[int], relative_to: int | None) -> Report[Motion]:
    """How the screw axes of some links of a motion are reported, against the ground or one link."""
    as_dict = partial(_as_dict, links, relative_to)
    files = {
        "axodes.json": json_file(as_dict),
        TABLE: columns_file(partial(axode_columns, links, relative_to)),
    }
    return Report(partial(_text, links, relative_to), as_dict, files)


def axode_columns(
    links: Sequence[int], relative_to: int | None, motion: Motion
) -> dict[str, npt.NDArray[np.generic]]:
    """Every row of every circuit: the input, the screw axis of each link, of a planar loop all centres.

    >>> import sevenbar as sb
    >>> columns = axode_columns([2], None, sb.load("planar_4r").motion(24))
    >>> list(columns)[:6]
    ['circuit', 'branch', 'sample', 'theta_1_deg', 'link2_status', 'link2_point_x_mm']
    """
    linkage = motion.linkage
    slides = not linkage.turns(motion.input)
    head = joint_column(motion.input, slides=slides, order=0, length=linkage.length_unit, angle="deg")
    parts = []
    for circuit in motion:
        columns: dict[str, npt.NDArray[np.generic]] = {
            "circuit": np.full(len(circuit.time), circuit.index),
            "branch": circuit.branch,
            "sample": np.arange(len(circuit.time)),
            head: circuit.input if slides else np.degrees(circuit.input),
        }
        for link in links:
            name = f"link{link}" if relative_to is None else f"link{link}_to_{relative_to}"
            for key, values in circuit.screw_axes(link, relative_to).columns(linkage.length_unit).items():
                columns[f"{name}_{key}"] = values
        if linkage.is_planar:
            columns |= circuit.instant_centres().columns(linkage.length_unit)
        parts.append(columns)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]} if parts else {}


def _ranges(axes: ScrewAxes) -> dict[str, tuple[float, float] | None]:
    """The least and greatest pitch, rate and slide rate, `None` without one."""

    def ends(values: Floats) -> tuple[float, float] | None:
        known = values[np.isfinite(values)]
        return (float(known.min()), float(known.max())) if known.size else None

    return {name: ends(getattr(axes, name)) for name in ("pitch", "rate", "slide_rate")}


def _as_dict(links: Sequence[int], relative_to: int | None, motion: Motion) -> dict[str, Any]:
    linkage = motion.linkage
    return {
        **head_of(linkage),
        "relative_to": linkage.graph.ground if relative_to is None else relative_to,
        "circuits": [
            {
                "links": [
                    {"link": link, "statuses": counted(axes.status), **_ranges(axes)}
                    for link, axes in ((n, circuit.screw_axes(n, relative_to)) for n in links)
                ]
            }
            for circuit in motion
        ],
    }


def _text(links: Sequence[int], relative_to: int | None, motion: Motion) -> RenderableType:
    linkage = motion.linkage
    unit = linkage.length_unit
    other = "the ground" if relative_to in (None, linkage.graph.ground) else linkage.link_name(relative_to)
    heads = ("link", "circuit", "axis", f"pitch\n[{unit}/rad]", "rate\n[rad/s]", f"slide rate\n[{unit}/s]")
    rows = []
    for link in links:
        for circuit in motion:
            axes = circuit.screw_axes(link, relative_to)
            ranges = _ranges(axes)
            fastest = circuit.size * max(ranges["rate"] or (0.0,))
            scale = {"pitch": circuit.size, "rate": 0.0, "slide_rate": fastest}
            cells = [_range(ranges[name], REST * size) for name, size in scale.items()]
            words = ", ".join(f"{n} {word}" for word, n in counted(axes.status).items())
            rows.append((linkage.link_label(link), f"{circuit.index}", words, *cells))
    title = Text(linkage.heading, style="bold underline")
    drive = drive_text(motion.input, motion.speed, linkage.unit_of(motion.input))
    facts = Text(f"screw axes against {other}, {drive}; --out writes all rows")
    if not motion.circuits:
        return Group(title, Text(f"motion type {motion.motion_type}: no circuit to have axes"))
    return Group(title, facts, Text(), number_table(heads, rows, words=(2,)))


def _range(ends: tuple[float, float] | None, rounding: float) -> str:
    if ends is None:
        return "-"
    low, high = (0.0 if abs(x) <= rounding else x for x in ends)
    return f"{low:.6g}" if f"{low:.6g}" == f"{high:.6g}" else f"{low:.6g} to\n{high:.6g}"
