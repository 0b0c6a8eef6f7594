"""Many linkages: dimensions over grids and samples, measures of each, tables that survive a crash.

From a request to a table: `axes` and `sampling` make a `space` of linkages, a `plan` holds the
request, `rows` makes a part of the table, `parts` keeps it in a folder, `run` drives this on threads or on a
`cluster`, and `result` is what is left.
"""

from sevenbar.sweep.axes import grid, span
from sevenbar.sweep.result import Sweep
from sevenbar.sweep.run import run

__all__ = ["Sweep", "grid", "run", "span"]


def __dir__() -> list[str]:
    return sorted(__all__)
