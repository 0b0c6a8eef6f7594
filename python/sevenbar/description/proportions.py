"""Whether the lengths of a linkage can be seen together in double precision."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sevenbar.errors import Problem, shown

if TYPE_CHECKING:
    from sevenbar.arrays import Floats
    from sevenbar.description.loop_schema import JointForm, LinkForm, LoopForm

#: A length below this part of the greatest may be lost: poses count as closed when they miss by less.
LEAST_SHARE = 1e-11

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
    lost = lost_lengths([*nearest, *pitches], max(float(ahead.max()), pitches[steepest]))
    if not lost:
        return []
    if pitches[steepest] > ahead.max():
        message = f"{pitches[steepest]:.3g} {unit} is too long"
        return [Problem(f"joint[{steepest + 1}].pitch", f"{message}, {loss_text(lost, unit)}")]
    far, message = farthest(places, unit)
    return [Problem(f"joint[{far + 1}].at", f"{message}, {loss_text(lost, unit)}")]


def farthest(places: Floats, unit: str) -> tuple[int, str]:
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
    lost = lost_lengths([abs(value) for value in numbers.values()], abs(numbers[place]))
    return (
        [Problem(place, f"{numbers[place]:.3g} {unit} is too long, {loss_text(lost, unit)}")] if lost else []
    )


def lost_lengths(lengths: Sequence[float], greatest: float, least_share: float = LEAST_SHARE) -> list[float]:
    """The lengths lost next to the greatest, where they are at least half of those that are meant."""
    meant = [length for length in lengths if length >= MEANT]
    lost = [length for length in meant if length < least_share * greatest]
    return lost if 2 * len(lost) >= len(meant) else []


def loss_text(
    lost: Sequence[float], unit: str, why: str = "lost in rounding beside", least_share: float = LEAST_SHARE
) -> str:
    """What is wrong with the greatest length next to those that are lost, and what to give."""
    return (
        f"and {max(lost):.3g} {unit} is {why} that; give lengths of which the greatest is "
        f"at most {1 / least_share:.0e} times the others"
    )
