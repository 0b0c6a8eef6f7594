"""The want of a dwell: the output stands still over a range of inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np

from sevenbar.description.values import key
from sevenbar.design.task.flaws import Flaws, range_flaws
from sevenbar.design.task.given import reading_span, zero
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.task import DesignTask, SampledWant, WantForm
from sevenbar.design.task.values import OF_INPUT, Samples, Span, Weight, Zero
from sevenbar.design.task.wanted import Used, WantFact
from sevenbar.design.task.wants.readings import ReadingsWanted
from sevenbar.design.task.words import ends_in_words
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.columns import shown_in


class DwellForm(WantForm):
    """The output stands still."""

    kind: Annotated[Literal["dwell"], key("this want")]
    range: Annotated[Span, key("of the input", OF_INPUT)]
    level: Annotated[Zero, key("the output's value, or free", OF_INPUT)] = "free"
    samples: Annotated[Samples, key("inputs of the range that count")] = 41
    weight: Annotated[Weight, key("how much its residuals count")] = 1.0

    def want(self, linkage: Linkage, folder: Path) -> DwellWant:
        level = zero("level", self.level, linkage, linkage.drive.output)
        ends = reading_span("range", self.range, linkage, linkage.drive.joint)
        return DwellWant(ends, level, self.samples, self.weight)


@dataclass(frozen=True)
class DwellWant(SampledWant):
    """The output rests while the input goes over `inputs` (low, high) [rad, or length].

    It stays at `level`, a free one where that is `None`. Residuals: what it is off at `samples` inputs
    [rad, or relative to the size]. A tolerated deviation is a `Most` as well.
    """

    form = DwellForm
    of_output = True

    inputs: tuple[float, float]
    level: float | None = None
    samples: int = 41
    weight: float = 1.0

    def flaws(self, task: DesignTask) -> Flaws:
        yield from range_flaws(task.draft.linkage, self.inputs, self.samples)

    def words(self, linkage: Linkage) -> str:
        drive = linkage.drive
        level = "" if self.level is None else f" at {ends_in_words([self.level], linkage, drive.output)}"
        return f"{drive.output} still{level} over {ends_in_words(self.inputs, linkage, drive.joint)}"

    def input_range(self) -> tuple[float, float]:
        return min(self.inputs), max(self.inputs)

    def in_loop(self, loop: TaskLoop) -> _DwellResiduals:
        inputs = np.linspace(*self.inputs, self.samples)
        return _DwellResiduals(loop, inputs, np.zeros(self.samples), (0.0, self.level), self.weight)


class _DwellResiduals(ReadingsWanted):
    def facts(self, used: Used) -> Sequence[WantFact]:
        unit, scale = shown_in(used.loop.linkage, used.loop.linkage.drive.output)
        return (WantFact("level", unit, self.shown_zeros(used)[1] * scale),)
