"""The want of a figure: a measure of the circuit has a value, or is small or great."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, cast

from sevenbar.arrays import Floats
from sevenbar.description.values import Text, key
from sevenbar.design.task.flaws import Flaws, not_positive
from sevenbar.design.task.measured import measure_flaw, measure_unit, measure_value, value_flaw
from sevenbar.design.task.task import DesignTask, MeasureWant, WantForm
from sevenbar.design.task.values import Goal, Unit, Weight
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.linkage import Linkage


class FigureForm(WantForm):
    """A measure of the circuit."""

    synonyms = ("measure",)

    kind: Annotated[Literal["figure"], key("this want; measure is the same")]
    name: Annotated[Text, key("the measure, as in swing, time_ratio, transmission_lowest, peak_torque")]
    value: Annotated[Goal, key("what it shall be, or 'small', or 'great'", "of the measure")]
    unit: Annotated[Unit, key("what counts as 1", "of the measure")] = 1.0
    weight: Annotated[Weight, key("how much its residual counts")] = 1.0

    def want(self, linkage: Linkage, folder: Path) -> FigureWant:
        if self.value in ("small", "great"):
            return FigureWant(self.name, cast(Literal["small", "great"], self.value), self.unit, self.weight)
        try:
            value = measure_value("value", self.value, linkage, self.name)
        except RequestError as error:
            raise RequestError(f"{error}, or 'small' or 'great'") from None
        return FigureWant(self.name, value, self.unit, self.weight)


@dataclass(frozen=True)
class FigureWant(MeasureWant):
    """A measure of the circuit by its name ("swing", "time_ratio", "peak_torque", ..): a value, or the most.

    `value` is in the unit that the measure is read in (degrees, N m, ..), or "small" or "great". The residual
    is what it is off, relative to `unit`; for "small" the figure itself, and for "great" `unit / figure`,
    below the unit `2 - figure / unit`.
    """

    form = FigureForm

    name: str
    value: float | Literal["small", "great"]
    unit: float = 1.0
    weight: float = 1.0

    def flaws(self, task: DesignTask) -> Flaws:
        if flaw := measure_flaw(task.draft.linkage, self.name):
            yield "name", flaw
            return
        yield from not_positive("unit", self.unit, "unit")
        if isinstance(self.value, str):
            if self.value not in ("small", "great"):
                what = "is neither a number nor 'small' nor 'great'; give one of them"
                yield "value", f"{shown(self.value)} {what}"
        elif not math.isfinite(self.value):
            yield "value", f"{self.value} is no value; give a finite number"
        elif flaw := value_flaw(task.draft.linkage, self.name, float(self.value)):
            yield "value", flaw
        for i, other in enumerate(task.wants[: task.wants.index(self)]):
            if isinstance(other, FigureWant) and other.name == self.name and other.value != self.value:
                yield "name", f"want {i + 1} wants {self.name}, too, and another value; leave one out"

    def words(self, linkage: Linkage) -> str:
        if isinstance(self.value, str):
            return f"{self.name} {self.value}"
        return f"{self.name} {self.value:g} {measure_unit(self.name, linkage)}".rstrip()

    def axis(self, place: int, linkage: Linkage) -> tuple[str, str, float]:
        off = "" if isinstance(self.value, str) else "off_"
        return f"{off}{self.name}", measure_unit(self.name, linkage), 1.0

    def residual(self, value: float, by: Floats) -> tuple[float, Floats]:
        if self.value == "small":
            return value / self.unit, by / self.unit
        if self.value == "great":
            if value < self.unit:
                # a gap may be negative: less is worse there, too
                return 2 - value / self.unit, -by / self.unit
            return self.unit / value, -self.unit / value**2 * by
        return (value - self.value) / self.unit, by / self.unit
