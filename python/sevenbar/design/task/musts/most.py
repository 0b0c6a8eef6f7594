"""The must of a bound: the residuals of a want are small."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from sevenbar.description.values import key
from sevenbar.design.task.flaws import Flaws, not_positive
from sevenbar.design.task.given import amount, reading
from sevenbar.design.task.task import DesignTask, MustForm, ResidualMust, SampledWant, Want
from sevenbar.design.task.values import Value, WantNumber
from sevenbar.kinematics.linkage import Linkage


class MostMust(MustForm):
    """The residuals of a want are small."""

    kind: Annotated[Literal["most"], key("this must")]
    want: Annotated[WantNumber, key("its place among [[want]], counted from 1")]
    most: Annotated[
        Value, key("the most that each of its residuals may be, weights left out", "degrees, or length")
    ]

    def must(self, linkage: Linkage, wants: Sequence[Want]) -> Most:
        want = wants[self.want - 1] if self.want <= len(wants) else None
        if not isinstance(want, SampledWant):
            # the task is checked for it
            return Most(self.want - 1, 1.0)
        if want.of_output:
            most = reading("most", self.most, linkage, linkage.drive.output)
        else:
            most = amount("most", self.most, linkage.length_unit)
        return Most(self.want - 1, most / want.residual_unit(linkage))


@dataclass(frozen=True)
class Most(ResidualMust):
    """The residuals of a want, by its place among the task's, are at most so great, weights left out.

    Those of all its stations, or at the places `at` among them.
    """

    form = MostMust

    want: int
    most: float
    at: tuple[int, ...] | None = None

    def flaws(self, task: DesignTask) -> Flaws:
        count = len(task.wants)
        if not 0 <= self.want < count:
            yield "want", f"{self.want + 1} is not a want; give its place, 1 to {count}"
        elif not isinstance(task.wants[self.want], SampledWant):
            yield "want", "is a figure; bound it by a must with kind = 'figure', least and most"
        yield from not_positive("most", self.most, "bound")

    def words(self, linkage: Linkage) -> str:
        return f"each residual of want {self.want + 1} at most {self.most:.3g}"
