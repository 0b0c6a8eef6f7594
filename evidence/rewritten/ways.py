"""The ways in which a drawing is written again; each keeps or maps the values of its input and output.

A turn, a shift and a scale change no joint value but that slides scale. Of a mirror image with the mirrored
axes of turns reversed, which are axial vectors, values stay as well. From the other end joint i counts the
link that was before it against the one after: with axes reversed values stay again; the first and the last
joint count against the ground both times, so their axes stay. From another joint on, the joint that was last
and the one that is last change sign, and so do their axes here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from evidence.rewritten.drawing import Drawing, Joint
from evidence.rewritten.rows import as_rows
from sevenbar.arrays import Floats
from sevenbar.kinematics.linkage import Linkage

#: How far off a linkage is moved, relative to its size: rounding of places grows by as much.
FAR = 100.0

#: Scales; a third is rounded in every number.
SCALES = (1e-6, 1 / 3, 1e3, 1e6)


@dataclass(frozen=True, eq=False)
class Way:
    """A linkage written anew: `input` and `output` name its columns.

    With `scale` lengths are so many times as great; input and output count `signs` times the old value plus
    `shifts` [rad, or length]. `same_ground`: what is relative to the ground may be compared.
    """

    name: str
    linkage: Linkage
    input: str
    output: str
    scale: float = 1.0
    signs: tuple[float, float] = (1.0, 1.0)
    shifts: tuple[float, float] = (0.0, 0.0)
    same_ground: bool = True
    #: By how much rounding of what is written is greater than that of the drawing.
    rounding: float = 1.0


def ways(one: Drawing, rng: np.random.Generator) -> Iterator[Way]:
    """All ways; the first is as drawn."""
    yield _way("as drawn", one)
    for k in range(3):
        yield _way(f"turned {k + 1}", turned(one, _rotation(rng)))
    yield _way("moved off", moved(one, FAR * one.size * _direction(rng)), rounding=FAR)
    yield _way(
        "turned and moved off",
        moved(turned(one, _rotation(rng)), FAR * one.size * _direction(rng)),
        rounding=FAR,
    )
    yield _way("a quarter about x", turned(one, np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])))
    yield _way("mirrored", mirrored(one))
    yield _way("mirrored and turned", turned(mirrored(one), _rotation(rng)))
    for scale in SCALES:
        yield _way(f"{scale:.3g} times as large", scaled(one, scale), scale=scale)
    yield _way("axes reversed", _each(one, Joint.reversed), signs=(-1.0, -1.0))
    inner = {joint.name for joint in one.joints} - {one.input, one.output}
    yield _way(
        "inner axes reversed", _each(one, lambda joint: joint.reversed() if joint.name in inner else joint)
    )
    yield _way("places moved along axes", slid(one, rng))
    yield _way("places moved, turned", turned(slid(one, rng), _rotation(rng)))
    back = from_the_other_end(one)
    yield _way("from the other end", back)
    yield _way("from the other end, turned", turned(back, _rotation(rng)))
    yield _way("from the other end, mirrored", mirrored(back))
    for k in range(1, len(one.joints)):
        rolled = from_another_joint(one, k)
        yield _way(f"from joint {k + 1} on", rolled, same_ground=False)
        if k == 1:
            yield _way("from joint 2 on, turned", turned(rolled, _rotation(rng)), same_ground=False)
    yield from _rows(one, 1.0)
    yield from _rows(scaled(one, 1e3), 1e3)


def _way(
    name: str,
    one: Drawing,
    *,
    scale: float = 1.0,
    signs: tuple[float, float] = (1.0, 1.0),
    same_ground: bool = True,
    rounding: float = 1.0,
) -> Way:
    return Way(
        name, one.linkage(), one.input, one.output, scale, signs, same_ground=same_ground, rounding=rounding
    )


def _rows(one: Drawing, scale: float) -> Iterator[Way]:
    found = as_rows(one)
    if found is not None:
        linkage, zeros = found
        places = [[joint.name for joint in one.joints].index(name) for name in (one.input, one.output)]
        columns = [linkage.columns[place] for place in places]
        last = len(one.joints) - 1
        # rows count the last joint's motion in loop order
        signs = tuple(-1.0 if place == last else 1.0 for place in places)
        shifts = tuple(zeros[place] for place in places)
        name = "as rows" if scale == 1.0 else f"as rows, {scale:g} times as large"
        yield Way(name, linkage, *columns, scale, signs, shifts)  # type: ignore[arg-type]


def turned(one: Drawing, rotation: Floats) -> Drawing:
    """The drawing turned about the origin."""
    return _each(
        one,
        lambda joint: replace(
            joint, at=rotation @ joint.at, axes=None if joint.axes is None else joint.axes @ rotation.T
        ),
    )


def moved(one: Drawing, by: Floats) -> Drawing:
    """The drawing moved."""
    return _each(one, lambda joint: replace(joint, at=joint.at + by))


def scaled(one: Drawing, scale: float) -> Drawing:
    """The drawing so many times as large."""
    return _each(
        one,
        lambda joint: replace(
            joint, at=scale * joint.at, pitch=None if joint.pitch is None else scale * joint.pitch
        ),
    )


def mirrored(one: Drawing) -> Drawing:
    """The mirror image at x = 0."""
    mirror = np.array([-1.0, 1.0, 1.0])

    def image(joint: Joint) -> Joint:
        axes = None if joint.axes is None else joint.axes * mirror * (1.0 if joint.kind == "P" else -1.0)
        return replace(
            joint, at=joint.at * mirror, axes=axes, pitch=None if joint.pitch is None else -joint.pitch
        )

    return _each(one, image)


def slid(one: Drawing, rng: np.random.Generator) -> Drawing:
    """Places moved along axes that turn, and anywhere for slides."""

    def other(joint: Joint) -> Joint:
        if joint.kind == "P":
            return replace(joint, at=joint.at + one.size * rng.uniform(-1, 1, 3))
        if joint.kind in "RHC" and joint.axes is not None:
            axis = joint.axes / np.linalg.norm(joint.axes)
            return replace(joint, at=joint.at + one.size * rng.uniform(-1, 1) * axis)
        return joint

    return _each(one, other)


def from_the_other_end(one: Drawing) -> Drawing:
    """The joints in the opposite order, on the same ground."""
    ends = one.joints[0].name, one.joints[-1].name

    def back(joint: Joint) -> Joint:
        if joint.kind == "U" and joint.axes is not None:
            # what was carried stays now, and carries the other
            return replace(joint, axes=joint.axes[::-1])
        return joint if joint.name in ends else joint.reversed()

    return replace(one, joints=tuple(map(back, one.joints[::-1])))


def from_another_joint(one: Drawing, k: int) -> Drawing:
    """The loop written from joint k + 1 on: the link before that joint is the ground."""
    changed = one.joints[-1].name, one.joints[k - 1].name
    joints = (*one.joints[k:], *one.joints[:k])
    return replace(
        one, joints=tuple(joint.reversed() if joint.name in changed else joint for joint in joints)
    )


def _each(one: Drawing, change: object) -> Drawing:
    return replace(one, joints=tuple(change(joint) for joint in one.joints))  # type: ignore[operator]


def _rotation(rng: np.random.Generator) -> Floats:
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return np.asarray(q * math.copysign(1.0, np.linalg.det(q)))


def _direction(rng: np.random.Generator) -> Floats:
    direction = rng.normal(size=3)
    return np.asarray(direction / np.linalg.norm(direction))
