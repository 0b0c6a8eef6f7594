"""`python -m evidence.rewritten`: one linkage in many ways, every answer compared; writes docs/rewritten.md.

With `--record FILE` each linkage is kept in the file once it is compared, and what the file holds is not
compared again: `--loops 300` compares so many more of the lattice, the same command once more the next, and
the page is written of all that is kept. `--only NAME` takes the families whose names hold it, and prints
every difference and no page, except where `--out` says.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from evidence import ROOT
from evidence.circumstances import circumstances
from evidence.rewritten.answers import Answers, answers_of, differences
from evidence.rewritten.drawing import Drawing
from evidence.rewritten.families import LATTICE, families, lattice
from evidence.rewritten.page import Compared, keep, recorded, written
from evidence.rewritten.reasons import reason
from evidence.rewritten.ways import ways
from sevenbar.errors import SevenbarError

#: Loops of the lattice that a process takes at once.
AT_ONCE = 5


def compared(one: Drawing, seed: int) -> Compared:
    """A drawing in all ways."""
    start, first, found = time.process_time(), None, Compared(one.name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for way in ways(one, np.random.default_rng(seed)):
            found.ways += 1
            try:
                answers = answers_of(way)
            except SevenbarError as error:
                idle = len(way.linkage.idle)
                words: dict[str, object] = {"refused": type(error).__name__, "idle": idle}
                answers = Answers(words, [], [], {}, False, refused=str(error).partition(":")[0])
            if first is None:
                first = answers
                found.moves = bool(answers.circuits)
                continue
            for difference in differences(way, first, answers):
                if why := reason(way, first, answers, difference):
                    found.explained.setdefault(why, []).append(difference)
                else:
                    found.differences.append(difference)
    found.seconds = time.process_time() - start
    return found


def _family(name: str, seed: int) -> list[Compared]:
    return [compared(families()[name](), seed)]


def _lattice(indices: Sequence[int], seed: int) -> list[Compared]:
    return [compared(lattice(index, seed), seed) for index in indices]


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; 1 where answers differ without a reason."""
    parser = argparse.ArgumentParser(prog="python -m evidence.rewritten", description=__doc__)
    parser.add_argument("--loops", type=int, default=LATTICE, help="most loops of the lattice in this run")
    parser.add_argument("--first", type=int, default=0, help="number of the lattice's first loop")
    parser.add_argument("--only", default="", help="families whose names hold this, and no lattice")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--record", type=Path, metavar="FILE", help="keeps what is compared, JSON lines")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="the page; docs/rewritten.md of all families"
    )
    given = parser.parse_args(arguments)
    made = circumstances("scipy") | {"seed": given.seed}
    rows = recorded(given.record)
    names = [name for name in families() if given.only in name and name not in rows]
    known = {one.name for one in rows.get("lattice", ())}
    left = [index for index in range(given.first, LATTICE) if f"lattice {index}" not in known]
    indices = [] if given.only else left[: given.loops]
    with ProcessPoolExecutor(given.processes) as pool:
        for name, found in _in_order(pool, names, indices, given.seed):
            rows.setdefault(name, []).extend(found)
            for one in found:
                if given.record:
                    keep(given.record, name, one)
                for line in [*one.differences, *(one.with_reason() if given.only else ())]:
                    print(f"{one.name if name == 'lattice' else name}: {line}", flush=True)
    out = given.out or (None if given.only else ROOT / "docs/rewritten.md")
    page = written(rows, made)
    if out is None:
        print(page)
    else:
        out.write_text(page, encoding="utf-8")
    return int(any(one.differences for found in rows.values() for one in found))


def _in_order(
    pool: ProcessPoolExecutor, names: Sequence[str], indices: Sequence[int], seed: int
) -> Iterator[tuple[str, list[Compared]]]:
    yield from zip(names, pool.map(partial(_family, seed=seed), names), strict=True)
    pieces = [indices[k : k + AT_ONCE] for k in range(0, len(indices), AT_ONCE)]
    yield from (("lattice", found) for found in pool.map(partial(_lattice, seed=seed), pieces))


if __name__ == "__main__":
    sys.exit(main())
