"""The rows of a part of a sweep: measures of its linkages as a table, and that table as Parquet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sevenbar.draft import Draft
from sevenbar.errors import MissingExtraError, RequestError, SevenbarError, shown
from sevenbar.measures import Measure, rows_of
from sevenbar.motion import Floats, Integers, Motion
from sevenbar.sweep.plan import Plan

if TYPE_CHECKING:
    import pyarrow as pa

#: The status of a linkage that was measured.
OK = "ok"

#: What stands in `circuit` of a linkage that has none.
NO_CIRCUIT = -1

#: Limits of an RSSR's input: the zeros of a quartic.
MOST_LIMITS = 4

#: The key in a Parquet file's own words under which the sweep's mark stands.
MARK = b"sevenbar.sweep"

#: How parts are packed: fixed, since their bits must not depend on defaults that change.
PACKING: dict[str, Any] = {
    "compression": "zstd",
    "compression_level": 3,
    "version": "2.6",
    "row_group_size": 2**20,
}


#: Measures of a linkage or circuit, by name.
Row = dict[str, float | int | str | None]


@dataclass(frozen=True, eq=False)
class Block:
    """Rows of linkages, in any order: the linkage by its place in the part, its circuit, status and measures.

    Numbers are floats (r,), NaN where there is none; words are objects (r,), `None` where there is none.
    """

    linkage: Integers
    circuit: Integers
    status: npt.NDArray[np.object_]
    columns: dict[str, npt.NDArray[Any]]


def need_pyarrow() -> None:
    """Raises `MissingExtraError` where Parquet cannot be written."""
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        raise MissingExtraError(
            "a sweep's tables need pyarrow; install it with: pip install 'sevenbar[sweep]'"
        ) from None


def per_circuit(measures: tuple[Measure, ...]) -> bool:
    """Whether a linkage has a row for each of its circuits."""
    return any(measure.per == "circuit" for measure in measures)


def limit_names(plan: Plan) -> tuple[str, ...]:
    """Columns that hold the limits themselves, where those are asked for: of an RSSR at most four."""
    if "limits" not in plan.measures or plan.draft.linkage.kind != "RSSR":
        return ()
    return tuple(f"limit_{place}" for place in range(1, MOST_LIMITS + 1))


def schema(plan: Plan) -> pa.Schema:
    """Names with units and types of a sweep's columns, and its mark.

    Raises `RequestError` for a name that would stand twice.
    """
    import pyarrow as pa

    linkage, measures = plan.draft.linkage, plan.measured
    fields = [("linkage", pa.int64()), *((a.dimension.column, pa.float64()) for a in plan.space.axes)]
    fields.append(("status", pa.string()))
    if per_circuit(measures):
        fields.append(("circuit", pa.int32()))
    types = {"word": pa.string(), "count": pa.int32()}
    for measure in measures:
        name = measure.column(linkage, plan.output)
        fields.append((name, types.get(measure.quantity, pa.float64())))
        if measure.name == "limits":
            fields += [(f"{limit}_deg", pa.float64()) for limit in limit_names(plan)]
    names = [name for name, _ in fields]
    for name in names:
        if names.count(name) > 1:
            raise RequestError(
                f"measure: column {shown(name)} would stand twice in the table; "
                "give the function another name"
            )
    return pa.schema(fields, metadata={MARK: plan.digest()})


def part_table(plan: Plan, part: int) -> pa.Table:
    """The rows of a part, by linkage and circuit."""
    linkages = plan.linkages(part)
    values = plan.space.values(linkages.start, linkages.stop)
    return _table(
        plan, linkages.start, values, _ordinary(plan, values, linkages.start, np.arange(len(linkages)))
    )


def part_bytes(plan: Plan, part: int) -> bytes:
    """The Parquet file of a part: the same bits wherever it is made by the same `maker`."""
    import pyarrow.parquet as pq

    table = part_table(plan, part)
    words = [field.name for field in table.schema if str(field.type) == "string"]
    sink = BytesIO()
    pq.write_table(table, sink, use_dictionary=words, **PACKING)
    return sink.getvalue()


def _table(plan: Plan, first: int, values: Floats, block: Block) -> pa.Table:
    import pyarrow as pa

    order = np.lexsort((block.circuit, block.linkage))
    linkage = block.linkage[order]
    arrays: list[Any] = [linkage + first, *values[:, linkage], block.status[order]]
    if per_circuit(plan.measured):
        arrays.append(block.circuit[order].astype(np.float64))
        arrays[-1][arrays[-1] == NO_CIRCUIT] = np.nan
    for measure in plan.measured:
        names = (measure.name, *(limit_names(plan) if measure.name == "limits" else ()))
        arrays += [block.columns[name][order] for name in names]
    wanted = schema(plan)
    columns = [_array(array, field.type) for array, field in zip(arrays, wanted, strict=True)]
    return pa.Table.from_arrays(columns, schema=wanted)


def _array(values: npt.NDArray[Any], kind: Any) -> pa.Array:
    """An array of a column's type, null where a number is NaN."""
    import pyarrow as pa

    if values.dtype == object or values.dtype.kind == "i":
        return pa.array(values, type=kind)
    missing = np.isnan(values)
    if pa.types.is_integer(kind):
        values = np.where(missing, 0.0, values).astype(np.int32)
    return pa.array(values, type=kind, mask=missing)


def _ordinary(plan: Plan, values: Floats, first: int, which: Integers) -> Block:
    """The rows of some linkages of a part, each analysed by itself."""
    measures = plan.measured
    limits = limit_names(plan)
    linkage: list[int] = []
    status: list[str] = []
    rows: list[Row] = []
    for index in which:
        told, found = OK, _nothing(measures)
        try:
            motion = _motion(plan, values[:, index])
        except SevenbarError as error:
            told = "; ".join(str(error).splitlines())
        else:
            found = list(_measured(motion, measures, first + int(index)))
            inputs = np.degrees(motion.limits)
            found = [row | dict(zip(limits, inputs, strict=False)) for row in found]
        linkage += [int(index)] * len(found)
        status += [told] * len(found)
        rows += found
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


def _nothing(measures: tuple[Measure, ...]) -> list[Row]:
    row: Row = {"circuit": None, **{measure.name: None for measure in measures}}
    return [row]


def _motion(plan: Plan, values: Floats) -> Motion:
    draft: Draft = plan.draft
    for axis, value in zip(plan.space.axes, values, strict=True):
        draft = draft.with_value(axis.dimension.place, draft.written(axis.dimension, float(value)))
    return draft.linkage.motion(plan.samples, input=plan.input, output=plan.output)


def _measured(motion: Motion, measures: tuple[Measure, ...], linkage: int) -> Iterator[Row]:
    """The measures of a motion, those of a caller's functions looked at."""
    try:
        rows = rows_of(motion, measures)
    except Exception:
        for measure in measures:
            _told_of(motion, measure, linkage)
        raise
    for row in rows:
        for measure in measures:
            value = row[measure.name]
            fits = value is None or isinstance(value, int | float | np.number)
            if measure.quantity != "word" and not fits:
                told = f"{measure.name} gives {shown(value)} for linkage {linkage}"
                raise RequestError(f"measure: {told}; give a number or None")
        yield row


def _told_of(motion: Motion, measure: Measure, linkage: int) -> None:
    """Raises `RequestError` where a caller's function cannot take a motion."""
    try:
        rows_of(motion, [measure])
    except Exception as error:
        told = f"{type(error).__name__}: {error}".splitlines()[0]
        raise RequestError(
            f"measure: {measure.name} fails for linkage {linkage}: {told}; give a function of every Motion"
        ) from None
