"""An RSSR worked out a second time, sharing no formula with the core.

Source: the description alone. Crank and rocker turn their balls A and B about two given axes (Rodrigues'
formula), and the loop closes where |A - B| = L2. Everything here follows from that one sentence:

- in NumPy, where a turning ball comes within reach of the other circle, and the two poses there;
- in mpmath, the pose by Newton's method on |A - B|^2 = L2^2, and every derivative by time by central
  differences with a step of 1e-20 in 80 digits: 20 digits are left of a third derivative, more of the lower
  ones.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mpmath as mp
import numpy as np

from evidence.accuracy.differences import central_differences

#: Digits carried, and the step of the central differences.
DIGITS = 80
STEP = mp.mpf(10) ** -20


@dataclass(frozen=True)
class Side:
    """A side link: it turns its ball, at `ball` for angle zero, about the line through `at` along `axis`."""

    at: np.ndarray
    axis: np.ndarray
    ball: np.ndarray

    def turned(self, angles: np.ndarray) -> np.ndarray:
        """The ball (n, 3) at each angle, by Rodrigues' formula."""
        arm = self.ball - self.at
        axis = self.axis / np.linalg.norm(self.axis)
        sine, cosine = np.sin(angles)[:, None], np.cos(angles)[:, None]
        along = (axis @ arm) * axis
        return self.at + along + cosine * (arm - along) + sine * np.cross(axis, arm)

    @property
    def foot(self) -> np.ndarray:
        """The foot of the ball on the axis: the centre of its circle."""
        axis = self.axis / np.linalg.norm(self.axis)
        return self.at + (axis @ (self.ball - self.at)) * axis

    @property
    def radius(self) -> float:
        """The radius of the ball's circle."""
        return float(np.linalg.norm(self.ball - self.foot))

    def distances(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """From each of the points (n, 3) to the nearest and to the farthest point of the ball's circle."""
        axis = self.axis / np.linalg.norm(self.axis)
        offset = points - self.foot
        z = offset @ axis
        height = np.linalg.norm(offset - z[:, None] * axis, axis=1)
        return np.hypot(z, height - self.radius), np.hypot(z, height + self.radius)


@dataclass(frozen=True)
class Course:
    """A circuit as poses along it, the last one next to the first; `output` is continuous."""

    input_turns: bool
    input: np.ndarray
    output: np.ndarray

    @property
    def output_turns(self) -> bool:
        """True where the output does not come back to its first angle but to another by whole turns."""
        return bool(abs(self.output[-1] - self.output[0]) > np.pi)

    @property
    def motion_type(self) -> str:
        """The name in the field's words."""
        names = {
            (True, True): "double-crank",
            (True, False): "crank-rocker",
            (False, True): "rocker-crank",
            (False, False): "double-rocker",
        }
        return names[self.input_turns, self.output_turns]


@dataclass(frozen=True)
class Rssr:
    """Two side links and the coupler's length; `drawn` tells a drawing, whose pose is every joint's zero."""

    crank: Side
    rocker: Side
    coupler: float
    drawn: bool = False

    @property
    def size(self) -> float:
        """The greatest of crank, coupler, rocker, and the distance of the two circles' centres."""
        ground = float(np.linalg.norm(self.crank.foot - self.rocker.foot))
        return max(self.crank.radius, self.rocker.radius, self.coupler, ground)

    def sides(self, driver: str) -> tuple[Side, Side]:
        """The driving side link and the other one."""
        return (self.crank, self.rocker) if driver == "crank" else (self.rocker, self.crank)

    def closure_error(self, crank: np.ndarray, rocker: np.ndarray) -> np.ndarray:
        """`| |A - B| - L2 |` relative to the size."""
        apart = np.linalg.norm(self.crank.turned(crank) - self.rocker.turned(rocker), axis=1)
        return np.abs(apart - self.coupler) / self.size

    def margin(self, inputs: np.ndarray, driver: str = "crank") -> np.ndarray:
        """How far the coupler is from too short or too long, in size: the loop closes where it is >= 0."""
        one, other = self.sides(driver)
        nearest, farthest = other.distances(one.turned(inputs))
        return np.minimum(self.coupler - nearest, farthest - self.coupler) / self.size

    def outputs(self, inputs: np.ndarray, driver: str = "crank") -> np.ndarray:
        """Both poses of the other side link at each input, (2, n), continuous; NaN out of reach.

        With the input held, `|A - B|^2` is `a + b cos x + c sin x`; three of its values give a, b and c.
        """
        one, other = self.sides(driver)
        ball = one.turned(inputs)
        quarter = [other.turned(np.array([angle]))[0] for angle in (0.0, np.pi / 2, np.pi)]
        at_0, at_quarter, at_half = (np.sum((ball - p) ** 2, axis=1) for p in quarter)
        a, b = (at_0 + at_half) / 2, (at_0 - at_half) / 2
        c = at_quarter - a
        amplitude = np.hypot(b, c)
        with np.errstate(invalid="ignore", divide="ignore"):
            spread = np.arccos((self.coupler**2 - a) / amplitude)
        phase = np.unwrap(np.arctan2(c, b))
        return np.stack([phase + spread, phase - spread])

    def limits(self, driver: str = "crank", samples: int = 2048) -> np.ndarray:
        """Inputs in [0, 2 pi) where the coupler begins or ceases to reach: sampled, then narrowed down."""
        grid = np.linspace(0, 2 * np.pi, samples + 1)
        inside = self.margin(grid, driver) >= 0
        found = np.flatnonzero(inside[:-1] != inside[1:])
        low, high = grid[found], grid[found + 1]
        parts = np.arange(65) / 64
        for _ in range(8):
            fine = low[:, None] + (high - low)[:, None] * parts
            same = (self.margin(fine.ravel(), driver) >= 0).reshape(fine.shape) == inside[found][:, None]
            last = np.argmin(np.concatenate([same, np.zeros((found.size, 1), bool)], axis=1), axis=1) - 1
            each = np.arange(found.size)
            low, high = fine[each, last.clip(0, 63)], fine[each, (last + 1).clip(1, 64)]
        return (low + high) / 2

    def clearance(self, samples: int = 2048) -> float:
        """How far a change point is: the least local extreme of the margin, either joint driving."""
        least = np.inf
        for driver in ("crank", "rocker"):
            margin = self.margin(2 * np.pi / samples * np.arange(samples), driver)
            rise, fall = margin - np.roll(margin, 1), margin - np.roll(margin, -1)
            extremes = margin[rise * fall >= 0]
            least = min(least, float(np.min(np.abs(extremes), initial=np.inf)))
        return least

    def circuits(self, driver: str = "crank", samples: int = 2048) -> list[Course]:
        """Every circuit, followed pose by pose."""
        limits = self.limits(driver, samples)
        if limits.size == 0:
            if self.margin(np.zeros(1), driver)[0] < 0:
                return []
            inputs = np.linspace(0, 2 * np.pi, samples + 1)
            return [Course(True, inputs, output) for output in self.outputs(inputs, driver)]
        ends = np.append(limits, limits[0] + 2 * np.pi)
        # poses crowd where the input turns back
        crowded = (1 - np.cos(np.linspace(0, np.pi, samples)))[1:-1] / 2
        courses = []
        for start, end in itertools.pairwise(ends):
            if self.margin(np.array([(start + end) / 2]), driver)[0] < 0:
                continue
            there = start + (end - start) * crowded
            first, second = self.outputs(there, driver)
            second = second + 2 * np.pi * np.round((first[-1] - second[-1]) / (2 * np.pi))
            inputs = np.concatenate([there, there[::-1]])
            courses.append(Course(False, inputs, np.concatenate([first, second[::-1]])))
        return courses

    def precise(self) -> PreciseRssr:
        """The same linkage in 80 digits."""
        return PreciseRssr(self)


class _PreciseSide:
    def __init__(self, side: Side) -> None:
        at, axis, ball = (mp.matrix(list(map(float, v))) for v in (side.at, side.axis, side.ball))
        self.axis = axis / mp.norm(axis)
        self.at, self.arm = at, ball - at
        self.along = _dot(self.axis, self.arm) * self.axis
        self.radial = self.arm - self.along
        self.quarter = _cross(self.axis, self.arm)
        self.centre = at + self.along

    def ball(self, angle: mp.mpf) -> mp.matrix:
        return self.centre + mp.cos(angle) * self.radial + mp.sin(angle) * self.quarter

    def speed(self, angle: mp.mpf) -> mp.matrix:
        return mp.cos(angle) * self.quarter - mp.sin(angle) * self.radial

    def frame(self, angle: mp.mpf) -> mp.matrix:
        """Columns from the foot to the ball, a quarter turn on, and along the axis."""
        radius = mp.norm(self.radial)
        return _columns((self.ball(angle) - self.centre) / radius, self.speed(angle) / radius, self.axis)

    def rotation(self, angle: mp.mpf) -> mp.matrix:
        x, y, z = self.axis
        skew = mp.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return mp.eye(3) + mp.sin(angle) * skew + (1 - mp.cos(angle)) * skew * skew


def _columns(*columns: mp.matrix) -> mp.matrix:
    return mp.matrix([list(row) for row in zip(*columns, strict=True)])


def _dot(a: mp.matrix, b: mp.matrix) -> mp.mpf:
    return mp.fdot(zip(a, b, strict=True))


def _cross(a: mp.matrix, b: mp.matrix) -> mp.matrix:
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


class PreciseRssr:
    """Poses and derivatives of an RSSR in 80 digits, from the closure and nothing else.

    Use under `mp.workdps(DIGITS)`.
    """

    def __init__(self, rssr: Rssr) -> None:
        self.crank, self.rocker = _PreciseSide(rssr.crank), _PreciseSide(rssr.rocker)
        # a drawing gives the coupler by its two balls
        self.coupler = (
            mp.norm(self.crank.ball(mp.mpf(0)) - self.rocker.ball(mp.mpf(0)))
            if rssr.drawn
            else mp.mpf(rssr.coupler)
        )
        self.drawn = rssr.drawn

    def follower(self, angle: mp.mpf, near: mp.mpf, driver: str = "crank") -> mp.mpf:
        """The other joint's angle nearest to `near`, by Newton's method on `|A - B|^2 = L2^2`."""
        one, other = (self.crank, self.rocker) if driver == "crank" else (self.rocker, self.crank)
        ball = one.ball(angle)
        x = mp.mpf(near)
        for _ in range(60):
            apart = other.ball(x) - ball
            step = (_dot(apart, apart) - self.coupler**2) / (2 * _dot(apart, other.speed(x)))
            x -= step
            if abs(step) < mp.mpf(10) ** -(DIGITS // 2 + 5):  # the next step would be the square of this one
                return x
        raise ArithmeticError(f"no pose near {near} at input {angle}")

    def reach(self, angle: mp.mpf, driver: str = "crank") -> tuple[mp.mpf, mp.mpf, mp.mpf]:
        """How far the coupler reaches past the nearest and short of the farthest point, squared; the terms.

        `L2^2 - near^2`, `far^2 - L2^2` and `L2^2 + far^2`; at a limit of the driver one of the first two is zero.
        """
        one, other = (self.crank, self.rocker) if driver == "crank" else (self.rocker, self.crank)
        offset = one.ball(angle) - other.centre
        z = _dot(other.axis, offset)
        height, radius = mp.norm(offset - z * other.axis), mp.norm(other.radial)
        near, far = z**2 + (height - radius) ** 2, z**2 + (height + radius) ** 2
        coupler = self.coupler**2
        return coupler - near, far - coupler, coupler + far

    def condition(self, angle: mp.mpf, driver: str = "crank") -> mp.mpf:
        """How a relative error of the squared lengths grows in the product of the two reaches."""
        past, short, terms = self.reach(angle, driver)
        return terms / past + terms / short

    def rotations(self, crank: mp.mpf, rocker: mp.mpf) -> list[mp.matrix]:
        """The directions of crank, coupler and rocker, as design.md lays down.

        Drawn form: turned against the drawn pose. Dimension form: x along the link (crank and coupler towards the next
        joint, as the rocker, whose next joint is its axis), z along the side link's axis.
        """
        coupler = self._coupler_frame(crank, rocker)
        if self.drawn:
            zero = mp.mpf(0)
            at_zero = self._coupler_frame(zero, zero)
            return [self.crank.rotation(crank), coupler * at_zero.T, self.rocker.rotation(rocker)]
        first, third = self.crank.frame(crank), self.rocker.frame(rocker)
        return [first, coupler, third * mp.diag([-1, -1, 1])]

    def _coupler_frame(self, crank: mp.mpf, rocker: mp.mpf) -> mp.matrix:
        """Columns x to B, y = z cross x, z nearest to the crank's axis (the rule for the idle spin)."""
        x = self.rocker.ball(rocker) - self.crank.ball(crank)
        x = x / mp.norm(x)
        z = self.crank.axis - _dot(self.crank.axis, x) * x
        z = z / mp.norm(z)
        return _columns(x, _cross(z, x), z)

    def turns(self, crank: mp.mpf, rocker: mp.mpf) -> list[mp.mpf]:
        """The turns of ball A, then of ball B: each link against the one before as `Rz(t1) Ry(t2) Rx(t3)`."""
        first, second, third = self.rotations(crank, rocker)
        return _turns_zyx(first.T * second) + _turns_zyx(second.T * third)

    def point(self, link: int, at: Sequence[float], crank: mp.mpf, rocker: mp.mpf) -> list[mp.mpf]:
        """A point of link 1, 2 or 3 in the report frame, `at` as the forms write it."""
        origins = [self.crank.at, self.crank.ball(crank), self.rocker.ball(rocker)]
        own = mp.matrix(list(map(float, at)))
        if self.drawn:
            zero = mp.mpf(0)
            own = own - [self.crank.at, self.crank.ball(zero), self.rocker.ball(zero)][link - 1]
        return list(origins[link - 1] + self.rotations(crank, rocker)[link - 1] * own)

    def coupler_sine(self, crank: mp.mpf, rocker: mp.mpf) -> mp.mpf:
        """The sine between the coupler and the crank's axis: at zero its spin has no direction."""
        x = self.rocker.ball(rocker) - self.crank.ball(crank)
        return mp.norm(_cross(x, self.crank.axis)) / mp.norm(x)

    def along(
        self,
        rates: Sequence[float],
        near: float,
        driver: str,
        measure: Callable[[mp.mpf, mp.mpf], list[mp.mpf]],
    ) -> list[list[mp.mpf]]:
        """Each number of `measure(crank, rocker)` with three derivatives by time.

        `rates` are the input, its speed, acceleration and jerk; `near` picks the pose.
        """
        at, d1, d2, d3 = (mp.mpf(float(r)) for r in rates)
        follower = self.follower(at, mp.mpf(float(near)), driver)
        samples = []
        for k in (-2, -1, 0, 1, 2):
            t = k * STEP
            angle = at + t * (d1 + t * (d2 / 2 + t * d3 / 6))
            other = follower if k == 0 else self.follower(angle, follower, driver)
            samples.append(measure(angle, other) if driver == "crank" else measure(other, angle))
        return [central_differences(values, STEP) for values in zip(*samples, strict=True)]

    def output(self, rates: Sequence[float], near: float, driver: str = "crank") -> list[mp.mpf]:
        """The other joint's angle with three derivatives by time."""
        pick = 1 if driver == "crank" else 0
        return self.along(rates, near, driver, lambda crank, rocker: [(crank, rocker)[pick]])[0]


def _turns_zyx(rotation: mp.matrix) -> list[mp.mpf]:
    """The angles of `Rz(t1) Ry(t2) Rx(t3)`."""
    return [
        mp.atan2(rotation[1, 0], rotation[0, 0]),
        mp.atan2(-rotation[2, 0], mp.hypot(rotation[0, 0], rotation[1, 0])),
        mp.atan2(rotation[2, 1], rotation[2, 2]),
    ]
