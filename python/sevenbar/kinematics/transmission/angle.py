"""The transmission angle: how squarely the coupler pushes the output.

With the input held, the joint through which the coupler drives the output link can move one way, along u; the
output moves it another way, along w. What the coupler transmits does no work along u. So

    sin(mu) = |u x w| / (|u| |w|)                                                                          (4)

for the pin of a planar loop, or of a dyad of a net (u and w in its plane), and for the axis of a spherical
loop as a point of the sphere. A ball can move in a plane with the input held, and the force f is square to
that plane,

    sin(mu) = |f . w| / (|f| |w|),                                                                         (5)

f along the coupler where it has a ball at its other end too. Where u, w or f vanishes in a pose, its
direction does not: that of its derivative along the circuit is its limit from both sides. The pressure angle
is 90 degrees less mu.

Source: docs/theory_measures.md, (4) to (7); H. Alt, Werkstattstechnik 26 (1932) for the plane; G. Sutherland,
B. Roth, J. Eng. Ind. 95 (1973) 589, for the force of a spatial coupler.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sevenbar.arrays import Booleans, Floats
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.nets.order import order_of
from sevenbar.kinematics.solvers.general import expanded, steps_of
from sevenbar.kinematics.solvers.plane_and_sphere import InPlane, in_plane, sphere_of
from sevenbar.kinematics.transmission.axes import COMPLEX_STEP, Axes, axes_along

#: Angles [rad] nearer than this differ by rounding.
ALIKE = 4e-15

#: A direction whose size is below this part of what it could be vanishes: rounding has half of its digits.
VANISHES = 1e-8

#: An angle [rad] below this is that of a dead centre of the input, known to the root of rounding.
AT_DEAD_CENTRE = 1e-7

#: A loop with so many joints that move, in the plane or on the sphere.
FOUR = 4


@dataclass(frozen=True, eq=False)
class Coupling:
    """How the coupler drives the output link, by joints as `expanded` numbers them.

    In a "planar" loop at the place of the joint `at`, which `free` moves along u; in a "spherical" one at the
    axis of `at`; "ball": at the ball `at`, with a force from the ball `free[0]`, or square to how the two
    joints `free` move it. `output` moves it along w; `input` is held.
    """

    kind: Literal["planar", "spherical", "ball"]
    at: int
    free: tuple[int, ...]
    output: int
    input: int
    #: Of the plane (3,); that of a dyad is the axis of its pins.
    normal: Floats | None = None
    #: Of a dyad of a net, next to which other loops may make the input turn back.
    is_dyad: bool = False


def coupling_of(loop: Loop, input: int, output: int) -> Coupling | None:
    """How a loop driven by one column moves another; `None` where no transmission angle is defined."""
    if loop.net is not None:
        return _of_dyad(loop, input, output)
    parts = expanded(loop)
    first, second = parts.columns.index(input), parts.columns.index(output)
    if "S" in (parts.letters[first], parts.letters[second]):
        return None
    if parts.letters.count("S") == 2:
        return _through_a_ball(parts.letters, parts.last, first, second)
    plane = in_plane(loop)
    if plane is not None:
        return _in_plane(parts.letters, plane, first, second)
    if parts.letters == "R" * FOUR and sphere_of(loop) is not None:
        passive = _between((0, 1, 2, 3), first, second)
        return None if passive is None else Coupling("spherical", passive[1], passive[:1], second, first)
    return _through_a_ball(parts.letters, parts.last, first, second)


def _between(moves: tuple[int, ...], first: int, second: int) -> tuple[int, int] | None:
    """Of four joints the one next to the input and the one next to the output, if these are neighbours."""
    if len(moves) != FOUR or first not in moves or second not in moves:
        return None
    a, b = moves.index(first), moves.index(second)
    if (a - b) % FOUR == 1:
        return moves[(a + 1) % FOUR], moves[(b - 1) % FOUR]
    if (b - a) % FOUR == 1:
        return moves[(a - 1) % FOUR], moves[(b + 1) % FOUR]
    return None


def _in_plane(letters: str, in_plane: InPlane, first: int, second: int) -> Coupling | None:
    passive = _between(in_plane.moves, first, second)
    pin = None if passive is None else _driving_pin(letters, *passive)
    return None if pin is None else Coupling("planar", *pin, second, first, in_plane.plane.normal)


def _driving_pin(letters: str, near_input: int, near_output: int) -> tuple[int, tuple[int]] | None:
    """The pin through which a coupler drives, and what moves it; `None` between two slides.

    A force acts at a pin: where the output is driven by a slide, at that before it.
    """
    if letters[near_output] != "P":
        return near_output, (near_input,)
    if letters[near_input] != "P":
        return near_input, (near_output,)
    return None


def _of_dyad(net: Loop, input: int, output: int) -> Coupling | None:
    """The dyad of a net that has the output between it and a link that is known before it is solved."""
    held, driven = net.joint_of(input), net.column_of(output).joint
    between, steps = net.graph.between, steps_of(net)
    for block in order_of(net, input).blocks:
        # of a dyad with the input between two of its links, either would be the coupler
        if block.solver != "dyad" or driven not in block.joints or set(between[held]) & set(block.links):
            continue
        outer = [joint for joint in block.joints if set(between[joint]) != set(block.links)]
        if driven not in outer:
            return None
        (middle,) = set(block.joints) - set(outer)
        (other,) = set(outer) - {driven}
        first, *parts = (
            steps.columns.index(net.places[joint].start) for joint in (held, other, middle, driven)
        )
        pin = _driving_pin(steps.letters, *parts[:2])
        return None if pin is None else Coupling("planar", *pin, parts[2], first, is_dyad=True)
    return None


def _through_a_ball(letters: str, last: list[int], first: int, second: int) -> Coupling | None:
    """A ball next to the output joint, not past the input, and what else moves it: a ball or two joints."""
    count = len(letters)
    owner = [sum(end < part for end in last) for part in range(count)]
    for way in (-1, 1):
        part = (second + way) % count
        while owner[part] == owner[second] and part != first:
            part = (part + way) % count
        if part == first or letters[part] != "S":
            continue
        others = tuple(i for i in range(count) if i not in (first, second, part))
        kinds = "".join(letters[i] for i in others)
        if kinds == "S" or (len(kinds) == 2 and "S" not in kinds):
            return Coupling("ball", part, others, second, first)
    return None


def ways(coupling: Coupling, axes: Axes, normal: Floats | None = None) -> tuple[Floats, Floats, Floats]:
    """u, or the force f, and w on each row (n, 3), and what u and w are in a plane square to.

    Polynomials of the axes, so that those of complex axes are their derivatives' (a complex step). A plane's
    `normal` (3,), or (n, 3), is the coupling's own unless given.
    """
    at, output = coupling.at, coupling.output
    if coupling.kind == "spherical":
        here = axes.directions[at]
        u, w = (np.cross(axes.directions[i], here) for i in (coupling.free[0], output))
        return u, w, here
    here = axes.places[at]
    w = axes.velocity(output, here)
    if normal is None:
        normal = axes.directions[at] if coupling.is_dyad else coupling.normal
    if normal is not None:
        free = coupling.free[0]
        # a ball is a pin there
        turned = np.cross(normal, here - axes.places[free])
        u = turned if axes.parts.letters[free] == "S" else axes.velocity(free, here)
        w = np.cross(normal, here - axes.places[output]) if axes.parts.letters[output] == "S" else w
        return u, w, np.broadcast_to(normal, u.shape)
    if len(coupling.free) == 1:
        return axes.places[coupling.free[0]] - here, w, w
    first, second = coupling.free
    return np.cross(axes.velocity(first, here), axes.velocity(second, here)), w, w


def sine_and_cosine(coupling: Coupling, u: Floats, w: Floats, square: Floats) -> tuple[Floats, Floats]:
    """Sine and cosine of the angle on each row (n,) times |u| |w|, with signs that run on along a circuit.

    Of a ball the cosine, which has no sign, is above zero. Analytic in `ways`.
    """
    if coupling.kind == "ball":
        across = np.cross(u, w)
        return (u * w).sum(axis=1), np.sqrt((across * across).sum(axis=1))
    return (np.cross(u, w) * square).sum(axis=1), (u * w).sum(axis=1)


@dataclass(frozen=True, eq=False)
class Angles:
    """Sine and cosine of the angle on rows (n,), and how large u and w are there, of what they could be (n,).

    NaN without a pose, and where u or w vanishes.
    """

    sine: Floats
    cosine: Floats
    share: Floats

    @staticmethod
    def of(coupling: Coupling, axes: Axes, size: float) -> Angles:
        """Those of axes; `size` is that of the linkage."""
        sizes = _sizes(coupling, axes, size)
        u, w, square = ways(coupling, axes)
        with np.errstate(invalid="ignore", divide="ignore"):
            share = np.minimum(
                *(np.linalg.norm(v, axis=1) / own for v, own in zip((u, w), sizes, strict=True))
            )
            sine, cosine = sine_and_cosine(coupling, u, w, square)
            whole = np.where(share < VANISHES, np.nan, np.hypot(sine, cosine))
            return Angles(sine / whole, cosine / whole, share)


def _sizes(coupling: Coupling, axes: Axes, size: float) -> tuple[float, float]:
    """What 1 of u and of w is: the linkage's size for each joint that turns the point."""
    if coupling.kind == "spherical":
        return 1.0, 1.0
    slides = [axes.parts.letters[i] == "P" for i in (*coupling.free, coupling.output)]
    free = math.prod(1.0 if slide else size for slide in slides[:-1])
    return free, 1.0 if slides[-1] else size


