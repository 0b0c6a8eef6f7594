"""A finished sweep: its description, its rows part by part, and their totals."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sevenbar.errors import OutputError, RequestError, of_extra
from sevenbar.sweep.block import OK
from sevenbar.sweep.parts import parts_there, read_description, read_part
from sevenbar.sweep.rows import need_pyarrow
from sevenbar.text.printing import Printed, lines, text_of

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

#: Size in bytes beyond which a sweep is not put into one table: a desk machine's memory is a few times that.
LARGEST_TABLE = 4 * 2**30


@dataclass(frozen=True)
class Range:
    """The lowest and highest value of a column, the linkages that have them, and how many rows have one."""

    lowest: float
    lowest_at: int
    highest: float
    highest_at: int
    rows: int


@dataclass(frozen=True)
class Totals:
    """Totals of the rows of a sweep: counts of linkages and ranges of measures, by column."""

    linkages: int
    rows: int
    invalid: int
    words: Mapping[str, Mapping[str, int]]
    ranges: Mapping[str, Range | None]


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Printed):
    """A sweep with all its parts: `description` is what `sweep.json` holds.

    `folder` is where the parts lie, `None` for a sweep in memory.
    """

    description: Mapping[str, Any]
    folder: Path | None
    contents: Sequence[bytes] = ()

    @staticmethod
    def of_folder(folder: str | Path) -> Sweep:
        """The sweep that a folder holds.

        Raises `OutputError` for a folder that holds none, or not all of its parts yet.
        """
        need_pyarrow()
        path = Path(folder)
        description = read_description(path)
        there, parts = len(parts_there(path)), description["parts"]
        if there != parts:
            raise OutputError(f"{path}: {there} of {parts} parts are there; finish it with --resume")
        return Sweep(description, path)

    @property
    def parts(self) -> Iterator[pa.Table]:
        """The rows (a pyarrow Table) of each part, in the order of the linkages; one in memory at a time.

        Raises `OutputError` for a part that is damaged or out of its place.
        """
        return self._read(())

    def _read(self, without: Collection[str]) -> Iterator[pa.Table]:
        """The rows of each part, without some columns."""
        import pyarrow.parquet as pq

        for part in range(self.description["parts"]):
            there = self.folder
            content = self.contents[part] if there is None else read_part(there, part, self.description)
            # not as a data set, which would guess columns from the path; nor by threads of pyarrow, which may
            # still let go of the content when Python ends, and then abort it
            with pq.ParquetFile(BytesIO(content), pre_buffer=False) as file:
                names = [name for name in file.schema_arrow.names if name not in without]
                yield file.read(names, use_threads=False)

    def table(self) -> pa.Table:
        """All rows in one pyarrow Table; raises `RequestError` for more than memory should hold."""
        import pyarrow as pa

        tables: list[pa.Table] = []
        size = 0
        for table in self.parts:
            tables.append(table)
            size += table.nbytes
            if size > LARGEST_TABLE:
                raise RequestError(
                    f"table: the rows of {self.description['linkages']} linkages take more than "
                    f"{LARGEST_TABLE / 2**30:g} GiB; read them part by part, or with DuckDB"
                )
        return pa.concat_tables(tables).replace_schema_metadata(None)

    def frame(self) -> pd.DataFrame:
        """All rows in one pandas table (extra `[frame]`); as `table` for the rest."""
        with of_extra("frame", "frame needs pandas"):
            import pandas  # noqa: F401
        frame: pd.DataFrame = self.table().to_pandas()
        return frame

    @cached_property
    def totals(self) -> Totals:
        """Counts and ranges of all rows, read part by part."""
        import pyarrow.compute as pc

        dimensions = {axis["column"] for axis in self.description["dimensions"]}
        linkages = rows = invalid = 0
        words: dict[str, Counter[str]] = {}
        ranges: dict[str, Range | None] = {}
        for table in self._read(dimensions):
            linkage = table["linkage"].to_numpy()
            firsts = np.flatnonzero(np.diff(linkage, prepend=-1))
            linkages, rows = linkages + len(firsts), rows + len(linkage)
            ok = pc.equal(table["status"], OK).to_numpy()
            invalid += int(np.count_nonzero(~ok[firsts]))
            for field in table.schema:
                if field.name in {"linkage", "status", "circuit"}:
                    continue
                if str(field.type) == "string":
                    # a word of a circuit is counted by circuits, one of a linkage once
                    column = table[field.name]
                    counted = column if field.name == "circuit_type" else column.take(firsts)
                    counts = dict(zip(*counted.drop_null().value_counts().flatten(), strict=True))
                    named = {word.as_py(): count.as_py() for word, count in counts.items()}
                    words.setdefault(field.name, Counter()).update(named)
                else:
                    numbers = table[field.name].to_numpy(zero_copy_only=False).astype(np.float64)
                    ranges[field.name] = _wider(ranges.get(field.name), numbers, linkage)
        plain = {name: dict(counts) for name, counts in words.items()}
        return Totals(linkages, rows, invalid, plain, ranges)


def _wider(known: Range | None, numbers: Any, linkage: Any) -> Range | None:
    """A range with more values, the first linkage of equal ones."""
    there = np.flatnonzero(~np.isnan(numbers))
    if not there.size:
        return known
    low, high = there[np.argmin(numbers[there])], there[np.argmax(numbers[there])]
    own = Range(float(numbers[low]), int(linkage[low]), float(numbers[high]), int(linkage[high]), there.size)
    if known is None:
        return own
    lower = min(known, own, key=lambda r: r.lowest)
    higher = max(known, own, key=lambda r: r.highest)
    rows = known.rows + own.rows
    return Range(lower.lowest, lower.lowest_at, higher.highest, higher.highest_at, rows)


@text_of.register(Sweep)
def _(sweep: Sweep) -> str:
    about = sweep.description
    sampling = about["sampling"]
    return lines(
        f"Sweep of {about['linkages']} linkages",
        [
            ("dimensions", ", ".join(axis["column"] for axis in about["dimensions"])),
            ("method", sampling["method"]),
            ("seed", "" if sampling["seed"] is None else str(sampling["seed"])),
            ("measures", ", ".join(m if isinstance(m, str) else m["name"] for m in about["measures"])),
            ("folder", "none, in memory" if sweep.folder is None else str(sweep.folder)),
        ],
    )
