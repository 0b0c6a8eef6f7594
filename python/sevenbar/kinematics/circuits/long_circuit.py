"""A circuit of so many rows that they are computed when they are wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import Tally

#: Samples a turn from which circuits are long: eight circuits of fewer rows take some 100 MB.
LONG = 20_000

#: What a circuit has by its rows.
BY_ROW = frozenset(
    ("q", "dq", "ddq", "dddq", "time", "status", "branch", "mode", "residual", "condition", "_point")
)


class LongCircuit(Circuit):
    """A circuit that computes its rows at the first look at one of them, the same each time, and keeps them.

    The rows of a loop with eight circuits at a million samples a turn would fill 3 GB. Who goes through
    them circuit by circuit takes `fleeting()` ones.
    """

    _made: Callable[[], Circuit]

    @staticmethod
    def of(empty: Circuit, tally: Tally, made: Callable[[], Circuit]) -> LongCircuit:
        """A circuit like one without rows, with a tally of those that `made` computes."""
        circuit = object.__new__(LongCircuit)
        selected = {f.name: getattr(empty, f.name) for f in fields(Circuit) if f.name not in BY_ROW}
        circuit.__dict__.update(selected, tally=tally, _made=made)
        return circuit

    def __getattr__(self, name: str) -> Any:
        # only of what it has not (yet)
        if name not in BY_ROW or "_made" not in self.__dict__:
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        made = self._made()
        self.__dict__.update({field: getattr(made, field) for field in BY_ROW})
        return self.__dict__[name]

    def __reduce__(self) -> tuple[type[Circuit], tuple[Any, ...]]:
        # pickled as its numbers
        return Circuit, tuple(getattr(self, f.name) for f in fields(Circuit))

    def fleeting(self) -> Circuit:
        """The circuit with its rows; this one does not keep them, unless it has them already."""
        return self if "q" in self.__dict__ else self._made()
