"""Rows of a part on their way into its table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Integers

#: The status of a linkage that was measured.
OK = "ok"

#: The value of `circuit` for a linkage that has none.
NO_CIRCUIT = -1


@dataclass(frozen=True, eq=False)
class Block:
    """Rows of linkages, in any order: the linkage by its place in the part, its circuit, status and measures.

    Numbers are floats (r,), NaN where there is none; words are objects (r,), `None` where there is none.
    """

    linkage: Integers
    circuit: Integers
    status: npt.NDArray[np.object_]
    columns: dict[str, npt.NDArray[Any]]

    @staticmethod
    def measured(linkage: Integers, circuit: Integers, columns: dict[str, npt.NDArray[Any]]) -> Block:
        """Rows of linkages all of which were measured."""
        return Block(linkage, circuit, np.full(len(linkage), OK, dtype=object), columns)

    @staticmethod
    def joined(blocks: Sequence[Block]) -> Block:
        """The rows of several blocks with the same columns, by linkage and circuit."""
        linkage, circuit, status = (
            np.concatenate([getattr(block, name) for block in blocks])
            for name in ("linkage", "circuit", "status")
        )
        order = np.lexsort((circuit, linkage))
        columns = {
            name: np.concatenate([block.columns[name] for block in blocks])[order]
            for name in blocks[0].columns
        }
        return Block(linkage[order], circuit[order], status[order], columns)
