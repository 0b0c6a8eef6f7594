"""Linkages of a part analysed one by one, which any linkage and any measure can be."""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import RequestError, SevenbarError, shown
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.measures import Measure, rows_of
from sevenbar.sweep.block import NO_CIRCUIT, OK, Block
from sevenbar.sweep.plan import SweepPlan

#: Measures of a linkage or circuit, by name.
Row = dict[str, float | int | str | None]


def analysed(plan: SweepPlan, values: Floats, first: int, which: Integers) -> Block:
    """The rows of some linkages of a part: `values` (axes, n) of all, the first one's number, and which.

    Raises `RequestError` for a function of the caller that does not take a motion.
    """
    measures = plan.measured
    limits = plan.limit_names
    linkage: list[int] = []
    status: list[str] = []
    rows: list[Row] = []
    for index in which:
        outcome: str = OK
        result: list[Row] = [{"circuit": None, **{measure.name: None for measure in measures}}]
        try:
            linkage_there = plan.draft_of(values[:, index]).linkage
            motion = linkage_there.motion(plan.samples, input=plan.input, output=plan.output)
        except SevenbarError as error:
            outcome = "; ".join(str(error).splitlines())
        else:
            result = list(_measured(motion, measures, first + int(index)))
            inputs = np.degrees(motion.limits)
            result = [row | dict(zip(limits, inputs, strict=False)) for row in result]
        linkage += [int(index)] * len(result)
        status += [outcome] * len(result)
        rows += result
    columns: dict[str, npt.NDArray[Any]] = {}
    for measure in measures:
        column = [row[measure.name] for row in rows]
        columns[measure.name] = np.array(column, dtype=object if measure.quantity == "word" else np.float64)
    for limit in limits:
        columns[limit] = np.array([row.get(limit) for row in rows], dtype=np.float64)
    circuit = [NO_CIRCUIT if row.get("circuit") is None else row["circuit"] for row in rows]
    return Block(
        np.array(linkage, dtype=np.int64),
        np.array(circuit, dtype=np.int64),
        np.array(status, dtype=object),
        columns,
    )


def seconds_of_one(plan: SweepPlan) -> float:
    """How long the design itself takes [s]; 0 where it cannot be measured."""
    try:
        # the first time imports count
        for _ in range(2):
            start = perf_counter()
            linkage = plan.draft.with_values({}).linkage
            rows_of(linkage.motion(plan.samples, input=plan.input, output=plan.output), plan.measured)
    except SevenbarError:
        return 0.0
    return perf_counter() - start


def _measured(motion: Motion, measures: tuple[Measure, ...], linkage: int) -> Iterator[Row]:
    """The measures of a motion, those of a caller's functions checked."""
    try:
        rows = rows_of(motion, measures)
    except Exception:
        for measure in measures:
            _check_function(motion, measure, linkage)
        raise
    for row in rows:
        for measure in measures:
            value = row[measure.name]
            fits = value is None or isinstance(value, int | float | np.number)
            if measure.quantity != "word" and not fits:
                what = f"{measure.name} gives {shown(value)} for linkage {linkage}"
                raise RequestError(f"measure: {what}; give a number or None")
        yield row


def _check_function(motion: Motion, measure: Measure, linkage: int) -> None:
    """Raises `RequestError` where a caller's function cannot take a motion."""
    try:
        rows_of(motion, [measure])
    except Exception as error:
        what = f"{type(error).__name__}: {error}".splitlines()[0]
        raise RequestError(
            f"measure: {measure.name} fails for linkage {linkage}: {what}; give a function of every Motion"
        ) from None
