"""Counterweights on links: the least shaking by least squares, or within bounds by cones, with a proof.

A counterweight of mass m in c adds U (m c, m) to the shaking (17). Counted from a pivot p of its link, with
the mass times radius g = m (c - p),

    W = W_0 + U_g g + (U_m + U_g p) m                                                                    (19)

where a mass in the pivot does nothing for a link that turns about an axis of the ground. Least squares over
g, and over m where it does something:

    minimise  sum_j share_j |w W_j|^2,   by singular values; those below 1e-8 of the greatest do nothing  (20)

With bounds, `|g| <= r m` and `0 <= m <= m_most` are second-order cones, so that the optimum is proved.

Source: docs/theory_forces.md, (17) to (23); R. S. Berkof, G. G. Lowen, J. Eng. Ind. 91 (1969) 21, for the
planar four-bar.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats, finite_array, finite_number
from sevenbar.errors import RequestError, check_word, shown
from sevenbar.forces.bodies import Body
from sevenbar.forces.cones import Bounds, least_greatest_size
from sevenbar.forces.mounts import Acting, Mount
from sevenbar.text.printing import Printed

#: A product of mass and radius below this part of the greatest is none.
NONE = 1e-9


@dataclass(frozen=True, eq=False, repr=False)
class Counterweight(Printed):
    """What to add to a link: mass times radius `product` [kg length] in `direction` (3,) from `pivot`.

    `mass` [kg] is that at the wanted radius; `None` where the shaking is the same for any and no radius is
    given. `body` is a point of this mass; `None` without one, and where least squares take mass away, which
    `mass` < 0 says.
    """

    link: int
    pivot: tuple[float, float, float]
    product: float
    direction: Floats
    mass: float | None
    body: Body | None


@dataclass(frozen=True, eq=False, repr=False)
class Balance(Printed):
    """Counterweights, and the shaking (n, 6) that they leave; moment of their own inertia not counted.

    `measure` says of what `before` and `after` are values [N]: the root mean square over the cycle, or the
    greatest of the rows. `bound` is what no counterweights within the bounds go below; with least squares the
    optimum itself. Of `unknowns` as many as `rank` act; `idle` names what does nothing. `status` is
    Clarabel's, "least squares" without bounds. Lengths are in the `length_unit`.
    """

    counterweights: tuple[Counterweight, ...]
    shaking: Floats
    measure: Literal["rms", "greatest"]
    before: float
    after: float
    bound: float
    rank: int
    unknowns: int
    idle: tuple[str, ...]
    status: str
    length_unit: str = "length"

    @property
    def gap(self) -> float:
        """How far the optimum may be below `after`, as a part of `before`."""
        return (self.after - self.bound) / self.before if self.before else 0.0

    @property
    def bodies(self) -> dict[int, Body]:
        """The counterweights that have a mass, by their link."""
        return {one.link: one.body for one in self.counterweights if one.body is not None}


def counterweights(
    shaking: Floats,
    mounts: Sequence[Mount],
    *,
    size: float,
    shares: Floats | None = None,
    radius: float | Mapping[int, float] | None = None,
    most_mass: float | Mapping[int, float] | None = None,
    measure: Literal["rms", "greatest"] = "rms",
    force: float = 1.0,
    moment: float = 0.0,
    length_unit: str = "length",
) -> Balance:
    """Counterweights on `mounts` for the least of a shaking (n, 6), moment [N m], then force [N].

    What counts is `(moment M, force F)` with these two factors: `force` a number, `moment` [1/m]. `size`
    [length] is the linkage's; `shares` (n,) those of the rows in a mean, alike where left out. Without
    `most_mass` [kg] least squares; with it no mass is above, and none farther from its pivot than `radius`
    [length]. Each is a number or one by link.

    Raises `RequestError` for arguments that do not fit, `MissingExtraError` without Clarabel where it is
    needed.
    """
    _refuse(mounts, measure, force, moment)
    radii = _by_link("radius", radius, mounts)
    masses = _by_link("most_mass", most_mass, mounts)
    if most_mass is None and measure == "greatest":
        raise RequestError("measure: the greatest shaking is found within bounds; give most_mass and radius")
    if most_mass is not None and radius is None:
        raise RequestError("radius: is missing; give the farthest that a counterweight may be from its pivot")
    weights = np.array([float(moment)] * 3 + [float(force)] * 3)
    counted = weights > 0
    weights = weights[counted]
    shares = np.full(len(shaking), 1 / len(shaking)) if shares is None else shares
    constant = shaking[:, counted] * weights
    columns = [mount.columns[:, counted] * weights[:, None] for mount in mounts]
    roots = np.sqrt(shares)[:, None]
    # a mass counts by its size times the length, so that all four numbers of a link have one unit
    stacked = [(roots[:, :, None] * column).reshape(-1, 4) / [1, 1, 1, size] for column in columns]
    acting = Acting.of(stacked)
    target = (roots * constant).ravel()
    if most_mass is None:
        values = acting.least_squares(target)
        status, bound = "least squares", None
    else:
        limits = np.array([[radii[m.link], masses[m.link]] for m in mounts], dtype=np.float64)
        values, bound, status = _within(constant, columns, limits, roots, measure, acting)
    products, added = values[:, :3], values[:, 3] / (size if most_mass is None else 1.0)
    remaining = shaking.copy()
    chosen = []
    scale = float(np.linalg.norm(products, axis=1).max(initial=0.0))
    for mount, product, mass, acts in zip(mounts, products, added, acting.mass_acts, strict=True):
        remaining += mount.columns @ np.append(product, mass)
        chosen.append(_counterweight(mount, product, mass, acts, radii[mount.link], scale))

    def value(wrench: Floats) -> float:
        squares = ((wrench[:, counted] * weights) ** 2).sum(axis=1)
        return math.sqrt(float(shares @ squares if measure == "rms" else squares.max()))

    after = value(remaining)
    return Balance(
        counterweights=tuple(chosen),
        shaking=remaining,
        measure=measure,
        before=value(shaking),
        after=after,
        bound=after if bound is None else min(bound, after),
        rank=acting.rank,
        unknowns=int(acting.used.sum()),
        idle=tuple(acting.names(mounts)),
        status=status,
        length_unit=length_unit,
    )


def _within(
    constant: Floats,
    columns: list[Floats],
    limits: Floats,
    roots: Floats,
    measure: Literal["rms", "greatest"],
    acting: Acting,
) -> tuple[Floats, float, str]:
    """Numbers (links, 4) within limits (links, 2) of radius and mass, the lower bound, Clarabel's status.

    Source: docs/theory_forces.md, (21) to (23).
    """
    # y = g / (r m_most) and z = m / m_most, so that the cones are |y| <= z <= 1
    reach = np.column_stack([np.repeat(limits.prod(axis=1)[:, None], 3, axis=1), limits[:, 1]])
    slopes = np.concatenate([column * row for column, row in zip(columns, reach, strict=True)], axis=2)
    if measure == "rms":
        # one vector of all rows, turned into its few coordinates that matter
        flat = np.column_stack(
            [(roots[:, :, None] * slopes).reshape(-1, slopes.shape[2]), (roots * constant).ravel()]
        )
        small = np.asarray(np.linalg.qr(flat, mode="r"))
        slopes, constant = small[None, :, :-1], small[None, :, -1]
    links = len(columns)
    scale = float(np.linalg.norm(constant, axis=1).max()) or 1.0
    eye = np.eye(4 * links)
    heights = eye[3::4]
    order = np.concatenate([[4 * i + 3, 4 * i, 4 * i + 1, 4 * i + 2] for i in range(links)])
    bounds = Bounds(
        np.vstack([heights, -eye[order]]),
        np.concatenate([np.ones(links), np.zeros(4 * links)]),
        links,
        (4,) * links,
    )
    optimum = least_greatest_size(constant / scale, slopes / scale, bounds, who="a balance within bounds")
    numbers = optimum.x.reshape(links, 4)
    numbers[:, 3] = np.clip(numbers[:, 3], 0.0, 1.0)
    lengths = np.linalg.norm(numbers[:, :3], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        numbers[:, :3] *= np.where(lengths > numbers[:, 3], numbers[:, 3] / lengths, 1.0)[:, None]
    # where the mass itself does nothing, no more than is needed at the full radius
    for i, acts in enumerate(acting.mass_acts):
        if not acts:
            numbers[i, 3] = np.linalg.norm(numbers[i, :3])
    return numbers * reach, lower_bound(constant, slopes, optimum.duals), optimum.status


def lower_bound(constant: Floats, slopes: Floats, duals: Floats) -> float:
    """What the greatest |constant + slopes @ x| is not below for any x = (y, z), `|y| <= z <= 1` each.

    `constant` (n, d), `slopes` (n, d, 4 links), dual vectors (n, d) with `sum |dual| <= 1`.

    Source: docs/theory_forces.md, (23).
    """
    slope = np.einsum("ki,kij->j", duals, slopes).reshape(-1, 4)
    least = np.minimum(0.0, slope[:, 3] - np.linalg.norm(slope[:, :3], axis=1))
    return max(0.0, float((duals * constant).sum() + least.sum()))


def _counterweight(
    mount: Mount, product: Floats, mass: float, acts: bool, radius: float | None, scale: float
) -> Counterweight:
    amount = float(np.linalg.norm(product))
    none = amount <= NONE * scale and not (acts and mass)
    direction = np.zeros(3) if none or not amount else product / amount
    added: float | None = mass
    if none:
        added, amount = 0.0, 0.0
    elif not acts:
        # any mass will do
        added = None if radius is None else amount / radius
    body = None
    if added is not None and added > 0:
        x, y, z = (float(v) for v in np.asarray(mount.pivot) + product / added)
        body = Body(added, (x, y, z), solid="point")
    return Counterweight(mount.link, mount.pivot, amount, direction, added, body)


def _by_link(
    name: str, values: float | Mapping[int, float] | None, mounts: Sequence[Mount]
) -> dict[int, float | None]:
    """A number > 0 for each link, or none for any."""
    links = [mount.link for mount in mounts]
    if values is None:
        return dict.fromkeys(links)
    values = values if isinstance(values, Mapping) else dict.fromkeys(links, values)
    for link in links:
        if link not in values:
            raise RequestError(f"{name}: none for link {link}; give one for each link")
        if finite_number(name, values[link]) <= 0:
            unit = "a length" if name == "radius" else "kilograms"
            raise RequestError(f"{name}: {shown(values[link])} of link {link}; give {unit} > 0")
    for link in values:
        if link not in links:
            carriers = ", ".join(map(str, links))
            raise RequestError(f"{name}: link {shown(link)} carries no counterweight; give it for {carriers}")
    return {link: finite_number(name, values[link]) for link in links}


def _refuse(mounts: Sequence[Mount], measure: object, force: float, moment: float) -> None:
    links = [mount.link for mount in mounts]
    if not links:
        raise RequestError("links: none given; give those that may carry a counterweight")
    if len(set(links)) < len(links):
        raise RequestError("links: one is given twice; leave one out")
    check_word("measure", measure, ("rms", "greatest"))
    for name, value in (("force", force), ("moment", moment)):
        if finite_array(name, [value])[0] < 0:
            raise RequestError(f"{name}: {shown(value)} is not a factor; give a number >= 0")
    if not force and not moment:
        raise RequestError("force: neither force nor moment counts; give one of the factors > 0")
