"""What acts on a linkage: gravity, bodies, loads, springs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sevenbar.arrays import triple, truth, whole_number
from sevenbar.errors import RequestError, check_kind, shown

# most linkages have none
if TYPE_CHECKING:
    from sevenbar.forces.acting import Load, Spring
    from sevenbar.forces.bodies import Body

#: Most loads, springs or turns that are counted: far beyond what a file holds.
MOST = 1_000_000


@dataclass(frozen=True, eq=False)
class Loading:
    """Gravity (3,) [m/s^2] in the report frame, bodies by their link, loads and springs."""

    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    bodies: Mapping[int, tuple[Body, ...]] = field(default_factory=dict)
    loads: tuple[Load, ...] = ()
    springs: tuple[Spring, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "gravity", triple("gravity", self.gravity))
        object.__setattr__(self, "bodies", _by_link(self.bodies))
        for name in ("loads", "springs"):
            object.__setattr__(self, name, _acting(name, getattr(self, name)))

    @property
    def is_empty(self) -> bool:
        """Whether nothing has a mass, and nothing acts."""
        return not (any(self.bodies.values()) or self.loads or self.springs)

    def left_out(self, *, gravity: bool = False, loads: int = 0, springs: int = 0) -> str:
        """What a file leaves out of it, in words: gravity, and so many loads and springs; empty without any.

        >>> Loading(gravity=(0, 0, -9.81)).left_out(gravity=True, loads=1, springs=2)
        'gravity, 1 load, 2 springs'
        """
        counts = {
            "load": whole_number("loads", loads, 0, MOST, "a count"),
            "spring": whole_number("springs", springs, 0, MOST, "a count"),
        }
        words = [f"{count} {what}{'s' * (count > 1)}" for what, count in counts.items() if count]
        return ", ".join(["gravity", *words] if truth("gravity", gravity) and any(self.gravity) else words)

    def check_input(self, *, turns: bool) -> None:
        """Refuses loads whose range or table is none of the input; `turns`: the input is an angle."""
        for i, load in enumerate(self.loads):
            try:
                load.check_input(turns=turns)
            except RequestError as error:
                raise RequestError(f"loads[{i}].{error}") from None

    def breaks(self, *, turns: int) -> tuple[float, ...]:
        """Inputs [rad] in so many turns at which a load sets in, ends, or its table has a corner."""
        turns = whole_number("turns", turns, 0, MOST, "a count of turns")
        corners = [x for load in self.loads for x in load.corners(turns=True)]
        return tuple(x + math.tau * turn for turn in range(turns) for x in corners)


def _acting(name: str, given: Any) -> tuple[Any, ...]:
    """Loads or springs, each checked; raises `RequestError` for what is none."""
    if isinstance(given, tuple | list) and not given:
        return ()
    from sevenbar.forces.acting import Load, Spring

    kind: type = Load if name == "loads" else Spring
    example = f"give {name} in a list, as in [sevenbar.{kind.__name__}(..)]"
    try:
        result = tuple(given)
    except TypeError:
        raise RequestError(f"{name}: {shown(given)} is no list; {example}") from None
    for i, one in enumerate(result):
        check_kind(f"{name}[{i}]", one, kind, f"a {kind.__name__.lower()}; {example}")
    return result


def _by_link(given: Mapping[int, Body | Sequence[Body]]) -> dict[int, tuple[Body, ...]]:
    """Bodies by their link, one or several given for each; raises `RequestError` for what is no body."""
    if isinstance(given, dict) and not given:
        return {}
    from sevenbar.forces.bodies import Body

    check_kind("bodies", given, Mapping, "a mapping of links; give one, as in {2: sevenbar.Body(..)}")
    result = {}
    for link, own in given.items():
        whole_number("bodies", link, 1, None, "a link")
        bodies = tuple(own) if isinstance(own, (list, tuple)) else (own,)
        for body in bodies:
            if not isinstance(body, Body):
                raise RequestError(
                    f"bodies[{shown(link)}]: {shown(body)} is not a body; give one, as in "
                    "sevenbar.Body(1.2, solid='rod')"
                )
        result[link] = bodies
    return result


#: What acts on a linkage that was given no bodies and no loads.
UNLOADED = Loading()
