"""Points of the unit cube by their index alone, so that any part of a sweep can be made anywhere.

Random numbers are the words of a counter (Philox), Sobol points come from scipy, moved forward: nothing is
stored, whatever the count.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import of_extra

#: Words of 64 bits that a step of Philox's counter gives.
WORDS_A_STEP = 4

#: Bits of a double's fraction: a number in [0, 1) has as many.
BITS = 53

#: Points that scipy's engine has: its numbers have 30 bits.
MOST_SOBOL = 2**30


def random_points(seed: int, axes: int, first: int, stop: int) -> Floats:
    """Independent random points `first` to `stop` (axes, n), each number in [0, 1)."""
    word, count = first * axes, (stop - first) * axes
    step, skipped = divmod(word, WORDS_A_STEP)
    key = np.random.SeedSequence([seed, 0]).generate_state(2, np.uint64)
    stream = np.random.Philox(key=key, counter=[step, 0, 0, 0])
    words = np.asarray(stream.random_raw(skipped + count), dtype=np.uint64)[skipped:]
    numbers = (words >> np.uint64(64 - BITS)).astype(np.float64) * 2.0**-BITS
    return np.ascontiguousarray(numbers.reshape(-1, axes).T)


class _Engine(threading.local):
    """The Sobol engine of a thread: moved forward from part to part, which is quicker than from the start."""

    key: tuple[int, int] | None = None
    engine: Any = None


_ENGINE = _Engine()


def sobol_points(seed: int, axes: int, first: int, stop: int) -> Floats:
    """Points `first` to `stop` (axes, n) of a scrambled Sobol sequence.

    Raises `MissingExtraError` without scipy. Source: Joe and Kuo's direction numbers, Owen's scrambling.
    """
    with of_extra("sweep", "Sobol samples need scipy"):
        from scipy.stats import qmc
    engine = _ENGINE.engine
    if engine is None or _ENGINE.key != (seed, axes) or engine.num_generated > first:
        engine = qmc.Sobol(axes, scramble=True, seed=np.random.default_rng(seed))
        _ENGINE.key, _ENGINE.engine = (seed, axes), engine
    if first > engine.num_generated:
        engine.fast_forward(first - engine.num_generated)
    count = stop - first
    # the engine warns of a first draw that is no power of two
    drawn = 1 << (count - 1).bit_length() if first == 0 else count
    return np.ascontiguousarray(engine.random(drawn)[:count].T)
