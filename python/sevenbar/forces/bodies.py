"""Bodies on links: mass, centre and inertia, checked; several on a link as one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_number, place_of_link, positive_length, triple
from sevenbar.errors import RequestError, check_word, shown, suggestion
from sevenbar.forces.solids import DENSITIES, box, cylinder

Three = tuple[float, float, float]

#: Where centre and inertia come from if they are not given.
Solid = Literal["rod", "cylinder", "box", "point", "drawn"]

SOLIDS: tuple[str, ...] = get_args(Solid)

#: The solids of a shape that is given with them, and the keys that belong to each.
SHAPES: Mapping[str, tuple[str, ...]] = {
    "cylinder": ("density", "diameter", "bore", "ends"),
    "box": ("density", "size", "along", "side"),
}

#: A direction with a greater part of it along y lies along y, so that z is across it.
ALONG_Y = 0.999

#: Two directions with a smaller sine are one, by the rounding of their numbers.
ONE_LINE = 1e-12

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

    - "point", all mass in the centre;
    - "rod", uniform and thin between the link's two joints;
    - "cylinder", a round bar of a `diameter`, a tube with a `bore` [length], between `ends`, two places (3,)
      written as points of the link, or the link's two joints;
    - "box", with edges `size` (3,) [length] about its `centre`, the first edge along the direction `along`
      (3,), the second along `side` (3,) as far as that is square to it; x and y of the points if left out;
    - "drawn", the solids that exports draw, of steel where `mass` is 0.

    A cylinder or a box has a `mass` or a `density` [kg/m^3], a number, a text as in "7.85 g/cm^3", or the
    name of a material as in "steel". Raises `RequestError` for an inertia that no body has.
    """

    mass: float = 0.0
    centre: tuple[float, float, float] | None = None
    inertia: npt.ArrayLike | None = None
    solid: Solid | None = None
    density: float | str | None = None
    diameter: float | None = None
    bore: float | None = None
    ends: tuple[Three, Three] | None = None
    size: Three | None = None
    along: Three | None = None
    side: Three | None = None

    def __post_init__(self) -> None:
        mass = finite_number("mass", self.mass)
        if self.solid is not None:
            check_word("solid", self.solid, SOLIDS)
        if self.density is not None:
            object.__setattr__(self, "density", density_of(self.density))
        if mass < 0 or (mass == 0 and self.solid != "drawn" and self.density is None):
            more = ", or a density" if self.solid in SHAPES else ""
            raise RequestError(f"mass: {shown(self.mass)} is not a mass; give kilograms > 0{more}")
        object.__setattr__(self, "mass", mass)
        self._check_shape()
        has_own_place = self.solid in ("rod", "drawn", "cylinder")
        if (has_own_place and self.centre is not None) or (
            (self.is_shaped or has_own_place) and self.inertia is not None
        ):
            what = "inertia; leave it" if self.solid == "box" else "centre and inertia; leave both"
            raise RequestError(f"solid: {self.solid} has its own {what} out")
        if self.solid == "point" and self.inertia is not None:
            raise RequestError("solid: a point has no inertia about itself; leave inertia out")
        if not has_own_place:
            if self.centre is None:
                raise RequestError("centre: is missing; give three lengths, or solid")
            object.__setattr__(self, "centre", place_of_link("centre", self.centre))
        object.__setattr__(
            self, "inertia", np.zeros((3, 3)) if self.inertia is None else _inertia(self.inertia)
        )

    @property
    def is_shaped(self) -> bool:
        """Whether mass, centre and inertia follow from a shape that is given here."""
        return self.solid in SHAPES

    def _check_shape(self) -> None:
        """Refuses what does not belong to the solid, and shapes that are none."""
        keys_of_solid = SHAPES.get(self.solid or "", ())
        for key in ("density", "diameter", "bore", "ends", "size", "along", "side"):
            if getattr(self, key) is not None and key not in keys_of_solid:
                where = " or ".join(f"'{solid}'" for solid, keys in SHAPES.items() if key in keys)
                raise RequestError(f"{key}: belongs to solid = {where}; leave it out, or give that solid")
        if not keys_of_solid:
            return
        if self.density is not None and self.mass:
            raise RequestError("density: mass is given; leave one of them out")
        if self.solid == "cylinder":
            self._check_cylinder()
        else:
            self._check_box()

    def _check_cylinder(self) -> None:
        if self.diameter is None:
            raise RequestError("diameter: is missing; give that of the cylinder")
        for key in ("diameter", "bore"):
            if getattr(self, key) is not None:
                object.__setattr__(self, key, positive_length(key, getattr(self, key)))
        if self.bore is not None and self.bore >= self.diameter:
            raise RequestError(
                f"bore: {shown(self.bore)} is not below the diameter {self.diameter:g}; "
                "give less, or leave it out of a solid bar"
            )
        if self.ends is not None:
            if not isinstance(self.ends, (tuple, list, np.ndarray)) or len(self.ends) != 2:
                raise RequestError("ends: give two places, the middles of the cylinder's ends")
            ends = place_of_link("ends[0]", self.ends[0]), place_of_link("ends[1]", self.ends[1])
            if ends[0] == ends[1]:
                raise RequestError("ends: both are one place; give two")
            object.__setattr__(self, "ends", ends)

    def _check_box(self) -> None:
        if self.size is None:
            raise RequestError("size: is missing; give the three edges of the box")
        size = triple("size", self.size)
        for i, edge in enumerate(size):
            positive_length(f"size[{i}]", edge)
        object.__setattr__(self, "size", size)
        for key in ("along", "side"):
            if getattr(self, key) is not None:
                object.__setattr__(self, key, triple(key, getattr(self, key)))
        _axes_of_box(self)

    @property
    def tensor(self) -> Floats:
        """The inertia (3, 3) [kg m^2]; of one number, that about the axis of the zs alone."""
        inertia = np.asarray(self.inertia, dtype=np.float64)
        return inertia if inertia.ndim else float(inertia) * np.diag([0.0, 0.0, 1.0])

    @property
    def alone(self) -> tuple[float, Floats | None] | None:
        """The moment [kg m^2] that is given alone, and about which axis (3,); `None` for that across.

        `None` of a body with a whole inertia.
        """
        inertia = np.asarray(self.inertia, dtype=np.float64)
        if not inertia.ndim:
            return float(inertia), None
        moments, axes = np.linalg.eigh(inertia)
        return (float(moments[2]), axes[:, 2]) if is_alone(inertia) else None

    def about(self, normal: Floats) -> Body:
        """The same as a lamina: half of what is given alone about all axes square to it."""
        if self.alone is None:
            return self
        across = np.outer(normal, normal)
        return Body(self.mass, self.centre, self.alone[0] / 2 * (np.eye(3) + across))


