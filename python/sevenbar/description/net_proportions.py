"""Whether the lengths of a net are near enough to each other for its circuits to be followed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sevenbar.description.net_schema import NetForm
from sevenbar.description.proportions import MEANT, farthest, loss_text, lost_lengths
from sevenbar.description.values import Vector
from sevenbar.errors import Problem

#: A length below this part of the greatest may be lost: circuits are followed in steps of the net's size,
#: which takes minutes next to 1e5, and from 1e7 on a net that moves counts as rigid.
LEAST_SHARE_OF_NETS = 1e-4


def net_disproportions(form: NetForm, written: Sequence[str]) -> list[Problem]:
    """What is wrong where most lengths are lost next to the greatest: the place that is far from the others.

    The joints, then the rods, are `written` at these places of the file. Links may have many joints; ends of
    a rod are places of its links.
    """
    ends: list[tuple[int, tuple[str, ...], Vector]]
    ends = [(i, joint.between, joint.at) for i, joint in enumerate(form.joint)]
    for i, rod in enumerate(form.rod, len(form.joint)):
        ends += [(i, (link,), at) for link, at in zip(rod.between, rod.at, strict=True)]
    places = np.array([at for _, _, at in ends], dtype=np.float64)
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    meet = np.array([[i == j or not {*one}.isdisjoint(other) for j, other, _ in ends] for i, one, _ in ends])
    nearest = np.where(meet & (apart >= MEANT), apart, np.inf).min(axis=1)
    lengths = nearest[np.isfinite(nearest)].tolist()
    lost = lost_lengths(lengths, float(apart[meet].max()), LEAST_SHARE_OF_NETS)
    if not lost:
        return []
    far, message = farthest(places, form.length_unit)
    loss = loss_text(lost, form.length_unit, "too short to be followed with", LEAST_SHARE_OF_NETS)
    return [Problem(f"{written[ends[far][0]]}.at", f"{message}, {loss}")]
