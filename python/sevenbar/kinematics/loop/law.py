"""How the input moves in time: its angle or place and their derivatives, sample by sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, finite_array, spread_array
from sevenbar.errors import RequestError
from sevenbar.text.printing import Printed


@dataclass(frozen=True, eq=False, repr=False)
class Law(Printed):
    """An input law: time [s], input [rad] and its derivatives by time, each of shape (n,).

    Laws of the same numbers are equal; its arrays are its own and read-only.
    """

    t: Floats
    q: Floats
    dq: Floats
    ddq: Floats
    dddq: Floats

    def __post_init__(self) -> None:
        for name in ("t", "q", "dq", "ddq", "dddq"):
            array = finite_array(name, getattr(self, name)).copy()
            array.setflags(write=False)
            object.__setattr__(self, name, array)
            if array.size != self.t.size or not array.size:
                raise RequestError(
                    f"{name}: {array.size} values where t has {self.t.size}; give as many, or Law.of"
                )

    def __reduce__(self) -> tuple[type[Law], tuple[Floats, ...]]:
        return Law, (self.t, self.q, self.dq, self.ddq, self.dddq)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Law):
            return NotImplemented
        return np.array_equal(self.t, other.t) and np.array_equal(self.table, other.table)

    def __hash__(self) -> int:
        # equal zeros differ in their sign bit, which adding 0 takes away
        return hash(((self.t + 0.0).tobytes(), (self.table + 0.0).tobytes()))

    @staticmethod
    def of(
        t: npt.ArrayLike, q: npt.ArrayLike, dq: npt.ArrayLike, ddq: npt.ArrayLike, dddq: npt.ArrayLike = 0.0
    ) -> Law:
        """A law from array-likes; a single number stands for every sample.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> t = np.linspace(0, 1, 50)
        >>> law = sb.Law.of(t, q=3 * t**2, dq=6 * t, ddq=6)
        >>> sb.load("rssr").motion(law=law).circuits[0].time.size
        50
        """
        times = finite_array("t", t)
        if times.size == 0:
            raise RequestError("t: a law needs at least one sample")
        rates = {"q": q, "dq": dq, "ddq": ddq, "dddq": dddq}
        checked = {name: spread_array(name, values, times.size, "t") for name, values in rates.items()}
        if np.any(np.diff(times) <= 0):
            raise RequestError("t: times must rise from sample to sample")
        return Law(times, **checked)

    @property
    def table(self) -> Floats:
        """The input and its derivatives, (n, 4)."""
        return np.column_stack([self.q, self.dq, self.ddq, self.dddq])
