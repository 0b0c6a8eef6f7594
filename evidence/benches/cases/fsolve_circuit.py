"""scipy's `fsolve` along a circuit, with the closure written twice: in NumPy, and in plain floats.

The first is how people write it, the second the fastest that Python has at this size.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

#: Six equations of the angles of joints 2 to 7 and the input [rad].
Equations = Callable[[np.ndarray, float], object]


def positions(equations: Equations, start: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """Poses (n, 7) at inputs (n,) [rad], each from the one before."""
    from scipy.optimize import fsolve

    rows = np.empty((inputs.size, 7))
    rows[:, 0] = inputs
    guess = start[1:]
    for row, theta in zip(rows, inputs, strict=True):
        guess = fsolve(equations, guess, args=(theta,), xtol=1e-12)  # type: ignore[arg-type]
        row[1:] = guess
    return rows


def _size(links: np.ndarray) -> float:
    return float(np.linalg.norm(links[:, :3, 3], axis=1).max())


def in_numpy(links: np.ndarray) -> Equations:
    """Three skew and three place equations of the product of fourteen matrices, half of them constant."""
    size = _size(links)
    turn = np.zeros((7, 4, 4))
    turn[:, 2, 2] = turn[:, 3, 3] = 1.0
    angles = np.empty(7)

    def equations(x: np.ndarray, theta: float) -> np.ndarray:
        angles[0], angles[1:] = theta, x
        c, s = np.cos(angles), np.sin(angles)
        turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1] = c, -s, s, c
        a = turn @ links
        t = a[0] @ a[1] @ a[2] @ a[3] @ a[4] @ a[5] @ a[6]
        return np.array(
            [
                t[2, 1] - t[1, 2],
                t[0, 2] - t[2, 0],
                t[1, 0] - t[0, 1],
                t[0, 3] / size,
                t[1, 3] / size,
                t[2, 3] / size,
            ]
        )

    return equations


def in_plain_floats(links: np.ndarray) -> Equations:
    """The same, axis by axis from the base on."""
    size = _size(links)
    constants = [tuple(link[:3].ravel().tolist()) for link in links]
    cos, sin = math.cos, math.sin

    def equations(x: np.ndarray, theta: float) -> list[float]:
        px = py = pz = 0.0
        xx, xy, xz, yx, yy, yz, zx, zy, zz = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
        for angle, constant in zip((theta, *x.tolist()), constants, strict=True):
            m00, m01, m02, m03, m10, m11, m12, m13, m20, m21, m22, m23 = constant
            c, s = cos(angle), sin(angle)
            ux, uy, uz = c * xx + s * yx, c * xy + s * yy, c * xz + s * yz
            vx, vy, vz = c * yx - s * xx, c * yy - s * xy, c * yz - s * xz
            px += m03 * ux + m13 * vx + m23 * zx
            py += m03 * uy + m13 * vy + m23 * zy
            pz += m03 * uz + m13 * vz + m23 * zz
            xx, yx, wx = m00 * ux + m10 * vx + m20 * zx, m01 * ux + m11 * vx + m21 * zx, zx
            xy, yy, wy = m00 * uy + m10 * vy + m20 * zy, m01 * uy + m11 * vy + m21 * zy, zy
            xz, yz, wz = m00 * uz + m10 * vz + m20 * zz, m01 * uz + m11 * vz + m21 * zz, zz
            zx = m02 * ux + m12 * vx + m22 * wx
            zy = m02 * uy + m12 * vy + m22 * wy
            zz = m02 * uz + m12 * vz + m22 * wz
        return [yz - zy, zx - xz, xy - yx, px / size, py / size, pz / size]

    return equations


CLOSURES: dict[str, Callable[[np.ndarray], Equations]] = {
    "NumPy closure": in_numpy,
    "closure of plain floats": in_plain_floats,
}
