"""What the property tests draw: linkages by seed, driving joints, how many examples."""

from __future__ import annotations

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from evidence.fuzz.random_linkages import (
    Dimensions,
    Drawing,
    assembled_square,
    nearly_parallel,
    skew,
)

TURN = 2 * np.pi
DRIVERS = ["crank", "rocker"]

laws = settings(deadline=None, max_examples=100, derandomize=True)


def drawing_of(seed: int) -> Drawing:
    """Skew or nearly parallel axes."""
    rng = np.random.default_rng(seed)
    return (skew, nearly_parallel)[seed % 2](rng)


def square_of(seed: int) -> Dimensions:
    return assembled_square(np.random.default_rng(seed))


seeds = st.integers(0, 10**6)
drawings = st.builds(drawing_of, seeds)
linkages = st.one_of(drawings, st.builds(square_of, seeds))
drivers = st.sampled_from(DRIVERS)


def wrapped(angle: np.ndarray) -> np.ndarray:
    """In [-pi, pi)."""
    return (np.asarray(angle) + np.pi) % TURN - np.pi


# The closed product
