"""The must of a figure: a measure of the circuit stays within ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from sevenbar.description.values import Text, key
from sevenbar.design.task.flaws import Flaws
from sevenbar.design.task.measured import measure_flaw, measure_unit, measure_value, value_flaw
from sevenbar.design.task.task import DesignTask, MeasureMust, MeasureWant, MustForm, Want
from sevenbar.design.task.values import Value
from sevenbar.kinematics.linkage import Linkage


class FigureMustForm(MustForm):
    """A measure of the circuit stays within ends."""

    synonyms = ("measure",)

    kind: Annotated[Literal["figure"], key("this must; measure is the same")]
    name: Annotated[Text, key("the measure")]
    least: Annotated[Value | None, key("the least that it may be", "of the measure")] = None
    most: Annotated[Value | None, key("the most that it may be", "of the measure")] = None

    def must(self, linkage: Linkage, wants: Sequence[Want]) -> FigureMust:
        ends = [
            None if end is None else measure_value(name, end, linkage, self.name)
            for name, end in (("least", self.least), ("most", self.most))
        ]
        return FigureMust(self.name, *ends)


@dataclass(frozen=True)
class FigureMust(MeasureMust):
    """A measure of the circuit by its name stays within `least` and `most`, in the unit it is read in."""

    form = FigureMustForm

    name: str
    least: float | None = None
    most: float | None = None

    def flaws(self, task: DesignTask) -> Flaws:
        if flaw := measure_flaw(task.draft.linkage, self.name):
            yield "name", flaw
            return
        least, most = self._ends
        if self.least is None and self.most is None:
            yield "", "has no end; give least, most, or both"
        elif not least <= most:
            yield "least", f"{least:g} is above the most, {most:g}; give the lower end in least"
        for name, end in (("least", self.least), ("most", self.most)):
            if end is not None and (flaw := value_flaw(task.draft.linkage, self.name, end, name)):
                yield name, flaw
        for i, other in enumerate(task.musts[: task.musts.index(self)]):
            if isinstance(other, FigureMust) and other.name == self.name:
                low, high = other._ends
                if max(least, low) > min(most, high):
                    yield (
                        "name",
                        f"must {i + 1} wants {self.name} outside these ends; leave one out, or widen it",
                    )
        for i, want in enumerate(task.wants):
            own = want.value if isinstance(want, MeasureWant) and want.name == self.name else ""
            if not isinstance(own, str) and not least <= own <= most:
                yield "name", f"want {i + 1} wants it outside these ends; widen them, or want another value"

    @property
    def _ends(self) -> tuple[float, float]:
        return (
            -math.inf if self.least is None else self.least,
            math.inf if self.most is None else self.most,
        )

    def words(self, linkage: Linkage) -> str:
        unit = measure_unit(self.name, linkage)
        ends = [(">=", self.least), ("<=", self.most)]
        each = [f"{sign} {end:g} {unit}".rstrip() for sign, end in ends if end is not None]
        return f"{self.name} {' and '.join(each)}"
