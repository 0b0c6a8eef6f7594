"""`python -m evidence.certainty`: whether anything is lost, by the thousand; writes docs/certainty.md.

With `--quick` a few of each family, and no page but where `--out` says.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from evidence import ROOT
from evidence.certainty import changes, counted, moving, narrow, nets, spatial_nets
from evidence.certainty.family import Row, judged
from evidence.certainty.page import line, written
from evidence.circumstances import circumstances

FAMILIES = {
    family.name: family
    for part in (narrow, counted, changes, moving, nets, spatial_nets)
    for family in part.FAMILIES
}

#: Cases that a process takes at once: few, so that a run that is stopped has met all families.
AT_ONCE = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; 1 where something did not hold."""
    parser = argparse.ArgumentParser(prog="python -m evidence.certainty", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a few linkages of each family")
    parser.add_argument("--share", type=float, default=1.0, help="part of each family's linkages")
    parser.add_argument("--minutes", type=float, help="stop then; the page is of what was done")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, metavar="FILE", help="the page; docs/certainty.md of a whole run")
    parser.add_argument("--again", nargs=2, metavar=("FAMILY", "CASE"), help="judge one case anew")
    given = parser.parse_args(arguments)
    if given.again:
        name, case = given.again
        if name not in FAMILIES or not case.isdigit():
            parser.error(f"--again: no case {case} of {name!r}; give a family of the table and a number")
        row = judged(FAMILIES[name], given.seed, int(case), int(case) + 1)
        _report(name, row)
        return int(bool(row.differences))
    counts = {
        name: family.quick if given.quick else max(1, round(given.share * family.count))
        for name, family in FAMILIES.items()
    }
    made = circumstances("mpmath", "scipy") | {"seed": given.seed}
    rows = {name: Row() for name in counts}
    start = time.monotonic()
    for name, row in _judged(counts, given.seed, given.processes):
        rows[name].merge(row)
        _report(name, row)
        if rows[name].linkages == counts[name]:
            print(line(name, rows[name]), flush=True)
        if given.minutes is not None and time.monotonic() - start > 60 * given.minutes:
            print(f"stopped after {given.minutes:g} minutes", flush=True)
            break
    place = given.out or (None if given.quick else ROOT / "docs" / "certainty.md")
    if place is not None:
        place.write_text(written(FAMILIES, rows, made), encoding="utf-8")
    return int(any(row.differences for row in rows.values()))


def _report(name: str, row: Row) -> None:
    for case, what in row.differences:
        print(f"{name}, case {case}: {what}", flush=True)


def _judged(counts: dict[str, int], seed: int, processes: int) -> Iterator[tuple[str, Row]]:
    """Rows of parts of the families, in turn, so that a run that is stopped has met them all."""
    parts = [
        (name, seed, first, min(first + AT_ONCE, count))
        for name, count in counts.items()
        for first in range(0, count, AT_ONCE)
    ]
    parts.sort(key=lambda part: part[2] / counts[part[0]])
    with ProcessPoolExecutor(processes) as pool:
        try:
            yield from zip((name for name, *_ in parts), pool.map(_part, parts), strict=True)
        finally:
            pool.shutdown(cancel_futures=True)


def _part(part: tuple[str, int, int, int]) -> Row:
    name, *rest = part
    return judged(FAMILIES[name], *rest)


if __name__ == "__main__":
    sys.exit(main())
