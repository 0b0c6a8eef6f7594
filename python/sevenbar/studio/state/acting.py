"""What acts on the linkage on view: switches of gravity, loads and springs, and the forces that follow."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.force_figures import sizing_of
from sevenbar.errors import SevenbarError
from sevenbar.forces.acting import Load, Spring
from sevenbar.forces.result import Forces, Reaction
from sevenbar.forces.sizing import Sizing
from sevenbar.kinematics.answers import LinkageAnswers
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.linkage import Linkage
from sevenbar.reporting.force_words import load_text, spring_text, triple_text
from sevenbar.reporting.shown import Shown

#: The switch of gravity.
GRAVITY = "gravity"

#: Why there are no forces where all is switched off and nothing has a mass.
ALL_OFF = "nothing acts: all of it is switched off, and nothing has a mass"


@dataclass(frozen=True)
class Switch:
    """Something that acts and can be switched off: its `key`, as long as the file is open, name and words."""

    key: str
    name: str
    words: str


@dataclass(frozen=True, eq=False)
class SwitchedLoading:
    """What acts on a linkage, without what is switched `off`, by the keys of its switches.

    The description stays as it is. Nothing is computed before it is asked for.
    """

    linkage: Linkage
    off: frozenset[str] = frozenset()
    _found: dict[Circuit, Forces | str] = field(default_factory=dict, repr=False)

    @property
    def is_empty(self) -> bool:
        """Whether nothing has a mass and nothing acts, switches or not."""
        return self.linkage.loading.is_empty

    @cached_property
    def switches(self) -> tuple[Switch, ...]:
        """Gravity where there is any, then every load and every spring."""
        if self.is_empty:
            return ()
        linkage, own = self.linkage, self.linkage.loading
        shown = Shown(linkage.unit_of(linkage.columns.index(linkage.drive.joint)))
        result: list[Switch] = []
        if any(own.gravity):
            result.append(Switch(GRAVITY, GRAVITY, f"{triple_text(own.gravity)} m/s^2"))
        result += _named("load", own.loads, [load_text(load, shown) for load in own.loads])
        words = []
        for spring in own.springs:
            slides = spring.joint is not None and not linkage.turns(linkage.column(spring.joint, "joint"))
            words.append(spring_text(spring, linkage.length_unit, slides=slides))
        return (*result, *_named("spring", own.springs, words))

    def switched(self, key: str, *, on: bool) -> SwitchedLoading:
        """The same with one of the switches on or off."""
        return SwitchedLoading(self.linkage, self.off - {key} if on else self.off | {key})

    def forces(self, view: TimedWalk) -> Forces | None:
        """The forces on the rows of a view's circuit; `None` where there are none."""
        result = self._forces(view.circuit)
        return None if isinstance(result, str) else result

    def reason(self, view: TimedWalk) -> str:
        """Why there are no forces on a view's circuit; empty where there are."""
        result = self._forces(view.circuit)
        return result if isinstance(result, str) else ""

    def _forces(self, circuit: Circuit) -> Forces | str:
        if circuit not in self._found:
            self._found[circuit] = self._computed(circuit)
        return self._found[circuit]

    def _computed(self, circuit: Circuit) -> Forces | str:
        if self._answers.linkage.loading.is_empty:
            return ALL_OFF
        try:
            return self._answers.forces(circuit, {})
        except SevenbarError as error:
            # a rod without a length, a body of a link that is drawn no more
            return str(error)

    @cached_property
    def _answers(self) -> LinkageAnswers:
        """What computes, one for all circuits."""
        if not self.off:
            return LinkageAnswers(self.linkage)
        own = self.linkage.loading
        return LinkageAnswers(
            self.linkage.loaded(
                gravity=(0.0, 0.0, 0.0) if GRAVITY in self.off else own.gravity,
                loads=[load for i, load in enumerate(own.loads, 1) if f"load {i}" not in self.off],
                springs=[spring for i, spring in enumerate(own.springs, 1) if f"spring {i}" not in self.off],
            )
        )


def _named(sort: str, acting: Sequence[Load] | Sequence[Spring], words: Sequence[str]) -> Iterator[Switch]:
    """The switches of loads or springs; names used twice and missing ones are numbered."""
    names = [one.name for one in acting]
    for i, (name, text) in enumerate(zip(names, words, strict=True), 1):
        key = f"{sort} {i}"
        plain = not name or name == GRAVITY or names.count(name) > 1
        yield Switch(key, f"{key} {name}".strip() if plain else name, text)


def drive_sizing(forces: Forces) -> Sizing | None:
    """Peaks of torque and power as `sizing` has them; without bearings, which take most of its time."""
    own = forces.within_stops
    return None if own is None else sizing_of(replace(own, reactions={}))


def known_force(reaction: Reaction) -> Floats:
    """The part of a joint's force that equilibrium determines (n, 3) [N], in the report frame."""
    force = np.where(reaction.determinate[3:], reaction.force, 0.0)
    return np.asarray(np.einsum("nij,nj->ni", reaction.axes, force))
