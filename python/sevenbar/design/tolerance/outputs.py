"""The outputs that tolerances tell upon: every joint's motion and every named point's, at any numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.design.tolerance.loop import STEP, Loop, Poses
from sevenbar.design.tolerance.numbers import BALL_AXES
from sevenbar.design.tolerance.rigid import Numbers, about, cross, moved, product

#: The quantities of a joint, by the order of the derivative, and what time does to their units.
QUANTITIES = ("position", "velocity", "acceleration")
PER_TIME = ("", "/s", "/s^2")

#: Share of a column, or of a point [parts of the size], in an idle motion that is more than rounding.
TAKES_PART = 1e-9


@dataclass(frozen=True)
class Output:
    """One output: its name ("rocker", "rocker.velocity", "P.x", "P.velocity_x"), its unit, and whose it is.

    `quantity` is one of `QUANTITIES`, `joint` whether it is a joint's; `place` counts the columns or the
    points, `axis` a point's coordinates.
    """

    name: str
    unit: str
    quantity: str
    owner: str
    joint: bool
    place: int
    axis: int = 0


def outputs_of(loop: Loop) -> tuple[Output, ...]:
    """All outputs of a loop: of a ball's turns and of points not every derivative."""
    linkage = loop.whole.linkage
    found = []
    for k, (name, column) in enumerate(zip(linkage.columns, loop.columns, strict=True)):
        unit = "rad" if column.turns else linkage.length_unit
        orders = 0 if k == loop.input else 1 if column.ball else 3
        for quantity, per in zip(QUANTITIES[:orders], PER_TIME, strict=False):
            own = name if quantity == "position" else f"{name}.{quantity}"
            found.append(Output(own, unit + per, quantity, name, True, k))
    for i, point in enumerate(linkage.points):
        for quantity, per in zip(QUANTITIES[:2], PER_TIME, strict=False):
            for axis, letter in enumerate("xyz"):
                own = letter if quantity == "position" else f"{quantity}_{letter}"
                unit = linkage.length_unit + per
                found.append(Output(f"{point.name}.{own}", unit, quantity, point.name, False, i, axis))
    return tuple(found)


def values_of(
    loop: Loop, poses: Poses, outputs: tuple[Output, ...], p: Numbers, u: Numbers, speed: float
) -> Numbers:
    """The outputs (outputs, samples, rows) at numbers p and passive columns u, analytic in both.

    A ball's turns are counted from its rotation at the poses.
    """
    x = np.broadcast_to(poses.x, u.shape[1:])
    walk = loop.walk(p, poses, x, u)
    rates = loop.rates(walk, poses, x, u)
    orders = dict(zip(QUANTITIES, (rates.value, rates.first, rates.second), strict=True))
    built = loop.whole.built(p).points
    places = [
        loop.point(walk, rates, point.link - 1, at)
        for point, at in zip(loop.whole.linkage.points, built, strict=True)
    ]
    values = np.empty((len(outputs), *x.shape), dtype=u.dtype)
    for value, one in zip(values, outputs, strict=True):
        order = QUANTITIES.index(one.quantity)
        own = (
            orders[one.quantity][one.place] * loop.scales[one.place]
            if one.joint
            else places[one.place][order][one.axis]
        )
        value[:] = own * speed**order
    return values


def slopes_of(
    loop: Loop, poses: Poses, outputs: tuple[Output, ...], q: Floats, speed: float
) -> tuple[Floats, Floats]:
    """The outputs (rows, outputs) at poses and derivatives (rows, outputs, numbers); `q` (rows, columns).

    What takes part in an idle motion, of which nothing can be told, is NaN.
    """
    by_p, p, u = loop.slopes(poses)
    values = values_of(loop, poses, outputs, loop.nominal, poses.u, speed)[:, 0]
    slopes = values_of(loop, poses, outputs, p, u, speed).imag / STEP
    turned = _ball_turns(loop, poses, q, by_p)
    for k, one in enumerate(outputs):
        if one.joint and one.place in turned:
            values[k], slopes[k] = q[:, one.place], turned[one.place]
    idle = idle_outputs(loop, poses, outputs)
    slopes[idle] = np.nan
    return values.T, np.moveaxis(slopes, (0, 1, 2), (1, 2, 0))


def _ball_turns(loop: Loop, poses: Poses, q: Floats, by_p: Floats) -> dict[int, Floats]:
    """The derivatives (numbers, rows) of balls' turns about z, y, x, by column.

    A small turn (c, b, a) from the rotation R is R (c, b, a) in the frame before; the turns' derivatives make
    up the same by the axes z, Rz y and Rz Ry x.
    """
    found: dict[int, Floats] = {}
    for k, column in enumerate(loop.columns):
        if not column.ball or column.axis != BALL_AXES[0]:
            continue
        first, second = about(2, q[:, k]), about(1, q[:, k + 1])
        axes = [
            np.broadcast_to(np.eye(3)[:, 2:], first[:, 0].shape),
            first[:, 1],
            product(first, second)[:, 0],
        ]
        rotation = poses.balls[column.joint][:, :, 0]
        own = by_p[[loop.passive.index(k + i) for i in range(3)]]
        small = np.einsum("ijr,jkr->rik", rotation[:, list(BALL_AXES)], own)
        matrix = np.moveaxis(np.stack(axes, axis=1), 2, 0)
        with np.errstate(all="ignore"):
            turns = np.linalg.solve(matrix, small)
        found |= {k + i: turns[:, i].T for i in range(3)}
    return found


def idle_outputs(loop: Loop, poses: Poses, outputs: tuple[Output, ...]) -> npt.NDArray[np.bool_]:
    """Which outputs take part in a motion of the loop that the input does not determine."""
    idle = np.zeros((len(loop.columns), poses.idle.shape[1], len(poses)))
    idle[loop.passive] = np.moveaxis(poses.idle, 2, 0).swapaxes(1, 2)
    walk = loop.walk(loop.nominal, poses, poses.x, poses.u)
    columns = np.abs(idle).max(axis=(1, 2), initial=0.0) > TAKES_PART
    points = []
    for point, at in zip(loop.whole.linkage.points, loop.whole.built(loop.nominal).points, strict=True):
        place = moved(walk.links[point.link - 1], at / loop.size)
        velocity = np.zeros((3, *idle.shape[1:]))
        for column, screw, share in zip(loop.columns, walk.screws, idle, strict=True):
            # the ground does not move, whatever rounding the whole loop adds up to
            if column.joint < point.link < len(walk.links):
                velocity = velocity + (cross(screw[:3], place) + screw[3:]) * share
        points.append(bool(np.abs(velocity).max(initial=0.0) > TAKES_PART))
    return np.array([columns[one.place] if one.joint else points[one.place] for one in outputs], dtype=bool)
