"""Derivatives of the transmission angle by the description's numbers, for every loop that has it.

The angle is a function of points on the axes of the joints that make it: with the derivatives of these by a
number, it follows by a complex step, exact to rounding, since (4) and (5) are analytic. An extreme over the
input changes as the angle does in its place.

Source: docs/theory_design.md, (6).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.numbers.gradients import MeasureSlopes, nearest, poses_at
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.numbers.word import Carried
from sevenbar.kinematics.solvers.general import steps_of
from sevenbar.kinematics.transmission.angle import Coupling, coupling_of, sine_and_cosine, ways
from sevenbar.kinematics.transmission.axes import COMPLEX_STEP, Axes
from sevenbar.kinematics.transmission.closed import turning_cosines, turns_in_line

#: 1 - sin of a transmission angle of 90 degrees, and the angle of one of 0: there it has a kink, or is kept.
RIGHT_ANGLE, DEAD = 1e-12, 1e-7


@dataclass(frozen=True, eq=False)
class AxisPoints:
    """The points by which the angle of a coupling is known: two on the axis of each of its joints."""

    coupling: Coupling
    axes: Axes
    parts: tuple[int, ...]
    points: tuple[Carried, ...]
    size: float

    @staticmethod
    def of(numbers: Numbers, input: int, output: int) -> AxisPoints | None:
        """Those of a loop driven by one column and read at another.

        `None` without a transmission angle, and where a screw, whose pitch may be a number, makes it.
        """
        linkage: Loop = numbers.linkage
        coupling = coupling_of(linkage, input, output)
        if coupling is None:
            return None
        parts = steps_of(linkage)
        # the last turns give the plane its normal
        own = tuple(dict.fromkeys((coupling.at, *coupling.free, coupling.output, coupling.input)))
        if "H" in {parts.letters[part] for part in own}:
            return None
        points = [point for part in own for point in numbers.word.axis(parts.columns[part], numbers.size)]
        none = np.empty((len(parts.letters), 0, 3))
        return AxisPoints(coupling, Axes(parts, none, none), own, tuple(points), numbers.size)

    def angle(self, places: Floats, by: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Sine and cosine (n,) of the angle, with no sign, and both slopes (n, k).

        `places` (n, points, 3) of the points, `by` (n, points, 3, k) their slopes.
        """
        sine, cosine = self._made(places)
        whole = np.hypot(sine, cosine)
        if not by.shape[-1]:
            none = np.empty((len(places), 0))
            with np.errstate(invalid="ignore", divide="ignore"):
                return np.abs(sine) / whole, np.abs(cosine) / whole, none, none
        stepped = places[..., None] + 1j * COMPLEX_STEP * by
        count = by.shape[-1]
        every = np.moveaxis(stepped, -1, 0).reshape(-1, *places.shape[1:])
        sine_by, cosine_by = (
            (v.imag / COMPLEX_STEP).reshape(count, len(places)).T for v in self._made(every)
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            sign = np.sign(sine) * np.sign(cosine)
            turned = (sign / whole**2)[:, None] * (cosine[:, None] * sine_by - sine[:, None] * cosine_by)
            s, c = np.abs(sine) / whole, np.abs(cosine) / whole
        return s, c, c[:, None] * turned, -s[:, None] * turned

    @property
    def in_line(self) -> bool:
        """Whether `turning` has it."""
        return turns_in_line(self.coupling, self.axes.parts.letters)

    def turning(self, places: Floats, by: Floats) -> tuple[Floats, Floats] | None:
        """The two angles [rad] (2,) at which that of an input that turns fully is extreme, and slopes (2, k).

        By the points (1, points, 3) of a pose and their slopes. Without a full turn they go on below
        zero, as cosines do beyond 1. `None` for loops that have them in no closed form.
        """
        stepped = places + 1j * COMPLEX_STEP * np.moveaxis(by[0], -1, 0)
        result = turning_cosines(self.coupling, self._axes(np.concatenate([places, stepped])))
        if result is None:
            return None
        cosines, slopes = result[0].real, result[1:].T.imag / COMPLEX_STEP
        sizes = np.abs(cosines)
        inside = np.clip(sizes, 0.0, 1.0)
        sines = np.maximum(np.sqrt(1 - inside**2), DEAD)
        falls = -np.sign(cosines)[:, None] * slopes
        angles = np.where(sizes < 1, np.arccos(inside), 1 - sizes)
        return angles, np.where((sizes < 1)[:, None], falls / sines[:, None], falls)

    def _made(self, places: Floats) -> tuple[Floats, Floats]:
        """Sine and cosine times |u| |w| at places (n, points, 3), real or complex."""
        axes = self._axes(places)
        if self.coupling.normal is None:
            return sine_and_cosine(self.coupling, *ways(self.coupling, axes))
        letters = self.axes.parts.letters
        turning = next((part for part in self.parts if letters[part] == "R"), None)
        normal = self.coupling.normal if turning is None else axes.directions[turning]
        return sine_and_cosine(self.coupling, *ways(self.coupling, axes, normal))

    def _axes(self, places: Floats) -> Axes:
        """The axes of the coupling's joints by places (n, points, 3); others are zero."""
        letters = self.axes.parts.letters
        shape = (len(letters), len(places), 3)
        feet, directions = np.zeros((2, *shape), dtype=places.dtype)
        for k, part in enumerate(self.parts):
            feet[part] = places[:, 2 * k]
            directions[part] = (places[:, 2 * k + 1] - places[:, 2 * k]) / self.size
        return Axes(self.axes.parts, directions, feet)


def transmission_slopes(numbers: Numbers, circuit: Circuit) -> tuple[MeasureSlopes, ...]:
    """The extremes of a circuit's transmission angle with their slopes; NaN by numbers that open the loop."""
    extremes = circuit.transmission
    if extremes is None:
        return ()
    made = AxisPoints.of(numbers, circuit.input_column, circuit.output_column)
    loop = None if made is None else numbers.loop(circuit.input_column, extra=made.points)
    result = []
    for name in ("lowest", "highest"):
        value, at = getattr(extremes, name), getattr(extremes, f"{name}_at")
        slopes = np.full(len(numbers.names), np.nan)
        if made is not None and loop is not None:
            here = loop.slopes(poses_at(loop, circuit, at), 0)
            own = slice(-len(made.points), None)
            places, by = here.points[:, own, 0], np.moveaxis(here.points_by_number[:, own, 0], 2, 3)
            sine, cosine, sine_by, _ = made.angle(places, by)
            best = nearest(np.abs(np.arctan2(sine, cosine) - value))
            if best is not None and np.isfinite(by[best]).all() and 1 - sine[best] > RIGHT_ANGLE:
                slopes = np.degrees(sine_by[best] / cosine[best])
        if value < DEAD:
            # it is 0 at every dead centre of the input
            slopes = np.zeros(len(slopes))
        result.append(
            MeasureSlopes(f"transmission_{name}", "deg", math.degrees(value), slopes, math.radians(1.0))
        )
    opening = numbers.loop(circuit.input_column).opening(circuit)
    for one in result:
        one.slopes[opening] = np.nan
    return tuple(result)
