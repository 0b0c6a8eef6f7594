"""`python -m evidence.fuzz.wild --loops 10000`: time and memory of loops, each in a process of its own.

Lattice loops and wild ones are drawn in turn: places and axes of whole numbers, rows of whole numbers, any
kinds in any order, worn examples. Each motion is asked in a child, whose processor time and greatest memory
the system counts. Printed are the slowest, the greatest, and all beyond the bounds; these go to `--out` as
they are drawn, one line of JSON each.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evidence.fuzz import loops
from evidence.rewritten.families import lattice
from sevenbar.description.forms import from_description
from sevenbar.errors import SevenbarError

#: What a loop may take: processor time [s] and memory of its process [bytes].
MOST_TIME, MOST_MEMORY = 10.0, 500e6

#: A child is ended after this processor time [s].
ENDED = 60

#: Inputs in a turn.
SAMPLES = 36

#: How many of the slowest and the greatest are printed.
SHOWN = 5

#: Loops between two lines on how far it is.
PRINTED = 500

#: Lengths, twists [deg] and offsets of rows in whole numbers.
WHOLE = (0, 1, 2), (0, 90, -90), (0, 0, 1)


@dataclass(frozen=True)
class Taken:
    """What one loop took: family and number, time [s], memory [bytes], and what it is or how it ended."""

    family: str
    index: int
    time: float
    memory: float
    word: str

    @property
    def beyond(self) -> bool:
        """Whether it took more than it may."""
        return self.time > MOST_TIME or self.memory > MOST_MEMORY


def _lattice(rng: np.random.Generator) -> dict[str, Any]:
    return {"format": 1, "joint": [joint.table() for joint in lattice(int(rng.integers(2**31)), 1).joints]}


def _whole_rows(rng: np.random.Generator) -> dict[str, Any]:
    """Seven rows of whole numbers and right angles."""
    lengths, twists, offsets = (rng.choice(numbers, 7).tolist() for numbers in WHOLE)
    rows = zip(lengths, twists, offsets, strict=True)
    return {"format": 1, "link": [{"length": a, "twist": t, "offset": d} for a, t, d in rows]}


#: How each kind of loop is drawn; half are lattice loops.
FAMILIES: dict[str, Callable[[np.random.Generator], dict[str, Any]]] = {
    "lattice": _lattice,
    "whole rows": _whole_rows,
    "lattice again": _lattice,
    "shuffled kinds": loops.shuffled,
    "lattice once more": _lattice,
    "round rows": loops.rows,
    "worn gallery": loops.worn,
    "screws": loops.SCREWS["screws"],
}


def drawn(index: int, seed: int) -> tuple[str, dict[str, Any]]:
    """The family of a loop and its description."""
    family = list(FAMILIES)[index % len(FAMILIES)]
    return family, FAMILIES[family](np.random.default_rng([seed, index]))


def word_of(description: dict[str, Any]) -> str:
    """The type of its motion with what it says of the search, or the refusal's first words."""
    try:
        motion = from_description(description).motion(SAMPLES)
    except SevenbarError as error:
        return f"refused: {str(error).partition(':')[0]}"
    left = motion.search.unfollowed
    return f"{motion.motion_type}, {motion.completeness}" + (f", {left} not followed" if left else "")


def taken(index: int, seed: int) -> Taken:
    """One loop in a child process."""
    family, description = drawn(index, seed)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        resource.setrlimit(resource.RLIMIT_CPU, (ENDED, ENDED + 1))
        signal.signal(signal.SIGXCPU, signal.SIG_DFL)
        try:
            os.write(writing, word_of(description).encode())
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
    os.close(writing)
    with os.fdopen(reading, encoding="utf-8") as pipe:
        word = pipe.read()
    _, status, used = os.wait4(child, 0)
    memory = used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    ended = os.waitstatus_to_exitcode(status)
    return Taken(family, index, used.ru_utime + used.ru_stime, memory, word or f"ended with {ended}")


def shown(one: Taken) -> str:
    """A line."""
    return f"{one.family} {one.index}: {one.time:.1f} s, {one.memory / 1e6:.0f} MB, {one.word}"


def main(given: Sequence[str] | None = None) -> int:
    """Draws and measures; 1 where a loop took more than it may."""
    parser = argparse.ArgumentParser(prog="python -m evidence.fuzz.wild", description=__doc__)
    parser.add_argument("--loops", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first loop")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="file for the loops beyond the bounds, JSON lines")
    asked = parser.parse_args(given)
    # what is imported late is imported once, before the first child
    word_of(loops.rows(np.random.default_rng(0)))
    found: list[Taken] = []
    for index in range(asked.first, asked.first + asked.loops):
        one = taken(index, asked.seed)
        found.append(one)
        if one.beyond or one.word.startswith("ended"):
            print(shown(one), flush=True)
            if asked.out:
                line = {**asdict(one), "description": drawn(index, asked.seed)[1]}
                with asked.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(line) + "\n")
        if len(found) % PRINTED == 0:
            print(f"{len(found)} loops, slowest {max(one.time for one in found):.1f} s", flush=True)
    for what, key in (("slowest", lambda one: one.time), ("greatest", lambda one: one.memory)):
        print(what, *map(shown, sorted(found, key=key, reverse=True)[:SHOWN]), sep="\n  ")
    beyond = sum(one.beyond for one in found)
    print(f"{len(found)} loops, {beyond} beyond {MOST_TIME:g} s or {MOST_MEMORY / 1e6:g} MB")
    return int(beyond > 0)


if __name__ == "__main__":
    sys.exit(main())
