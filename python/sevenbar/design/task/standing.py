"""Where a linkage stands that may stand anywhere: in words of numbers, and a drawing brought there."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sevenbar.description.draft import Draft
from sevenbar.description.load_moving import moved_loads
from sevenbar.design.task.match import Placing
from sevenbar.kinematics.loop.rigid import rotation_vector
from sevenbar.kinematics.numbers.dimensions import description_of


def standing(placing: Placing, unit: str) -> Mapping[str, float]:
    """Where the linkage stands so that its point goes through the wanted points: a turn, then a shift.

    `turn_x`, `turn_y`, `turn_z` is the axis of one turn times its angle.
    """
    turn = np.degrees(rotation_vector(placing.rotation))
    names = [f"shift_{letter}_{unit}" for letter in "xyz"] + [f"turn_{letter}_deg" for letter in "xyz"]
    return dict(zip(names, map(float, [*placing.shift, *turn]), strict=True))


def moved(draft: Draft, placing: Placing) -> Draft:
    """A drawn linkage with all its places and directions moved."""

    def put(table: Mapping[str, object]) -> dict[str, object]:
        own = dict(table)
        for key, value in table.items():
            if key == "at":
                own[key] = [float(x) for x in placing.put(np.array(value, dtype=np.float64))]
            elif key == "axis":
                own[key] = [float(x) for x in placing.rotation @ np.array(value, dtype=np.float64)]
            elif key == "axes":
                own[key] = (np.array(value, dtype=np.float64) @ placing.rotation.T).tolist()
        return own

    described = description_of(draft.linkage)  # with numbers where the file has formulas
    draft = draft.with_value(("joint",), [put(joint) for joint in described["joint"]])
    if "point" in described:
        draft = draft.with_value(("point",), [put(point) for point in described["point"]])
    for head, tables in moved_loads(described, placing.put, placing.rotation).items():
        draft = draft.with_value((head,), tables)
    return draft
