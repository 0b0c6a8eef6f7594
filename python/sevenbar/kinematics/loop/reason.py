"""Why a loop is rigid: joints that are off the plane or the point of the others, or two on one axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

#: What the others have in common: a plane in which they move, a point through which their axes go; or two
#: joints turn about one axis, so that the link between them has no length.
Common = Literal["plane", "point", "one-axis"]

#: What of a joint is off.
What = Literal["axis", "slide"]


@dataclass(frozen=True)
class OffJoint:
    """A joint that does not fit the others.

    `by` is how far: of an "axis" the angle [rad] to the normal of the plane, or the distance [length] from
    the point; of a "slide" the angle [rad] to the plane.
    """

    joint: str
    what: What
    by: float


@dataclass(frozen=True)
class Reason:
    """What keeps a loop from moving, or leaves a link of it without length.

    `joints` have in `common` a plane, a point or one axis. `off` are the joints that do not fit, and
    `motion_type` is how the loop would move if they did; `None` where nothing says how they would fit.
    """

    common: Common
    joints: tuple[str, ...]
    off: tuple[OffJoint, ...] = ()
    motion_type: str | None = None