def shaped(body: Body, metre: float, joints: tuple[Floats, Floats]) -> Body:
    """A cylinder or a box by its mass, centre and inertia; without ends between the link's `joints`.

    `metre` is the length unit in metres. Raises `RequestError` where the joints are at one place.
    """
    if body.solid == "box":
        assert body.size is not None
        solid = box(np.array(body.centre), np.array(body.size), _axes_of_box(body))
    else:
        start, end = joints if body.ends is None else (np.array(place) for place in body.ends)
        if not np.any(end - start):
            raise RequestError("ends: is missing; both joints of the link are at one place, so give two")
        assert body.diameter is not None
        solid = cylinder(start, end, body.diameter, body.bore or 0.0)
    # of very small and very large units, too
    mass = body.mass or float(body.density or 0.0) * metre**3 * solid.volume
    return Body(mass, triple("centre", solid.centre), mass * metre**2 * solid.inertia)


def density_of(value: object) -> float:
    """A density [kg/m^3] that is given as a number, as a text with a unit, or as a material's name."""
    if isinstance(value, str):
        if value in DENSITIES:
            return DENSITIES[value]
        # `import sevenbar` needs no reader of units
        from sevenbar.text.quantities import quantity_of

        try:
            value = quantity_of(value, "density")
        except RequestError:
            near = suggestion(value, DENSITIES)
            raise RequestError(
                f"density: {shown(value)} is no density; {near}give kg/m^3, one as in '7.85 g/cm^3', or one "
                f"of {', '.join(DENSITIES)}"
            ) from None
    number = finite_number("density", value)  # type: ignore[arg-type]
    if number <= 0:
        raise RequestError(f"density: {shown(value)} is not a density; give kg/m^3 > 0")
    return number


def _axes_of_box(body: Body) -> Floats:
    """The directions (3, 3) of a box's edges, rows; `RequestError` for two that span no plane."""
    first = _unit_vector("along", (1.0, 0.0, 0.0) if body.along is None else body.along)
    # y of the points, or where the first edge lies along it, z
    otherwise = (0.0, 1.0, 0.0) if abs(first[1]) < ALONG_Y else (0.0, 0.0, 1.0)
    second = _unit_vector("side", otherwise if body.side is None else body.side)
    second = second - (second @ first) * first
    sine = float(np.linalg.norm(second))
    if sine <= ONE_LINE:
        raise RequestError("side: lies along the first edge; give a direction across it")
    second = second / sine
    return np.stack([first, second, np.cross(first, second)])


def _unit_vector(name: str, direction: Three) -> Floats:
    """The unit vector (3,) of a direction of any size, or `RequestError`."""
    vector = np.array(direction)
    if not vector.any():
        raise RequestError(f"{name}: (0, 0, 0) has no direction; give three numbers, not all 0")
    # squares of very small and very large numbers are no longer finite numbers > 0
    vector = vector / np.abs(vector).max()
    return np.asarray(vector / np.linalg.norm(vector))


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
        return (
            f"principal moments {listed}: no body has one greater than the sum of the others; "
            "give the entries of the tensor about the centre"
        )
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
    try:
        is_one_number = np.ndim(values) == 0
    except ValueError:  # rows of different lengths
        is_one_number = False
    if not is_one_number:
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
        raise RequestError(
            "inertia: the tensor is not symmetric; give each product of inertia twice, as in Ixy = Iyx"
        )
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
