"""The closed form of many RSSR designs at once, with its exact derivatives by the dimensions and the input.

With A and B the balls, x = L1 cos alpha - M, y = L1 sin alpha - D, the closure of one design is

    G = L3 (y cos beta + N sin beta) - K = 0,    K = (x^2 + y^2 + N^2 + L3^2 - L2^2) / 2                  (1)
    W = L3^2 (y^2 + N^2) - K^2,                  sin^2(transmission angle) = W / (L2 L3)^2                (2)

and the output follows its dimensions by `G_beta dbeta = -G_p dp`, where G_beta = +- sqrt(W).
Designs are rows (n, 6) of M, N, L1, L2, L3, D in one length unit; inputs (m,) or (n, m) [rad].

Source: docs/rssr.md, (3) to (5); docs/theory_design.md, (26).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft

#: The dimensions of a design, in the order of its row.
NAMES = ("M", "N", "L1", "L2", "L3", "D")

#: Part of the longest dimension that counts as zero.
ROUNDING = 1e-15


def row_of(dimensions: Mapping[str, float]) -> Floats:
    """The row (6,) of a linkage's dimensions."""
    return np.array([dimensions[name] for name in NAMES])


def draft_of(row: Floats, name: str, *, length_unit: str = "mm") -> Draft:
    """A description of one design (6,), whose name reports show."""
    return Draft.made(name, length_unit, rssr=dict(zip(NAMES, map(float, row), strict=True)))


def scaled(row: Floats, longest: float) -> Floats:
    """A design (6,) whose longest dimension is `longest`; what is zero up to rounding is zero."""
    row = row * (longest / np.abs(row).max())
    return np.where(np.abs(row) < ROUNDING * longest, 0.0, row)


def outputs(designs: Floats, inputs: Floats, branch: int) -> Floats:
    """The output angle (n, m) [rad] of a branch of each design; NaN where it cannot be reached."""
    _, y, k, w = _terms(designs, inputs)
    n, l3 = designs[:, 1, None], designs[:, 4, None]
    with np.errstate(invalid="ignore"):
        turn = np.arctan2(k, np.sqrt(w))
    return np.asarray((np.pi - turn if branch else turn) - np.arctan2(l3 * y, l3 * n))


def output_slopes(designs: Floats, inputs: Floats, angles: Floats) -> tuple[Floats, Floats]:
    """Derivatives of the output `angles` (n, m) by the six dimensions (n, m, 6) and by the input (n, m)."""
    _, n, l1, l2, l3, _ = (designs[:, i, None] for i in range(6))
    x, y, _, _ = _terms(designs, inputs)
    ca, sa, cb, sb = np.cos(inputs), np.sin(inputs), np.cos(angles), np.sin(angles)
    by_output = l3 * (n * cb - y * sb)
    ones = np.ones_like(by_output)
    by_dimension = [
        x,
        l3 * sb - n,
        l3 * sa * cb - x * ca - y * sa,
        l2 * ones,
        y * cb + n * sb - l3,
        y - l3 * cb,
    ]
    by_input = l1 * (l3 * ca * cb + x * sa - y * ca)
    with np.errstate(divide="ignore", invalid="ignore"):
        return -np.stack(by_dimension, axis=2) / by_output[:, :, None], -by_input / by_output


def transmissions(designs: Floats, inputs: Floats) -> Floats:
    """The squared sine of the transmission angle (n, m), the same on both branches.

    Negative where the input cannot be reached, and the more so the farther off it is.
    """
    w = _terms(designs, inputs)[3]
    return np.asarray(w / (designs[:, 3, None] * designs[:, 4, None]) ** 2)


def transmission_slopes(designs: Floats, inputs: Floats) -> tuple[Floats, Floats]:
    """Derivatives of `transmissions` by the six dimensions (n, m, 6) and by the input (n, m)."""
    _, n, l1, l2, l3, _ = (designs[:, i, None] for i in range(6))
    x, y, k, w = _terms(designs, inputs)
    ca, sa = np.cos(inputs), np.sin(inputs)
    square = (l2 * l3) ** 2
    by_dimension = [
        2 * k * x,
        2 * n * (l3**2 - k),
        2 * (l3**2 * y * sa - k * (x * ca + y * sa)),
        2 * (k * l2 - w / l2),
        2 * (l3 * (y**2 + n**2 - k) - w / l3),
        2 * y * (k - l3**2),
    ]
    by_input = 2 * l1 * (l3**2 * y * ca - k * (y * ca - x * sa))
    return np.stack(by_dimension, axis=2) / square[:, :, None], by_input / square


def _terms(designs: Floats, inputs: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """x, y, K and W of (1) and (2), all (n, m)."""
    m, n, l1, l2, l3, d = (designs[:, i, None] for i in range(6))
    x, y = l1 * np.cos(inputs) - m, l1 * np.sin(inputs) - d
    k = (x**2 + y**2 + n**2 + l3**2 - l2**2) / 2
    return x, y, k, l3**2 * (y**2 + n**2) - k**2
