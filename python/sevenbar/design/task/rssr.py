"""The loop of a task about crank and rocker of an RSSR with square axes, in closed form."""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.closure import NAMES, output_slopes, outputs
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.task import DesignTask, DwellWant, FunctionWant, Most


class RssrLoop(TaskLoop):
    """An RSSR of which crank and rocker alone are seen: the columns of its balls are not followed.

    With a point to be seen it is a loop as any other.
    """

    @property
    def _columns(self) -> list[int]:
        return [self.numbers.names.index(name) for name in NAMES]

    @property
    def _sees_points(self) -> bool:
        return len(self.numbers.points) > len(self.linkage.points)

    def on_branch(self, values: Floats, x: Floats, branch: int) -> Floats:
        """The poses (n, columns) at inputs x (n,) on a branch; NaN where there is none."""
        found = np.zeros((len(x), len(self.linkage.columns)))
        found[:, self.input] = x
        found[:, self.output] = outputs(self.whole(values)[None, self._columns], x, branch)[0]
        return found

    def closed(self, values: Floats, x: Floats, q: Floats) -> Floats:
        """The poses (n, columns) at inputs x (n,), on the branch nearest to q; NaN where there is none."""
        if self._sees_points:
            return super().closed(values, x, q)
        found = q.copy()
        ways = [self.on_branch(values, x, branch)[:, self.output] - q[:, self.output] for branch in (0, 1)]
        first, second = short_way(ways[0]), short_way(ways[1])
        found[:, self.input] = x
        found[:, self.output] += np.where(np.abs(second) < np.abs(first), second, first)
        return found

    def here(self, values: Floats, q: Floats, *, slopes: bool = True) -> Here:
        """What is at closed poses (n, columns); slopes are infinite at dead centres of the input."""
        if self._sees_points:
            return super().here(values, q, slopes=slopes)
        none = np.empty((len(q), 0, 3))
        if not slopes:
            return Here(q, np.empty((*q.shape, 0)), none, np.empty((*none.shape, 0)))
        row = self.whole(values)[None, self._columns]
        by_row, by_input = output_slopes(row, q[None, :, self.input], q[None, :, self.output])
        every = np.zeros((len(q), len(self.numbers.names)))
        every[:, self._columns] = by_row[0]
        by = np.zeros((*q.shape, len(self.free) + 1))
        by[:, self.output] = np.column_stack([self.all_slopes(values, every), by_input[0]])
        by[:, self.input, -1] = 1.0
        return Here(q, by, none, np.empty((*none.shape, by.shape[-1])))


def loop_of(task: DesignTask) -> TaskLoop:
    """The loop of a task, in closed form where a function of an RSSR is all that is wanted."""
    draft = task.draft.holding(task.follow)
    linkage = draft.linkage
    ends = (linkage.drive.joint, linkage.drive.output) == (linkage.columns[0], linkage.columns[-1])
    readings = all(isinstance(want, (FunctionWant, DwellWant)) for want in task.wants)
    plain = linkage.form == "rssr" and ends and readings and all(isinstance(m, Most) for m in task.musts)
    return (RssrLoop if plain and task.wants else TaskLoop)(draft, task.names)