def angles_along(loop: Loop, coupling: Coupling, circuit: Circuit) -> tuple[Floats, Angles]:
    """The angle [rad] on each row of a circuit (n,), up to a right angle, and what it is made of.

    At a dead centre of the input it is 0, but where u or w vanishes it is its limit; that of a dyad is not
    known there.
    """
    axes = axes_along(loop, circuit)
    result = Angles.of(coupling, axes, circuit.size)
    angle = np.arctan2(np.abs(result.sine), np.abs(result.cosine))
    vanishing = result.share < VANISHES
    angle[(circuit.status == "dead-centre") & ~vanishing & is_zero(coupling, angle)] = 0.0
    if coupling.is_dyad:
        angle[vanishing] = math.nan
        return angle, result
    for row in np.flatnonzero(vanishing):
        angle[row] = _limit(coupling, axes.at(int(row)), circuit.size)
    return angle, result


def is_zero(coupling: Coupling, angles: Floats) -> Booleans:
    """Which angles [rad] (n,) of dead centres of the input are 0: all but those of a dyad not in line."""
    return np.asarray(angles < AT_DEAD_CENTRE) if coupling.is_dyad else np.ones(angles.shape, dtype=bool)


def _limit(coupling: Coupling, axes: Axes, size: float) -> float:
    """The angle in a pose in which u or w vanishes; NaN where no one direction leads on."""
    moving = axes.moving(size)
    if moving is None:
        return math.nan
    here, there = ways(coupling, axes), ways(coupling, moving)
    u, w, square = (
        then.imag / COMPLEX_STEP if np.linalg.norm(now) < VANISHES * own else now
        for now, then, own in zip(here, there, (*_sizes(coupling, axes, size), 1.0), strict=True)
    )
    # of a ball what is square is w itself
    sine, cosine = sine_and_cosine(coupling, u, w, square)
    whole = math.hypot(float(sine[0]), float(cosine[0]))
    return math.atan2(abs(float(sine[0])), abs(float(cosine[0]))) if whole > 0 else math.nan


def transmission_angle(loop: Loop, circuit: Circuit) -> Floats | None:
    """The transmission angle [rad] on each row of a circuit (n,), up to a right angle; NaN without a pose.

    `None` where it is not defined. At a dead centre of the input it is 0, or its limit where the output
    rests, too.

    Source: docs/theory_measures.md, (4) to (6).
    """
    coupling = coupling_of(loop, circuit.input_column, circuit.output_column)
    return None if coupling is None else angles_along(loop, coupling, circuit)[0]
