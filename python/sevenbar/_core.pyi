"""The Rust core: arrays in, arrays out."""

from typing import Any, final

import numpy as np
import numpy.typing as npt

__all__ = ["CoreError", "Rssr", "__version__", "simd_level"]

_Floats = npt.NDArray[np.float64]

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

def simd_level() -> str: ...
