"""Where the solids of a plan stand in a pose."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, Integers

#: For each shape of `shapes.mesh`: orientations wxyz (N, 4), positions (N, 3), scales (N, 3).
Poses = dict[str, tuple[Floats, Floats, Floats]]

Colours = npt.NDArray[np.uint8]

#: What is shorter than this share of its width is nothing, and only rounding gives it a direction.
POINT = 1e-6


#: Of each solid the places that say where it stands, joins, guide, roll and slide, and what `SolidPlan` says.
SOLID = np.dtype(
    [
        *(("places", np.int64, 8), ("share", float), ("shift", float), ("length", float), ("twist", float)),
        *(("sides", float, 2), ("colour", np.uint8, 3), ("moves", bool)),
    ]
)


@dataclass(frozen=True, eq=False)
class SolidPlan:
    """The solids of a linkage: what each is, and the places that say where it stands.

    A solid lies along the way between two places `joins`, turned about if that goes against `guide`; its
    middle lies at a `share` of the way, shifted `shift` along it. It is as long as `length`, else (NaN) as
    the way, and `sides` wide. Its x axis is that of the way `roll`, if there is one, turned further by
    `twist` [rad per length] for each length of the way `slide` along it.

    `shapes` are the rows of each shape in `solids` (N,), of `SOLID`; places from `count` on are those of
    `fixed` (m, 3), which never move. `axes` (a, 2) are the ends of the joints' axes; `labels` what is written
    at which place.
    """

    shapes: dict[str, slice]
    solids: npt.NDArray[np.void]
    count: int
    fixed: Floats
    axes: Integers
    labels: tuple[tuple[str, int], ...]

    def known(self, places: Floats) -> Floats:
        """The places (..., k, 3) of a pose, and then those that never move."""
        fixed = np.broadcast_to(self.fixed, (*places.shape[:-2], *self.fixed.shape))
        return np.concatenate([places[..., : self.count, :], fixed], axis=-2)

    def colours_of(self, shape: str) -> Colours:
        """The colours (N, 3) of a shape's solids."""
        colours: Colours = self.solids["colour"][self.shapes[shape]]
        return colours

    def moving(self) -> SolidPlan:
        """The plan of the moving links and joints alone."""
        moves = self.solids["moves"]
        selected = {shape: int(moves[rows].sum()) for shape, rows in self.shapes.items()}
        shapes = slices({shape: count for shape, count in selected.items() if count})
        return replace(self, shapes=shapes, solids=self.solids[moves], axes=self.axes[:0], labels=())


def slices(counts: dict[str, int]) -> dict[str, slice]:
    """The rows of each shape, one shape after the other."""
    result, start = {}, 0
    for shape, count in counts.items():
        result[shape] = slice(start, start + count)
        start += count
    return result


def poses(plan: SolidPlan, places: Floats) -> Poses:
    """Where the solids of each shape stand in a pose, places (..., k, 3); any leading axes are kept.

    What stands on a place that is NaN gets the scale 0, and so do solids of no length.
    """
    known, solids = plan.known(places), plan.solids
    start, end, *others = np.moveaxis(known[..., solids["places"].T, :], -3, 0)
    guide, roll, slide = (others[i + 1] - others[i] for i in (0, 2, 4))
    way = end - start
    length = np.sqrt(_dot(way, way))
    along = way / np.where(length > 0, length, 1.0)[..., None]
    along[length == 0] = (0.0, 0.0, 1.0)
    turned = np.where(_dot(along, guide) < 0, -1.0, 1.0)[..., None]
    along = turned * along
    middle = start + solids["share"][:, None] * way + solids["shift"][:, None] * along
    long = np.where(np.isnan(solids["length"]), length, solids["length"])
    scale = np.concatenate([np.broadcast_to(solids["sides"], (*long.shape, 2)), long[..., None]], axis=-1)
    turn = turns(along, roll, solids["twist"] * _dot(slide, along))
    hidden = np.isnan(middle + turn[..., :3]).any(axis=-1) | ~(long > POINT * solids["sides"][:, 0])
    if hidden.any():
        middle, scale = np.where(hidden[..., None], 0.0, middle), np.where(hidden[..., None], 0.0, scale)
        turn = np.where(hidden[..., None], (1.0, 0.0, 0.0, 0.0), turn)
    return {
        shape: (turn[..., rows, :], middle[..., rows, :], scale[..., rows, :])
        for shape, rows in plan.shapes.items()
    }


def stretched(start: Floats, end: Floats, radius: float) -> tuple[Floats, Floats, Floats]:
    """Where solids of a radius stand that reach from start to end, (n, 3) each; see `Poses`."""
    way = end - start
    length = np.sqrt(_dot(way, way))[:, None]
    known = (length > 0) & np.isfinite(length)
    along = np.where(known, way / np.where(length > 0, length, 1.0), (0.0, 0.0, 1.0))
    scale = np.where(known, np.concatenate([0 * length + radius, 0 * length + radius, length], axis=1), 0.0)
    return turns(along, np.zeros_like(along)), np.where(known, (start + end) / 2, 0.0), scale


def _dot(one: Floats, other: Floats) -> Floats:
    product: Floats = np.einsum("...i,...i->...", one, other)
    return product


def turns(along: Floats, roll: Floats, twist: Floats | float = 0.0) -> Floats:
    """Unit quaternions wxyz (..., 4) that turn z onto `along` (..., 3) and x towards `roll` (..., 3).

    Where the roll is 0 they turn no more than they must. `twist` [rad] turns further about z.
    """
    x, y, z = np.moveaxis(along, -1, 0)
    flat = np.hypot(x, y)
    # 1 + z without its cancellation near -z
    w = np.where(z < 0, flat * flat / np.where(z < 0, 1.0 - z, 1.0), 1.0 + z)
    norm = np.hypot(w, flat)
    straight_down = norm == 0
    norm = np.where(straight_down, 1.0, norm)
    w, a, b = w / norm, np.where(straight_down, 1.0, -y / norm), x / norm
    # the rotated x and y axes, of the quaternion (w, a, b, 0)
    u, v, s = np.moveaxis(roll, -1, 0)
    across = (1 - 2 * b * b) * u + 2 * a * b * v - 2 * w * b * s
    up = 2 * a * b * u + (1 - 2 * a * a) * v + 2 * w * a * s
    half = (np.arctan2(up, across) + twist) / 2
    c, t = np.cos(half), np.sin(half)
    return np.stack([w * c, a * c + b * t, b * c - a * t, w * t], axis=-1)
