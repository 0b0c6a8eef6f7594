"""What can be dragged in the scene: the places of drawn joints, and the named points of any linkage."""

from __future__ import annotations

import math
from collections.abc import Mapping
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

    `places` are where its coordinates are in the description: those of all that is drawn in one place, with
    how many are there, of a pin two. `given` (3,) are they, and `frame` (4, 4) takes them to the scene.
    """

    places: Mapping[Place, int]
    given: Floats
    frame: Floats

    @property
    def key(self) -> str:
        """Its own among all."""
        return "_".join(str(part) for part in next(iter(self.places)) if part != "at")

    @property
    def at(self) -> Floats:
        """Where it is in the scene."""
        return placed(self.frame, self.given)

    def dragged(self, to: Floats, size: float) -> dict[Place, list[float]]:
        """Its coordinates, by where they are, for another place in the scene: rounded as a person would.

        `size` [length] is the linkage's. Coordinates that stay, up to the rounding, stay to the last digit.
        """
        wanted = placed(inverse(self.frame), to)
        digits = -math.floor(math.log10(size * FINENESS)) if size > 0 else 12
        stays = np.abs(wanted - self.given) < 0.5 * 10.0**-digits
        rounded = [round(float(value), digits) for value in wanted]
        result = [
            float(old) if same else new for old, same, new in zip(self.given, stays, rounded, strict=True)
        ]
        return {place: result[:count] for place, count in self.places.items()}


def grips(draft: Draft, view: View | None, row: float) -> list[Grip]:
    """The grips of a description, at a row of a view of it.

    A drawn linkage has them where it is drawn, whatever the row; another one has those of its named points
    alone, where there is a view.
    """
    vectors: dict[Place, list[float]] = {}
    for dimension in draft.dimensions:
        if "at" in dimension.place:
            vectors.setdefault(dimension.place[:-1], []).append(dimension.value)
    linkage = draft.linkage
    result: list[Grip] = []
    drawn = linkage.form == "drawn"
    for place, values in vectors.items():
        number = place[1]
        assert isinstance(number, int)
        given, frame = np.array([*values, 0.0][:3]), np.eye(4)
        if drawn:
            same = next((i for i, grip in enumerate(result) if (grip.given == given).all()), None)
            if same is not None:
                result[same] = replace(result[same], places={**result[same].places, place: len(values)})
                continue
        elif view is None:
            continue
        else:
            link = int(draft.raw["point"][number]["link"])
            frame = view.point_frame(link, row)
        result.append(Grip({place: len(values)}, given, frame))
    return result
