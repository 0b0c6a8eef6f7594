"""The must of a range: a joint stays within ends."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.values import Text, key
from sevenbar.design.task.flaws import NOT_RISING, Flaws
from sevenbar.design.task.given import reading_span
from sevenbar.design.task.loop import Here, Slacks, TaskLoop
from sevenbar.design.task.task import DesignTask, MustForm, PoseMust, SampledWant, Want
from sevenbar.design.task.values import OF_INPUT, Span
from sevenbar.design.task.words import ends_in_words
from sevenbar.errors import RequestError
from sevenbar.kinematics.linkage import Linkage

#: Relative rounding of a value that lies on the end of a range.
ROUNDING = 1e-9


class RangeMust(MustForm):
    """A joint stays within ends."""

    kind: Annotated[Literal["range"], key("this must")]
    joint: Annotated[Text, key("the joint, or its column")]
    range: Annotated[Span, key("from where to where it may go", OF_INPUT)]

    def must(self, linkage: Linkage, wants: Sequence[Want]) -> InRange:
        column = linkage.columns[linkage.column(self.joint, "joint")]
        return InRange(column, *reading_span("range", self.range, linkage, column))


@dataclass(frozen=True)
class InRange(PoseMust):
    """A column's value stays within `low` and `high` [rad, or length] at all poses that are used."""

    form = RangeMust
    fault = "range"
    ease = "a wider range of the joint"

    column: str
    low: float
    high: float

    @property
    def columns(self) -> tuple[str, ...]:
        return (self.column,)

    def turns(self, linkage: Linkage) -> bool:
        return linkage.turns(self.column)

    def flaws(self, task: DesignTask) -> Flaws:
        linkage = task.draft.linkage
        try:
            name = linkage.columns[linkage.column(self.column, "joint")]
        except RequestError as error:
            yield "joint", str(error).removeprefix("joint: ")
            return
        if not self.low < self.high:
            yield "range", NOT_RISING
            return
        # angles may be a turn further
        turn = math.tau if linkage.turns(name) else 0.0
        for i, want in enumerate(task.wants):
            values = want.readings_of(name, linkage) if isinstance(want, SampledWant) else None
            if values is not None and self._is_left(values, turn):
                yield "range", f"want {i + 1} needs {name} outside it; widen it, or want less"
        for i, other in enumerate(task.musts[: task.musts.index(self)]):
            if isinstance(other, InRange) and other.column == self.column:
                one, own = np.array([other.low]), np.array([self.low])
                if self._is_left(one, turn) and other._is_left(own, turn):
                    yield "range", f"has nothing in common with that of must {i + 1}; widen one of the two"

    def _is_left(self, values: Floats, turn: float) -> bool:
        """Whether any of values (n,) is outside the range, wherever whole turns bring it."""
        if turn:
            values = values + turn * np.ceil((self.low - values) / turn - ROUNDING)
        slack = ROUNDING * max(abs(self.low), abs(self.high), 1.0)
        return bool(((values < self.low - slack) | (values > self.high + slack)).any())

    def words(self, linkage: Linkage) -> str:
        return f"{self.column} within {ends_in_words((self.low, self.high), linkage, self.column)}"

    def slacks(self, loop: TaskLoop) -> Callable[[Here], Slacks]:
        column = loop.linkage.columns.index(self.column)
        unit, turns = float(loop.units[column]), bool(loop.numbers.turns[column])
        middle = (self.low + self.high) / 2

        def slacks(here: Here) -> Slacks:
            value = here.q[:, column]
            if turns:
                # by whole turns to the range
                value = value - math.tau * np.round((value - middle) / math.tau)
            by = here.q_by[:, column]
            return (
                np.stack([value - self.low, self.high - value], axis=1) / unit,
                np.stack([by, -by], axis=1) / unit,
            )

        return slacks
