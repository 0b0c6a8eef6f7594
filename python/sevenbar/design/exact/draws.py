"""Members of families of dyads: points on a cubic of moving points, or any moving points."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats, whole_number
from sevenbar.design.exact.bilinear import on_cubic, partner
from sevenbar.design.extra import need_scipy
from sevenbar.errors import RequestError

#: A pair of points (a, b), both (3,), that bilinear forms make zero.
Pair = tuple[Floats, Floats]


#: Most members that are drawn.
MOST = 2**20

#: A vector product of two rows of length 1 below this has a direction of rounding.
PARALLEL = 1e-12


def directions(samples: int, size: int, seed: int) -> Floats:
    """Directions (samples, size) all round, from a Sobol sequence: those of normal deviates."""
    need_scipy()
    from scipy.special import ndtri
    from scipy.stats import qmc

    samples = whole_number("samples", samples, 1, MOST, "a number of members")
    # a sequence is even in powers of two only
    draws = qmc.Sobol(size, seed=seed).random_base2(max(samples - 1, 1).bit_length())[:samples]
    result = ndtri(np.clip(draws, 1e-9, 1 - 1e-9))
    return np.asarray(result / np.linalg.norm(result, axis=1, keepdims=True))


def family(
    forms: Floats, given: Floats | None, samples: int, seed: int, words: tuple[str, str, str]
) -> tuple[list[Pair], str]:
    """Pairs of a family, whose b are `given` (k, 3) or drawn, and how they were found.

    `words` are the name of a point, of several, and of the curve that three forms leave them.
    """
    one, many, curve = words
    if len(forms) == 3:
        how = f"moving {many} on their {curve}, a cubic, drawn with seed {seed}"
        return on_curve(forms, samples, seed), how
    how = f"each moving {one} has one fixed {one}"
    if given is not None:
        return anywhere(forms, given), how
    return anywhere(forms, directions(samples, 3, seed)), f"{how}; seed {seed}"


def on_curve(forms: Floats, samples: int, seed: int) -> list[Pair]:
    """Pairs of three forms (3, 3, 3), whose b lie on a cubic: where lines of a Sobol sequence meet it."""
    result: list[Pair] = []
    for line in directions(samples, 6, seed):
        for b in on_cubic(forms, line[:3], line[3:]):
            result.append((partner(forms, b).real, b))
    return result[:samples]


def anywhere(forms: Floats, moving: Floats) -> list[Pair]:
    """Pairs of two forms (2, 3, 3): each b of `moving` (k, 3) has its a, `T_1 b x T_2 b`.

    Raises `RequestError` for one that has infinitely many.
    """
    result: list[Pair] = []
    sizes = np.linalg.norm(forms, axis=(1, 2))
    for i, b in enumerate(moving):
        a = np.cross(*(forms @ b))
        if np.linalg.norm(a) <= PARALLEL * sizes.prod() * float(b @ b):
            raise RequestError(
                f"moving[{i}]: has one place in two of the three poses, so infinitely many dyads fit; give "
                "another"
            )
        result.append((a, b))
    return result
