"""The parts of a circuit's path between its stops, and on which of them a linkage is used."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.paths.circuit_path import CircuitPath

#: A place beyond the end of a stretch by less than this part of the circuit is its end.
AT_END = 1e-9

#: What a range of a joint is called among the stops that end a stretch.
RANGE_OF = "range of "

#: A pose that misses the drawn one by less [rad, or shares of the size] is it.
DRAWN = 1e-6


@dataclass(frozen=True)
class StopStretch:
    """A part of a path within all stops, from the place `begin` to `end`.

    Of a closed circuit `end` may lie beyond its length: the stretch then goes on over the seam. `first_stop`
    and `last_stop` say what ends it, "range of crank"; empty where the circuit itself ends.
    """

    begin: float
    end: float
    first_stop: str
    last_stop: str

    @property
    def is_whole(self) -> bool:
        """Whether no stop ends it."""
        return not (self.first_stop or self.last_stop)

    def held(self, place: float, path: CircuitPath) -> float | None:
        """A place as the first lap has it, counted on from `begin` and no further than the ends.

        `None` where it is beyond a stop.
        """
        near = AT_END * path.length
        if path.closed:
            place = self.begin - near + (place - self.begin + near) % path.length
        if not self.begin - near <= place <= self.end + near:
            return None
        return min(max(place, self.begin), self.end)


def stopped_column(stop: str) -> str | None:
    """The column whose range a stop is, the first of several; `None` for cones and links."""
    names = [name for name in stop.split(", ") if name.startswith(RANGE_OF)]
    return names[0].removeprefix(RANGE_OF) if names else None


def laps_by_range(linkage: Solvable, column: int, one: StopStretch, start: float, end: float) -> int:
    """By how many whole turns the inputs of a stretch are moved, so that they are as its range has them.

    That of the input's `column`; 0 for one that slides, and where other stops end the stretch.
    """
    name = linkage.columns[column]
    given = linkage.stops.ranges.get(name)
    if given is None or not linkage.turns(column):
        return 0
    turns: list[float] = [
        (limit - value) / math.tau
        for value, stop in ((start, one.first_stop), (end, one.last_stop))
        if f"{RANGE_OF}{name}" in stop.split(", ")
        for limit in given
    ]
    if not turns:
        return 0
    # of both limits the one that is met
    off = [abs(turn - round(turn)) for turn in turns]
    return round(turns[off.index(min(off))])


def place_of(path: CircuitPath, numbers: Numbers, q: Floats, *, turns: bool) -> tuple[float, float]:
    """The place of a pose (columns,) of the word, and how far [rad, or shares of the size] it is off.

    Both NaN where the circuit does not have its input, which `turns` or slides.
    """
    places = path.places(float(q[path.input]), turns=turns)
    if not places.size:
        return math.nan, math.nan
    smooth = ~numbers.is_ball
    off = path.poses.at(places)[:, smooth] - q[smooth]
    turning = numbers.turns[smooth]
    off[:, turning] -= math.tau * np.round(off[:, turning] / math.tau)
    distances = np.linalg.norm(off / numbers.scales[smooth], axis=1)
    best = int(distances.argmin())
    return float(places[best]), float(distances[best])


def drawn_place(linkage: Solvable, path: CircuitPath, numbers: Numbers) -> float | None:
    """The place of the drawn pose; `None` of rows, and on other circuits."""
    if linkage.form != "drawn":
        return None
    place, off = place_of(path, numbers, linkage.drawn_pose, turns=linkage.turns(path.input))
    return place if off < DRAWN else None


def first_place(linkage: Solvable, circuit: Circuit, path: CircuitPath, numbers: Numbers) -> float:
    """The place of the circuit's first row that has a pose."""
    row = int(np.flatnonzero(np.isfinite(circuit.q).all(axis=1))[0])
    pose = numbers.poses(circuit.q[row : row + 1])[0]
    place, _ = place_of(path, numbers, pose, turns=linkage.turns(path.input))
    return 0.0 if math.isnan(place) else place


def used_stretch(
    linkage: Solvable, circuit: Circuit, path: CircuitPath, numbers: Numbers, result: tuple[StopStretch, ...]
) -> tuple[int, float] | None:
    """The stretch on which a linkage is used, by its number, and the place at which it begins to move.

    That of the drawn pose; without one on it that of the first row; else the first, from its beginning on.
    `None` where there is no stretch.
    """
    homes = [drawn_place(linkage, path, numbers), first_place(linkage, circuit, path, numbers)]
    for home in homes:
        for number, one in enumerate(result):
            if home is not None and (place := one.held(home, path)) is not None:
                return number, place
    return (0, result[0].begin) if result else None
