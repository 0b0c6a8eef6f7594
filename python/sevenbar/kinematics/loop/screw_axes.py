"""The instantaneous screw axis of a link: the line about which it turns and along which it slides at once.

With the angular velocity w of one link against another and the velocity v of its point p,

    direction  w / |w|        point  p + w x v / w^2        pitch  h = w . v / w^2                         (8)

v less h w is square to w, so that the points of the axis move along it only.

Source: docs/theory_measures.md, (8) to (10); R. S. Ball, "A treatise on the theory of screws" (1900);
O. Bottema, B. Roth, "Theoretical kinematics" (1979).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, ReadOnly, Words
from sevenbar.errors import check_kind
from sevenbar.text.printing import Printed

#: Turns slower than this, for the size of the linkage and against the velocity, are none: the axis is farther
#: away than what rounding leaves of its place.
NO_TURN = 1e-10

#: Velocities below this share of the fastest on the circuit are rounding.
AT_REST = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class ScrewAxes(ReadOnly, Printed):
    """The screw axis of link `link` against link `relative_to` on each of n rows.

    `point` and `direction` (n, 3) are a point of the axis and a unit vector along it, right-handed, in the
    report frame; the point is that nearest to the origin of the link's own frame. `pitch` (n,) [length per
    radian], `rate` (n,) [rad/s] about the axis and `slide_rate` (n,) [length/s] along it. `fixed_point`,
    `fixed_direction` are the same in the coordinates of `relative_to`, `moving_point`, `moving_direction` in
    those of the link, written as `at` of a point: the lines of the fixed and of the moving axode, of a planar
    loop the points of the fixed and of the moving centrode.

    `status` (n,): "ok"; "translation", where there is a direction and no axis, the pitch being infinite;
    "at-rest"; or what the row has instead of rates. Values that do not exist are NaN.
    """

    link: int
    relative_to: int
    point: Floats
    direction: Floats
    pitch: Floats
    rate: Floats
    slide_rate: Floats
    fixed_point: Floats
    fixed_direction: Floats
    moving_point: Floats
    moving_direction: Floats
    status: Words

    def columns(self, length: str) -> dict[str, npt.NDArray[np.generic]]:
        """The rows column by column, each name ending in its unit; `length` is the length unit."""
        check_kind("length", length, str, "a unit of length; give a word, as in 'mm'")
        columns: dict[str, npt.NDArray[np.generic]] = {"status": self.status}
        for name, unit in product(("", "fixed_", "moving_"), (f"_{length}", "")):
            vector = f"{name}point" if unit else f"{name}direction"
            for k, axis in enumerate("xyz"):
                columns[f"{vector}_{axis}{unit}"] = getattr(self, vector)[:, k]
        columns[f"pitch_{length}_rad"] = self.pitch
        columns["rate_rad_s"] = self.rate
        columns[f"slide_rate_{length}_s"] = self.slide_rate
        return columns


@dataclass(frozen=True, eq=False)
class Twists:
    """How a link moves on n rows, in the report frame.

    `frame` (n, 4, 4) is that in which `at` of its points is written; `turn` (n, 3) [rad/s] its angular
    velocity, `velocity` (n, 3) [length/s] that of its origin.
    """

    frame: Floats
    turn: Floats
    velocity: Floats


def screw_axes(link: int, other: int, own: Twists, base: Twists, size: float, status: Words) -> ScrewAxes:
    """The screw axes of a link against another; `status` (n,) is that of the rows, `size` [length]."""
    place = own.frame[:, :3, 3]
    turn = own.turn - base.turn
    carried = base.velocity + np.cross(base.turn, place - base.frame[:, :3, 3])
    velocity = own.velocity - carried
    rate, speed = np.linalg.norm(turn, axis=1), np.linalg.norm(velocity, axis=1)
    # what either link does by itself is what rounding is a share of
    scale = max(_fastest(own, size), _fastest(base, size))
    words = np.where(np.char.str_len(status) == 0, "ok", status).astype("<U16")
    known = np.isin(words, ("ok", "turns-undefined")) & np.isfinite(rate) & np.isfinite(speed)
    words[known] = "ok"
    resting = known & (size * rate <= AT_REST * scale) & (speed <= AT_REST * scale)
    sliding = known & ~resting & (size * rate <= np.fmax(NO_TURN * speed, AT_REST * scale))
    words[resting], words[sliding] = "at-rest", "translation"
    turning = words == "ok"
    with np.errstate(invalid="ignore", divide="ignore"):
        along = (turn * velocity).sum(axis=1) / rate
        point = place + np.cross(turn, velocity) / rate[:, None] ** 2
        direction = np.where(sliding[:, None], velocity / speed[:, None], turn / rate[:, None])
        pitch = along / rate
    point[~turning], direction[~(turning | sliding)], pitch[~turning] = np.nan, np.nan, np.nan
    pitch[sliding] = np.inf
    rate, along = np.where(turning, rate, 0.0), np.where(sliding, speed, np.where(turning, along, 0.0))
    lost = ~(turning | sliding | resting)
    rate[lost], along[lost] = np.nan, np.nan
    fixed, moving = (_seen_from(frame, point, direction) for frame in (base.frame, own.frame))
    return ScrewAxes(link, other, point, direction, pitch, rate, along, *fixed, *moving, words)


def _fastest(twists: Twists, size: float) -> float:
    """The greatest velocity [length/s] of a link of a size on its rows."""
    speeds = [size * np.linalg.norm(twists.turn, axis=1), np.linalg.norm(twists.velocity, axis=1)]
    return float(np.nanmax(np.concatenate(speeds), initial=0.0))


def _seen_from(frame: Floats, point: Floats, direction: Floats) -> tuple[Floats, Floats]:
    """A point and a direction (n, 3) of the report frame in the coordinates of a frame (n, 4, 4)."""
    back = np.swapaxes(frame[:, :3, :3], 1, 2)
    return (
        np.einsum("nij,nj->ni", back, point - frame[:, :3, 3]),
        np.einsum("nij,nj->ni", back, direction),
    )
