"""The Rust core: arrays in, arrays out."""

from collections.abc import Sequence
from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "AGREE",
    "CoreError",
    "Loop",
    "Numbers",
    "Rows",
    "Rssr",
    "__version__",
    "classify_rssr",
    "measure_loops",
    "measure_rssr",
    "simd_level",
]

_Floats = npt.NDArray[np.float64]

#: The closure error [rad, or parts of the size] up to which redundant constraints agree.
AGREE: float
__version__: str

class CoreError(ValueError):
    """A request that the core cannot take."""

@final
class Rssr:
    """The RSSR in closed form."""

    def __new__(cls, base: _Floats, ground: _Floats, links: _Floats) -> Rssr: ...
    @property
    def lengths(self) -> list[float]: ...
    @property
    def size(self) -> float: ...
    def outputs(
        self,
        inputs: _Floats,
        outputs: list[_Floats],
        input: str,
        speed: float,
        law: tuple[_Floats, ...] | None = None,
    ) -> None: ...
    def assembly_modes(self, theta: float, input: str) -> tuple[_Floats, _Floats]: ...
    def motion(
        self, input: str, samples: int, speed: float, law: _Floats | None = None
    ) -> dict[str, Any]: ...
    def point(self, link: int, at: _Floats, crank: _Floats, rocker: _Floats) -> _Floats: ...

@final
class Loop:
    """A single closed loop of R, P, H and S joints."""

    def __new__(
        cls, letters: str, advances: _Floats, base: _Floats, ground: _Floats, links: _Floats
    ) -> Loop: ...
    @property
    def size(self) -> float: ...
    @property
    def freedoms(self) -> int: ...
    @property
    def can_be_driven(self) -> bool: ...
    @property
    def idle(self) -> list[tuple[str, int, int]]: ...
    def assembly_modes(self, column: int, value: float) -> tuple[_Floats, _Floats, str, list[float]]: ...
    def mobility(self, column: int) -> dict[str, Any]: ...
    def motion(
        self, input: int, output: int, samples: int, speed: float, law: _Floats | None = None
    ) -> dict[str, Any]: ...
    def circuit_through(
        self, pose: _Floats, input: int, output: int, samples: int, speed: float, law: _Floats | None = None
    ) -> dict[str, Any]: ...
    def point(self, rows: Rows, link: int, at: _Floats) -> _Floats: ...

@final
class Numbers:
    """A loop that knows what its numbers move; lengths in parts of the size."""

    def __new__(
        cls,
        letters: str,
        advances: _Floats,
        fixed: _Floats,
        input: int,
        held: Sequence[int],
        spins: int,
        numbers: int,
        moves: Sequence[tuple[int, int]],
        twists: _Floats,
        pitches: Sequence[tuple[int, int, float]],
        points: Sequence[tuple[int, _Floats, Sequence[tuple[int, _Floats]]]],
    ) -> Numbers: ...
    def slopes(self, values: _Floats, order: int) -> list[_Floats]: ...
    def follow(
        self,
        values: _Floats,
        inputs: _Floats,
        fixed: _Floats,
        advances: _Floats,
        steps: _Floats | None = None,
    ) -> tuple[_Floats, _Floats]: ...

@final
class Rows:
    """Rows of a circuit, of which their loop tells the points of any link; pickled as their numbers."""

    def __new__(cls, numbers: _Floats, offsets: _Floats, speed: float) -> Rows: ...
    def __reduce__(self) -> tuple[type[Rows], tuple[_Floats, _Floats, float]]: ...

def classify_rssr(dimensions: _Floats, input: str, threads: int) -> tuple[npt.NDArray[np.uint8], _Floats]: ...
def measure_loops(
    letters: str,
    advances: _Floats,
    base: _Floats,
    ground: _Floats,
    links: _Floats,
    input: int,
    output: int,
    samples: int,
    threads: int,
) -> dict[str, npt.NDArray[Any]]: ...
def measure_rssr(dimensions: _Floats, input: str, threads: int) -> dict[str, npt.NDArray[Any]]: ...
def simd_level() -> str: ...
