"""The transmission angle's extremes in closed form: planar and spherical four-bars, slider-cranks.

Held between the pins of the input and the output link, the coupler sees them B apart, so that with b and c
from the pin on the coupler to both

    tan^2 (mu / 2) = h(B - b + c) h(B + b - c) / (h(b + c - B) h(b + c + B))                               (1)

with h(y) = y in the plane and sin(y / 2) on the sphere. B is extreme where the input link is in line with the
ground, or for a slide as the input where its pin is next to the output's. A slide as the output has
cos mu = k / b, with k the rod's part square to it, extreme where the crank is square to it, too.

Source: docs/theory_measures.md, (4) to (7); H. Alt, Werkstattstechnik 26 (1932).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Extremes
from sevenbar.kinematics.loop.grashof import EQUAL_SUMS
from sevenbar.kinematics.transmission.angle import ALIKE, Coupling
from sevenbar.kinematics.transmission.axes import Axes

#: Lengths below this part of the loop, and sines of arcs, leave nothing that could drive.
NO_LENGTH = 1e-12


@dataclass(frozen=True, eq=False)
class AngleCourse:
    """How the angle follows the input: stationary at the input `place`, and half a turn on if it `turns`.

    `angle` has it at an input [rad, 0 to pi]; `square` are the inputs away from `place` at which it is a
    right angle, `None` where there are none.
    """

    place: float
    turns: bool
    angle: Callable[[float], float]
    square: float | None


def closed_extremes(coupling: Coupling, axes: Axes, circuit: Circuit, row: int) -> Extremes | None:
    """The lowest and the highest angle [rad] of a circuit, by the axes of one of its rows.

    `None` for other loops, and where the input does not simply go round or to and fro.
    """
    course = _course(coupling, axes, float(circuit.input[row]))
    if course is None:
        return None
    if circuit.goes_round and course.turns:
        return _round(course, 0.0 if math.isnan(circuit.speed) else float(circuit.input[0]), circuit.turns)
    ends = [centre.input for centre in circuit.dead_centres if centre.kind == "input"]
    if circuit.input_range is None or len(ends) < 2 or not circuit.closed:
        return None
    low, high = circuit.input_range
    if course.turns and not 0 < high - low < math.tau:
        return None
    # at dead centres of the input it is 0
    return _ends([(0.0, x) for x in ends] + [one for one in _stationary(course, low) if low < one[1] < high])


def turns_in_line(coupling: Coupling, letters: str) -> bool:
    """Whether a coupling is that of a four-bar or a slider-crank with an input that may turn."""
    own = "".join(letters[i] for i in (coupling.input, coupling.free[0], coupling.at))
    return coupling.kind != "ball" and own == "RRR" and letters[coupling.output] in "RP"


@np.errstate(invalid="ignore", divide="ignore")
def turning_cosines(coupling: Coupling, axes: Axes) -> Floats | None:
    """The cosines (n, 2) of the angle where the input is in line with the ground, by the axes of poses.

    For a slide as the output where it is square to that. Beyond 1 the input does not turn so far. Analytic in
    the axes, real or complex; not finite where two axes coincide. `None` for other loops, and for a slide as
    the input.
    """
    letters, pin, near, output = axes.parts.letters, coupling.at, coupling.free[0], coupling.output
    if not turns_in_line(coupling, letters):
        return None
    around = [coupling.input, near, pin, output]
    ways = np.array([1.0, -1.0])
    if coupling.normal is None:
        own = axes.directions[around]
        then = np.roll(own, -1, axis=0)
        across = np.cross(own, then)
        cosines = (own * then).sum(axis=-1)[..., None]
        sines = np.sqrt((across * across).sum(axis=-1))[..., None]
        apart = cosines[0] * cosines[3] + ways * sines[0] * sines[3]
        return np.asarray((apart - cosines[1] * cosines[2]) / (sines[1] * sines[2]))
    normal = axes.directions[coupling.input]
    places = axes.places[around]
    flat = places - (places * normal).sum(axis=-1)[..., None] * normal
    sides = np.roll(flat, -1, axis=0) - flat
    a, b, c, d = np.sqrt((sides * sides).sum(axis=-1))[..., None]
    if letters[output] == "P":
        square = np.cross(normal, axes.directions[output])
        offset = ((flat[2] - flat[0]) * square).sum(axis=-1)[:, None]
        return np.asarray((offset - ways * a) / b)
    return np.asarray((b * b + c * c - (d - ways * a) ** 2) / (2 * b * c))


def _round(course: AngleCourse, start: float, turns: int) -> Extremes:
    """Those of an input that turns fully, at inputs of its turns from the start on."""
    ends = _ends(_stationary(course, start))
    last = math.tau * (max(turns, 1) - 1)
    return Extremes(ends.lowest, ends.lowest_at, ends.highest, ends.highest_at + last)


def _stationary(course: AngleCourse, low: float) -> list[tuple[float, float]]:
    """The angles where it is stationary or a right one, with their inputs, of one turn from `low` on."""
    places = [course.place, course.place + math.pi] if course.turns else [course.place]
    result = [(_acute(course.angle(x)), x) for x in places]
    if course.square is not None:
        result += [(math.pi / 2, course.place + way * course.square) for way in (-1, 1)]
    return [(angle, low + (x - low) % math.tau) for angle, x in result] if course.turns else result


def _ends(result: list[tuple[float, float]]) -> Extremes:
    """The lowest and the highest of angles and inputs; of those alike the first, and the last."""
    lowest, highest = min(result)[0], max(result)[0]
    return Extremes(
        lowest,
        min(x for angle, x in result if angle <= lowest + ALIKE),
        highest,
        max(x for angle, x in result if angle >= highest - ALIKE),
    )


def _acute(angle: float) -> float:
    return min(angle, math.pi - angle)


def _course(coupling: Coupling, axes: Axes, x: float) -> AngleCourse | None:
    """That of a coupling whose joints are in a pose, at the input x."""
    letters, pin, near, output = axes.parts.letters, coupling.at, coupling.free[0], coupling.output
    if coupling.kind == "ball" or "P" in (letters[near], letters[pin]):
        return None
    four = sorted((coupling.input, near, pin, output))
    # counted ahead, the joint carries the coupler's pin on, otherwise the ground
    way = 1.0 if (four.index(near) - four.index(coupling.input)) % len(four) == 1 else -1.0
    directions, places = axes.directions[:, 0], axes.places[:, 0]
    if coupling.normal is None:
        return _on_sphere(directions[[coupling.input, near, pin, output]], way, x)
    normal = coupling.normal
    plane = places - np.outer(places @ normal, normal)
    own, first, middle, last = (plane[i] for i in (coupling.input, near, pin, output))
    # all inputs count about the normal
    turn = way * math.copysign(1.0, float(directions[coupling.input] @ normal))
    if letters[output] == "P":
        if letters[coupling.input] == "P":
            return None
        square = np.cross(normal, directions[output])
        return _to_slide(first - own, middle - own, square, normal, turn, x)
    b, c = math.dist(first, middle), math.dist(middle, last)
    if letters[coupling.input] == "P":
        return _from_slide(first - last, directions[coupling.input], b, c, way, x)
    arm, ground = first - own, last - own
    a, d = math.hypot(*arm), math.hypot(*ground)
    if min(a, b, c, d) <= NO_LENGTH * (a + b + c + d):
        return None
    bend = math.atan2(float(np.cross(ground, arm) @ normal), float(ground @ arm))
    place = x - turn * bend
    square_away = _arc_cosine((a * a + d * d - b * b - c * c) / (2 * a * d))

    def angle(x: float) -> float:
        half = math.sin((x - place) / 2)
        return _of_apart(math.sqrt((a - d) ** 2 + 4 * a * d * half * half), b, c, a + d)

    return AngleCourse(place, True, angle, square_away)


def _on_sphere(axes: Floats, way: float, x: float) -> AngleCourse | None:
    own, first, middle, last = axes
    a, b, c, d = (_arc(*pair) for pair in ((own, first), (first, middle), (middle, last), (last, own)))
    if min(map(math.sin, (a, b, c, d))) <= NO_LENGTH:
        return None
    across, ahead = np.cross(own, last), np.cross(own, first)
    bend = math.atan2(float(np.cross(across, ahead) @ own), float(across @ ahead))
    place = x - way * bend
    arms = math.sin(a) * math.sin(d)
    square = _arc_cosine((math.cos(b) * math.cos(c) - math.cos(a) * math.cos(d)) / arms)

    def angle(x: float) -> float:
        half = math.sin((x - place) / 2)
        # haversines keep small arcs
        apart = math.sin((a - d) / 2) ** 2 + arms * half * half
        return _of_apart(2 * math.asin(math.sqrt(min(apart, 1.0))), b, c, a + d, sphere=True)

    return AngleCourse(place, True, angle, square)


def _from_slide(apart: Floats, slide: Floats, b: float, c: float, way: float, x: float) -> AngleCourse | None:
    if min(b, c) <= NO_LENGTH * (b + c):
        return None
    along = float(apart @ slide)
    offset, place = math.hypot(*(apart - along * slide)), x - way * along
    beyond = b * b + c * c - offset * offset

    def angle(x: float) -> float:
        return _of_apart(math.hypot(offset, x - place), b, c, offset)

    return AngleCourse(place, False, angle, math.sqrt(beyond) if beyond >= 0 else None)


def _to_slide(
    arm: Floats, pin: Floats, square: Floats, normal: Floats, turn: float, x: float
) -> AngleCourse | None:
    a, b, offset = math.hypot(*arm), math.dist(arm, pin), float(pin @ square)
    if min(a, b) <= NO_LENGTH * (a + b):
        return None
    place = x - turn * math.atan2(float(np.cross(square, arm) @ normal), float(square @ arm))
    every = a + b + abs(offset)

    def angle(x: float) -> float:
        part = offset - a * math.cos(x - place)
        rest, beyond = (0.0 if y <= EQUAL_SUMS * every else y for y in (b - part, b + part))
        return 2 * math.atan2(math.sqrt(rest), math.sqrt(beyond))

    return AngleCourse(place, True, angle, _arc_cosine(offset / a))


def _of_apart(apart: float, b: float, c: float, rest: float, *, sphere: bool = False) -> float:
    """The angle (1) of pins so far apart; sums of links that are equal fold it flat."""
    tiny = EQUAL_SUMS * (b + c + rest)
    whole = b + c + apart
    parts = [apart - b + c, apart + b - c, b + c - apart, min(whole, math.tau - whole) if sphere else whole]
    halves = [0.0 if y <= tiny else math.sin(y / 2) if sphere else y for y in parts]
    return 2 * math.atan2(math.sqrt(halves[0] * halves[1]), math.sqrt(halves[2] * halves[3]))


def _arc(a: Floats, b: Floats) -> float:
    return math.atan2(math.hypot(*np.cross(a, b)), float(a @ b))


def _arc_cosine(cosine: float) -> float | None:
    return math.acos(cosine) if abs(cosine) <= 1 else None
