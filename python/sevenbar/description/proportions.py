"""Whether the lengths of a linkage can be seen together in double precision."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sevenbar.errors import Problem, shown

if TYPE_CHECKING:
    from sevenbar.arrays import Floats
    from sevenbar.description.loop_schema import JointForm, LinkForm, LoopForm
    from sevenbar.description.net_schema import NetForm
    from sevenbar.description.values import Vector

#: A length below this part of the greatest may be lost: poses count as closed when they miss by less.
LEAST_SHARE = 1e-11

#: The same of a net. Its circuits are followed in steps of its size, which takes minutes next to 1e5.
LEAST_SHARE_OF_NETS = 1e-4

#: Shorter ones [length] are rounding of computed zeros: nobody draws a billionth of a unit.
MEANT = 1e-9


def disproportions(form: LoopForm) -> list[Problem]:
    """What is wrong where most lengths are lost next to the greatest: the number that is too great.

    A loop is closed to a part of its size, so next to 1e15 a length of 1 is nothing, and circuits that differ
    by it are one. A few lengths that are lost do no harm, as zeros that a program computed; where they are
    half of all, it is the great one that is wrong. An RSSR is solved in closed form, without a size.
    """
    if "".join(kind for _, kind in form.joints) == "RSSR":
        return []
    if form.joint is not None:
        return _of_drawing(form.joint, form.length_unit)
    return _of_rows(form.link or (), form.length_unit)


def _of_drawing(drawn: Sequence[JointForm], unit: str) -> list[Problem]:
    places = np.array([joint.at for joint in drawn])
    ahead = np.linalg.norm(np.roll(places, -1, axis=0) - places, axis=1)
    # a joint that is near one of its neighbours is not the one that is far away
    beside = [[d for d in pair if d >= MEANT] for pair in zip(ahead, np.roll(ahead, 1), strict=True)]
    nearest = [float(min(pair)) for pair in beside if pair]
    pitches = [abs(joint.pitch or 0.0) for joint in drawn]
    steepest = int(np.argmax(pitches))
    lost = _lost([*nearest, *pitches], max(float(ahead.max()), pitches[steepest]))
    if not lost:
        return []
    if pitches[steepest] > ahead.max():
        message = f"{pitches[steepest]:.3g} {unit} is too long"
        return [Problem(f"joint[{steepest + 1}].pitch", f"{message}, {_loss_text(lost, unit)}")]
    far, message = _farthest(places, unit)
    return [Problem(f"joint[{far + 1}].at", f"{message}, {_loss_text(lost, unit)}")]


def net_disproportions(form: NetForm, written: Sequence[str]) -> list[Problem]:
    """The same of a net, whose joints and rods are `written` at these places of the file.

    Links may have many joints; ends of a rod are places of its links.
    """
    ends: list[tuple[int, tuple[str, ...], Vector]]
    ends = [(i, joint.between, joint.at) for i, joint in enumerate(form.joint)]
    for i, rod in enumerate(form.rod, len(form.joint)):
        ends += [(i, (link,), at) for link, at in zip(rod.between, rod.at, strict=True)]
    places = np.array([at for _, _, at in ends], dtype=np.float64)
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    meet = np.array([[i == j or not {*one}.isdisjoint(other) for j, other, _ in ends] for i, one, _ in ends])
    meant = np.where(meet & (apart >= MEANT), apart, np.inf).min(axis=1)
    nearest = [float(distance) for distance in meant if np.isfinite(distance)]
    lost = _lost(nearest, float(apart[meet].max()), LEAST_SHARE_OF_NETS)
    if not lost:
        return []
    far, message = _farthest(places, form.length_unit)
    loss = _loss_text(lost, form.length_unit, "too short to be followed with", LEAST_SHARE_OF_NETS)
    return [Problem(f"{written[ends[far][0]]}.at", f"{message}, {loss}")]


def _farthest(places: Floats, unit: str) -> tuple[int, str]:
    """Which of some places is far from the others, and how far."""
    away = np.linalg.norm(places - np.median(places, axis=0), axis=1)
    far = int(away.argmax())
    return far, f"{shown(places[far].tolist())} is {away[far]:.3g} {unit} from most of the others"


def _of_rows(rows: Sequence[LinkForm], unit: str) -> list[Problem]:
    numbers = {
        f"link[{i}].{key}": value
        for i, row in enumerate(rows, 1)
        for key in ("length", "offset", "pitch")
        if (value := getattr(row, key))
    }
    if not numbers:
        return []
    place = max(numbers, key=lambda place: abs(numbers[place]))
    lost = _lost([abs(value) for value in numbers.values()], abs(numbers[place]))
    return (
        [Problem(place, f"{numbers[place]:.3g} {unit} is too long, {_loss_text(lost, unit)}")] if lost else []
    )


def _lost(lengths: Sequence[float], greatest: float, least_share: float = LEAST_SHARE) -> list[float]:
    """The lengths lost next to the greatest, where they are at least half of those that are meant."""
    meant = [length for length in lengths if length >= MEANT]
    lost = [length for length in meant if length < least_share * greatest]
    return lost if 2 * len(lost) >= len(meant) else []


def _loss_text(
    lost: Sequence[float], unit: str, why: str = "lost in rounding beside", least_share: float = LEAST_SHARE
) -> str:
    return (
        f"and {max(lost):.3g} {unit} is {why} that; give lengths of which the greatest is "
        f"at most {1 / least_share:.0e} times the others"
    )
