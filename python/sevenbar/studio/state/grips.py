"""What can be dragged in the scene: the places of drawn joints, and the named points of any linkage."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.kinematics.loop.geometry import Place
from sevenbar.kinematics.loop.rigid import inverse, placed
from sevenbar.studio.state.view import View

#: A place that is dragged is rounded to a power of ten that is at most this share of the linkage's size.
FINENESS = 1 / 300


@dataclass(frozen=True, eq=False)
class Grip:
    """A place that can be dragged: `at` (3,) [length] in the scene, in the frame of the report.

    `places` are where its coordinates are in the description: those of all that is drawn in one place.
    `given` (3,) are the coordinates, and `frame` (4, 4) takes them to the scene.
    """

    places: tuple[Place, ...]
    given: Floats
    frame: Floats

    @property
    def key(self) -> str:
        """Its own among all."""
        return f"{self.places[0][0]}_{self.places[0][1]}"

    @property
    def at(self) -> Floats:
        """Where it is in the scene."""
        return placed(self.frame, self.given)

    def dragged(self, to: Floats, size: float) -> list[float]:
        """Its coordinates for another place in the scene, rounded as a person would write them.

        `size` [length] is the linkage's. Coordinates that stay, up to the rounding, stay to the last digit.
        """
        wanted = placed(inverse(self.frame), to)
        digits = -math.floor(math.log10(size * FINENESS)) if size > 0 else 12
        stays = np.abs(wanted - self.given) < 0.5 * 10.0**-digits
        rounded = [round(float(value), digits) for value in wanted]
        return [
            float(old) if same else new for old, same, new in zip(self.given, stays, rounded, strict=True)
        ]


def grips(draft: Draft, view: View | None, row: float) -> list[Grip]:
    """The grips of a description, at a row of a view of it.

    A drawn linkage has them where it is drawn, whatever the row; another one has those of its named points
    alone, where there is a view.
    """
    vectors: dict[Place, list[float]] = {}
    for dimension in draft.dimensions:
        if "at" in dimension.place:
            vectors.setdefault(dimension.place[:3], []).append(dimension.value)
    linkage = draft.linkage
    result: list[Grip] = []
    drawn = linkage.form == "drawn"
    for place, values in vectors.items():
        number = place[1]
        assert isinstance(number, int)
        given, frame = np.array(values), np.eye(4)
        if drawn:
            same = next((i for i, grip in enumerate(result) if (grip.given == given).all()), None)
            if same is not None:
                result[same] = replace(result[same], places=(*result[same].places, place))
                continue
        elif view is None:
            continue
        else:
            link = int(draft.raw["point"][number]["link"])
            frame = view.point_frame(link, row)
        result.append(Grip((place,), given, frame))
    return result
