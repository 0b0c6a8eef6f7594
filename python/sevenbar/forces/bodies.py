"""Bodies on links: mass, centre and inertia, checked; several on a link as one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_number, triple
from sevenbar.errors import RequestError, check_word, shown

#: Where centre and inertia come from if they are not given.
Solid = Literal["rod", "point", "drawn"]

SOLIDS: tuple[str, ...] = get_args(Solid)

#: The order of the entries of an inertia where six numbers give it.
ENTRIES = "xx yy zz yz xz xy"

#: By this part of its greatest principal moment an inertia may break a rule by rounding.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid body that is fixed to a link.

    `mass` [kg]; `centre` (3,) [length] of mass, written as a point of the link is; `inertia` (3, 3) [kg m^2],
    the tensor about the centre along the axes in which points are written, so off the diagonal
    `Ixy = -sum m x y`; of a planar linkage one number will do, about the axis across its plane. Or a `solid`:
    "point", all mass in the centre; "rod", uniform and thin between the link's two joints; "drawn", the
    solids that exports draw, of steel where `mass` is 0. Raises `RequestError` for an inertia that no body
    has.
    """

    mass: float = 0.0
    centre: tuple[float, float, float] | None = None
    inertia: npt.ArrayLike | None = None
    solid: Solid | None = None

    def __post_init__(self) -> None:
        mass = finite_number("mass", self.mass)
        if self.solid is not None:
            check_word("solid", self.solid, SOLIDS)
        if mass < 0 or (mass == 0 and self.solid != "drawn"):
            raise RequestError(f"mass: {shown(self.mass)} is not a mass; give kilograms > 0")
        object.__setattr__(self, "mass", mass)
        made = self.solid in ("rod", "drawn")
        if made and (self.centre is not None or self.inertia is not None):
            raise RequestError(f"solid: {self.solid} has its own centre and inertia; leave both out")
        if self.solid == "point" and self.inertia is not None:
            raise RequestError("solid: a point has no inertia about itself; leave inertia out")
        if not made:
            if self.centre is None:
                raise RequestError("centre: is missing; give three lengths, or solid")
            object.__setattr__(self, "centre", triple("centre", self.centre))
        object.__setattr__(
            self, "inertia", np.zeros((3, 3)) if self.inertia is None else _inertia(self.inertia)
        )

    @property
    def tensor(self) -> Floats:
        """The inertia (3, 3) [kg m^2]; of one number, that about the axis of the zs alone."""
        own = np.asarray(self.inertia, dtype=np.float64)
        return own if own.ndim else float(own) * np.diag([0.0, 0.0, 1.0])

    @property
    def alone(self) -> tuple[float, Floats | None] | None:
        """The moment [kg m^2] that is given alone, and about which axis (3,); `None` for that across.

        `None` of a body with a whole inertia.
        """
        own = np.asarray(self.inertia, dtype=np.float64)
        if not own.ndim:
            return float(own), None
        moments, axes = np.linalg.eigh(own)
        return (float(moments[2]), axes[:, 2]) if is_alone(own) else None

    def about(self, normal: Floats) -> Body:
        """The same as a lamina: half of what is given alone about all axes square to it."""
        assert self.alone is not None
        across = np.outer(normal, normal)
        return Body(self.mass, self.centre, self.alone[0] / 2 * (np.eye(3) + across))


def is_alone(tensor: Floats) -> bool:
    """Whether an inertia (3, 3) is that about one axis alone, which in a planar loop says enough."""
    first, second, third = np.linalg.eigvalsh(tensor)
    return bool(third > 0 and max(abs(first), abs(second)) <= ROUNDING * third)


def flaw_of_inertia(tensor: Floats) -> str:
    """Why no body has an inertia (3, 3); empty where one has, and for one about one axis alone."""
    if is_alone(tensor):
        return ""
    principal = np.linalg.eigvalsh(tensor)
    slack = ROUNDING * float(np.abs(principal).max())
    listed = ", ".join(f"{x:.6g}" for x in principal)
    if principal[0] < -slack:
        return f"principal moments {listed}: one is negative; give the entries of the tensor about the centre"
    if principal[0] + principal[1] < principal[2] - slack:
        return f"principal moments {listed}: no body has one greater than the sum of the others"
    return ""


def tensor_of(entries: Sequence[float]) -> Floats:
    """The inertia (3, 3) of its six entries, in the order of `ENTRIES`.

    >>> tensor_of([4, 5, 6, 0.1, 0.2, 0.3]).tolist()
    [[4.0, 0.3, 0.2], [0.3, 5.0, 0.1], [0.2, 0.1, 6.0]]
    """
    xx, yy, zz, yz, xz, xy = entries
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=np.float64)


def entries_of(tensor: Floats) -> list[float]:
    """The six entries of an inertia (3, 3), in the order of `ENTRIES`."""
    rows, columns = [0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]
    return [float(value) for value in tensor[rows, columns]]


def flaw_alone(body: Body) -> str:
    """What is wrong with an inertia about one axis alone that is not the one across a plane."""
    moment, axis = body.alone or (0.0, None)
    if axis is None:
        return f"{moment:.6g} alone says enough of a planar linkage only; give the six numbers {ENTRIES}"
    return (
        f"principal moments 0, 0, {moment:.6g}: no body has one greater than the sum of the others; of a "
        f"planar linkage give that across its plane alone, as one number; of another all of {ENTRIES}"
    )


def _inertia(values: npt.ArrayLike) -> float | Floats:
    """One number of a planar body, or the tensor (3, 3)."""
    if np.ndim(values):
        return _tensor(values)
    moment = finite_number("inertia", values)
    if moment < 0:
        raise RequestError(f"inertia: {shown(values)} is negative; give kg m^2 >= 0")
    return moment if moment else np.zeros((3, 3))


def _tensor(values: npt.ArrayLike) -> Floats:
    try:
        tensor = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        tensor = np.zeros(0)
    if tensor.shape != (3, 3) or not np.isfinite(tensor).all():
        raise RequestError(f"inertia: {shown(values)} is not an inertia; give 3 x 3 numbers [kg m^2], or one")
    if np.abs(tensor - tensor.T).max() > ROUNDING * np.abs(tensor).max():
        raise RequestError("inertia: the tensor is not symmetric")
    flaw = flaw_of_inertia(tensor)
    if flaw:
        raise RequestError(f"inertia: {flaw}")
    tensor.setflags(write=False)
    return tensor


def inertia_at(mass: float, arm: Floats) -> Floats:
    """The inertia (3, 3) of a mass at an arm (3,) from where it is counted: `m (|a|^2 1 - a a^T)`."""
    return np.asarray(mass * (arm @ arm * np.eye(3) - np.outer(arm, arm)))


def as_one(bodies: Sequence[Body], metre: float) -> Body:
    """Bodies of one link, none of them a rod or drawn, as one; `metre` is the length unit in metres."""
    if len(bodies) == 1:
        return bodies[0]
    mass = math.fsum(body.mass for body in bodies)
    centres = np.array([body.centre for body in bodies])
    centre = np.array([body.mass for body in bodies]) @ centres / mass
    tensor = np.zeros((3, 3))
    for body, place in zip(bodies, centres, strict=True):
        tensor += body.tensor + inertia_at(body.mass, metre * (place - centre))
    return Body(mass, triple("centre", centre), tensor)
