"""The rows of a part of a sweep: measures of its linkages as a table, and that table as Parquet."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, of_extra, shown
from sevenbar.sweep.batches import batched
from sevenbar.sweep.block import NO_CIRCUIT, Block
from sevenbar.sweep.checked import MARK, sealed, to_seal
from sevenbar.sweep.ordinary import analysed
from sevenbar.sweep.plan import SweepPlan

if TYPE_CHECKING:
    import pyarrow as pa

#: How parts are packed: fixed, since their bits must not depend on defaults that change.
PACKING: dict[str, Any] = {
    "compression": "zstd",
    "compression_level": 3,
    "version": "2.6",
    # for other programs: here the checksum of the whole file is compared
    "write_page_checksum": True,
}

#: Most rows of a row group.
ROW_GROUP = 2**20


def need_pyarrow() -> None:
    """Raises `MissingExtraError` where Parquet cannot be written."""
    with of_extra("sweep", "a sweep's tables need pyarrow"):
        import pyarrow.parquet  # noqa: F401


def schema(plan: SweepPlan) -> pa.Schema:
    """Names with units and types of a sweep's columns, and its mark.

    Raises `RequestError` for a name that would appear twice.
    """
    import pyarrow as pa

    fields = [("linkage", pa.int64()), *((a.dimension.column, pa.float64()) for a in plan.space.axes)]
    fields.append(("status", pa.string()))
    if plan.per_circuit:
        fields.append(("circuit", pa.int32()))
    types = {"word": pa.string(), "count": pa.int32()}
    for measure in plan.measured:
        name = measure.column(plan.draft.linkage, plan.output)
        fields.append((name, types.get(measure.quantity, pa.float64())))
        if measure.name == "limits":
            fields += [(f"{limit}_deg", pa.float64()) for limit in plan.limit_names]
    names = [name for name, _ in fields]
    for name in names:
        if names.count(name) > 1:
            raise RequestError(
                f"measure: column {shown(name)} would appear twice in the table; "
                "give the function another name"
            )
    return pa.schema(fields, metadata={MARK: plan.digest()})


def part_table(plan: SweepPlan, part: int, threads: int = 1) -> pa.Table:
    """The rows of a part, by linkage and circuit."""
    linkages = plan.linkages(part)
    values = plan.space.values(linkages.start, linkages.stop)
    blocks, rest = batched(plan, values, threads)
    if len(rest) or not blocks:
        blocks.append(analysed(plan, values, linkages.start, rest))
    return _table(plan, linkages.start, values, Block.joined(blocks))


def part_bytes(plan: SweepPlan, part: int, threads: int = 1) -> bytes:
    """The Parquet file of a part: the same bits wherever it is made by the same `maker`."""
    import pyarrow.parquet as pq

    table = part_table(plan, part, threads)
    words = [field.name for field in table.schema if str(field.type) == "string"]
    sink = BytesIO()
    with pq.ParquetWriter(sink, table.schema, use_dictionary=words, **PACKING) as writer:
        writer.write_table(table, ROW_GROUP)
        writer.add_key_value_metadata(to_seal(part, plan.linkages(part)))
    return sealed(sink.getvalue())


def _table(plan: SweepPlan, first: int, values: Floats, block: Block) -> pa.Table:
    import pyarrow as pa

    linkage = block.linkage
    arrays: list[Any] = [linkage + first, *values[:, linkage], block.status]
    if plan.per_circuit:
        arrays.append(block.circuit.astype(np.float64))
        arrays[-1][arrays[-1] == NO_CIRCUIT] = np.nan
    for measure in plan.measured:
        names = (measure.name, *(plan.limit_names if measure.name == "limits" else ()))
        arrays += [block.columns[name] for name in names]
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
