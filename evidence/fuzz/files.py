"""Mutated files through the loader: a linkage, or one message that helps."""

from __future__ import annotations

import random
from collections import Counter
from functools import cache

import numpy as np

import sevenbar as sb
from evidence.fuzz.checks import hold, judged
from evidence.fuzz.messages import family, look_at
from evidence.fuzz.mutations import mutated, seeds
from sevenbar.description.files import decoded
from sevenbar.errors import SevenbarError

#: Of the files that load, one in so many has its mobility counted, and one in so many is analysed whole.
COUNTED, ANALYSED = 200, 2000

#: The name of a file in messages.
SOURCE = "f.toml"

_seeds = cache(seeds)


def drawn(seed: int, index: int) -> bytes | str:
    """The mutated file of a number."""
    return mutated(random.Random((seed << 40) + index), _seeds())


def judge(content: bytes | str, index: int, seen: Counter[str]) -> None:
    """Loads a file; counts in `seen` what it came to. Raises `Broken`, or what the loader raises wrongly."""
    try:
        linkage = sb.loads(content if isinstance(content, str) else decoded(content, SOURCE), SOURCE)
    except SevenbarError as error:
        look_at(error, SOURCE)
        seen[f"refused {family(error, SOURCE)}"] += 1
        return
    seen["loaded"] += 1
    hold(np.isfinite(linkage.transforms).all(), "a linkage with a transform that is no number")
    if index % COUNTED and index % ANALYSED:
        return
    try:
        if index % ANALYSED:
            seen[f"mobility {linkage.mobility().finite}"] += 1
        else:
            seen[f"type {judged(linkage, np.random.default_rng(index), Counter())}"] += 1
    except SevenbarError as error:
        look_at(error, "")
        seen[f"not analysed: {family(error, '')}"] += 1
