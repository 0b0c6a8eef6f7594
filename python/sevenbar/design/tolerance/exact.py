"""The output of changed designs, exactly, on the circuit and the pass of the nominal one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.tolerance.linear import Linear
from sevenbar.design.tolerance.outputs import values_of


class ChangedDesigns:
    """Changed designs of a linear estimate, on its rows."""

    def __init__(self, linear: Linear) -> None:
        result = linear.found
        self._found, self.loop, self.speed = result, result.loop, result.speed
        self._numbers = result.loop.numbers
        self._output = result.outputs[result.place(linear.output, linear.quantity)]
        self._q = result.poses[np.isin(result.rows, linear.rows)]
        self._x = self._q[:, self.loop.input]
        by_number = self.loop.slopes(self._q, 0).by_number[:, 0]
        self._by_number = np.where(result.opens[:, None], 0.0, by_number)
        self.nominal = self._values(self._numbers.nominal, self._q)

    def followed(self, changes: Floats) -> tuple[Floats, Floats]:
        """The poses (samples, n, columns) of designs changed by (samples, dimensions), and determinants.

        These (samples, n) are zero at a dead centre of the input. NaN where the loop does not
        close on the same pass of the circuit.
        """
        designs = self._found.designs(changes)
        steps = np.einsum("nkc,sk->snc", self._by_number, designs - self._numbers.nominal)
        q, sides = self.loop.followed(self._x, self._q, designs, steps)
        for sample in np.flatnonzero(np.isnan(q).any(axis=(1, 2))):
            lost = np.isnan(q[sample]).any(axis=1)
            q[sample, lost] = self.loop.closed(self._x[lost], self._q[lost], designs[sample])
        return q, sides

    def in_blocks(self, changes: Floats, block: int) -> Iterator[tuple[slice, Floats, Floats]]:
        """So many designs at once: which, the output less the nominal one's (.., n), determinants (.., n)."""
        for start in range(0, len(changes), block):
            part = slice(start, start + block)
            q, determinants = self.followed(changes[part])
            yield part, self.deviations(changes[part], q), determinants

    def _values(self, p: Floats, q: Floats) -> Floats:
        """The output (n,) of one design."""
        one = self._output
        if one.joint and one.order == 0:
            return np.asarray(q[:, one.place])
        loop = self._numbers.loop(self.loop.input, p, only=())
        return np.asarray(values_of((one,), q, loop.slopes(q, 0), self.speed)[:, 0])

    def deviations(self, changes: Floats, q: Floats) -> Floats:
        """The output of changed designs less the nominal one's, (samples, n)."""
        designs = self._found.designs(changes)
        apart = np.array([self._values(p, poses) for p, poses in zip(designs, q, strict=True)]) - self.nominal
        if self._output.joint and self._numbers.is_ball[self._output.place]:
            apart = short_way(apart)
        return np.asarray(apart.reshape(len(changes), -1))
