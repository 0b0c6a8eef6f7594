"""Points of the unit cube by their index alone, so that any part of a sweep can be made anywhere.

Random numbers are the words of a counter (Philox), a Latin hypercube's permutations are Feistel networks on
the index, Sobol points come by scipy's engine moved forward: nothing is stored, whatever the count.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import MissingExtraError

Words = npt.NDArray[np.uint64]

#: Words of 64 bits that a step of Philox's counter gives.
WORDS_A_STEP = 4

#: Bits of a double's fraction: a number in [0, 1) has as many.
BITS = 53

#: Rounds of a Feistel network; four make a permutation that is hard to tell from chance (Luby and Rackoff).
ROUNDS = 8

#: Points that scipy's engine has: its numbers have 30 bits.
MOST_SOBOL = 2**30


def random_points(seed: int, axes: int, first: int, stop: int) -> Floats:
    """Independent random points `first` to `stop` (axes, n), each number in [0, 1)."""
    word, count = first * axes, (stop - first) * axes
    step, skipped = divmod(word, WORDS_A_STEP)
    stream = np.random.Philox(key=_key(seed, 0, 2), counter=[step, 0, 0, 0])
    words: Words = np.asarray(stream.random_raw(skipped + count), dtype=np.uint64)[skipped:]
    numbers = (words >> np.uint64(64 - BITS)).astype(np.float64) * 2.0**-BITS
    return np.ascontiguousarray(numbers.reshape(-1, axes).T)


def latin_points(seed: int, axes: int, first: int, stop: int, count: int) -> Floats:
    """Points `first` to `stop` (axes, n) of a Latin hypercube of `count`: one in each of `count` slices."""
    index = np.arange(first, stop, dtype=np.uint64)
    cells = np.stack([_permuted(index, count, _key(seed, 1 + axis, ROUNDS)) for axis in range(axes)])
    points = (cells.astype(np.float64) + random_points(seed, axes, first, stop)) / count
    # a number next to 1 would be rounded up into the slice after
    return np.minimum(points, 1 - 2.0**-BITS)


def _permuted(index: Words, count: int, keys: Words) -> Words:
    """The places (n,) of indices in a permutation of 0 .. count - 1: Feistel rounds until within."""
    half = np.uint64(max(1, ((count - 1).bit_length() + 1) // 2))
    low = (np.uint64(1) << half) - np.uint64(1)

    def once(values: Words) -> Words:
        left, right = values >> half, values & low
        for key in keys:
            left, right = right, left ^ (_mixed(right + key) >> (np.uint64(64) - half))
        return (left << half) | right

    places = once(index)
    # the network's range is less than four times the count, so few rounds leave it again and again
    outside = np.flatnonzero(places >= count)
    while outside.size:
        places[outside] = once(places[outside])
        outside = outside[places[outside] >= count]
    return places


def _mixed(words: Words) -> Words:
    """The finaliser of SplitMix64. Source: Steele, Lea and Flood, 2014."""
    words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return words ^ (words >> np.uint64(31))


def _key(seed: int, stream: int, words: int) -> Words:
    """Words that differ for each seed and stream."""
    made = np.random.SeedSequence([seed, stream]).generate_state(words, np.uint64)
    return np.asarray(made, dtype=np.uint64)


class _Engine(threading.local):
    """The Sobol engine of a thread: moved forward from part to part, which is quicker than from the start."""

    key: tuple[int, int] | None = None
    engine: Any = None


_ENGINE = _Engine()


def sobol_points(seed: int, axes: int, first: int, stop: int) -> Floats:
    """Points `first` to `stop` (axes, n) of a scrambled Sobol sequence.

    Raises `MissingExtraError` without scipy. Source: Joe and Kuo's direction numbers, Owen's scrambling.
    """
    try:
        from scipy.stats import qmc
    except ImportError:
        raise MissingExtraError(
            "Sobol samples need scipy; install it with: pip install 'sevenbar[sweep]'"
        ) from None
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
