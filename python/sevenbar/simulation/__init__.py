"""The linkage as a virtual prototype: built and moved by another program, beside what Sevenbar says.

The way there: a `course` of rows and a `prototype` that starts at one of them, an engine's module that moves
it and knows nothing else, `agreement` of both, then `figures` and `report`.
"""

from sevenbar.simulation.run import ENGINES, prepared, simulate

__all__ = ["ENGINES", "prepared", "simulate"]


def __dir__() -> list[str]:
    return sorted(__all__)
