"""A column: one freedom of a joint, by its name, kind and unit."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sevenbar.kinematics.loop.joints import Freedom


@dataclass(frozen=True)
class Column:
    """One freedom of a joint: its number among the columns and its name, its kind, unit and joint.

    The `unit` of its values is "rad" or the length unit, the `joint` counts from 0, and is `None` of a link
    that rods alone hold. `is_output`: it may drive or be driven, as all but the turns of a ball; of a link on
    rods its place may be the output.
    """

    number: int
    name: str
    kind: Freedom
    unit: str
    joint: int | None
    is_output: bool

    @property
    def turns(self) -> bool:
        """Whether it is an angle, not a length."""
        return self.kind == "turn"

    @property
    def shown(self) -> tuple[str, float]:
        """The unit in which people read it, and what 1 of it is there: degrees for angles."""
        return ("deg", math.degrees(1.0)) if self.turns else (self.unit, 1.0)

    def text(self, value: float, digits: int = 6) -> str:
        """A value as people read it, with its unit, to so many digits."""
        return f"{math.degrees(value) if self.turns else value:.{digits}g} {self.shown[0]}"
