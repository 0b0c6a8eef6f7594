"""The want of a path: a named point goes through places in order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import StrictBool

from sevenbar.arrays import Floats
from sevenbar.description.values import Text, key
from sevenbar.design.curve_table import read_curve
from sevenbar.design.task.flaws import Flaws, point_flaws
from sevenbar.design.task.given import one_of, read_file, timing
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.task import DesignTask, WantForm
from sevenbar.design.task.values import OF_INPUT, Places, Timing, Weight
from sevenbar.design.task.wanted_path import wanted_inputs, wanted_places
from sevenbar.design.task.wants.places import PlacesWanted, TimedWant
from sevenbar.errors import RequestError
from sevenbar.kinematics.linkage import Linkage


class PathForm(WantForm):
    """The path of a named point."""

    kind: Annotated[Literal["path"], key("this want")]
    point: Annotated[Text, key("the name of the linkage's point")]
    places: Annotated[
        Places | None,
        key("x, y, z row by row, z perhaps left out; closed where the last repeats the first", "length"),
    ] = None
    table: Annotated[Text | None, key("a CSV file or workbook of places: columns x, y, z with units")] = None
    timing: Annotated[
        Timing | None,
        key("inputs at which the places are reached; true: those of the table; left out, any", OF_INPUT),
    ] = None
    phase: Annotated[StrictBool, key("whether the inputs count from a free start")] = False
    exact: Annotated[StrictBool, key("whether all places must be met exactly")] = False
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0

    def want(self, linkage: Linkage, folder: Path) -> PathWant:
        given = one_of(self, "places", "table")
        inputs: Floats | None = None
        if self.table is not None:
            drive = linkage.drive.joint
            rows, inputs = read_file(
                lambda path: read_curve(path, linkage, drive, point=self.point), folder, self.table
            )
        else:
            rows = np.array(self.places, dtype=float)
        inputs = timing(self.timing, inputs, linkage)
        try:
            rows, closed = wanted_places(rows)
            inputs = wanted_inputs(inputs, rows, closed)
        except RequestError as error:
            key, _, message = str(error).partition(": ")
            raise RequestError(f"{given if key == 'points' else key}: {message}") from None
        return PathWant(self.point, rows[:-1] if closed else rows, closed, inputs, self.phase, self.weight)


@dataclass(frozen=True, eq=False)
class PathWant(TimedWant):
    """The path of a named point through places (n, 3) in order, the first not repeated where it is `closed`.

    `timing` (n,) [rad, or length] are the inputs at which they are reached, from an unknown start on with
    `phase`; without timing the inputs are free and follow each other. Residuals: the three parts of the
    distance, relative to the greatest extent of the places.
    """

    form = PathForm

    point: str
    places: Floats
    closed: bool = False
    timing: Floats | None = None
    phase: bool = False
    weight: float = 1.0

    @property
    def points(self) -> tuple[str, ...]:
        return (self.point,)

    def residual_unit(self, linkage: Linkage) -> float:
        return float(np.ptp(self.places, axis=0).max())

    def flaws(self, task: DesignTask) -> Flaws:
        yield from point_flaws(task.draft.linkage, self.point)
        rows = np.concatenate([self.places, self.places[:1]]) if self.closed else self.places
        try:
            wanted_places(rows)
            wanted_inputs(self.timing, rows, self.closed)
        except RequestError as error:
            key, _, message = str(error).partition(": ")
            yield {"points": "places"}.get(key, key), message
            return
        yield from self.phase_flaws()
        count = len(self.places) * (1 if self.timing is None else 2)
        yield from self.exact_flaws(task, count, task.placings + self.phase)

    def words(self, linkage: Linkage) -> str:
        return (
            f"path of {self.point}: {len(self.places)} places, {'closed' if self.closed else 'open'}, "
            f"{self.residual_unit(linkage):.4g} {linkage.length_unit} across"
            f"{self.timed}"
        )

    def places_of(self, point: str) -> Floats | None:
        return self.places if point == self.point else None

    def in_loop(self, loop: TaskLoop) -> PlacesWanted:
        seen, places = [(self.point, None)], self.places[:, None, :]
        return PlacesWanted(loop, self, seen, places, self.timing, phase=self.phase, closed=self.closed)
