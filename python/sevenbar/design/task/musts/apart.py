"""The must of a distance: two links stay apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from sevenbar.description.values import Length, key
from sevenbar.design.task.flaws import Flaws, not_positive
from sevenbar.design.task.loop import Here, Slacks, TaskLoop
from sevenbar.design.task.task import DesignTask, MustForm, PoseMust, Want
from sevenbar.design.task.values import Links
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.rods import distance_slopes


class ApartMust(MustForm):
    """Two links keep a distance."""

    kind: Annotated[Literal["apart"], key("this must")]
    links: Annotated[Links, key("their numbers, counted from 1")]
    least: Annotated[Length, key("the least distance of the two as rods between their joints", "length")]

    def must(self, linkage: Linkage, wants: Sequence[Want]) -> Apart:
        return Apart(self.links, self.least)


@dataclass(frozen=True)
class Apart(PoseMust):
    """Two links, counted from 1, as rods between their joints keep a `least` distance [length]."""

    form = ApartMust
    fault = "distance"
    ease = "a smaller distance of the links"

    links: tuple[int, int]
    least: float

    def turns(self, linkage: Linkage) -> bool:
        return False

    def flaws(self, task: DesignTask) -> Flaws:
        graph = task.draft.linkage.graph
        first, second = self.links
        outside = [link for link in self.links if link not in graph.links]
        if outside:
            yield "links", f"{outside[0]} is not a link; give 1 to {graph.ground}, the last is the ground"
        elif first == second:
            yield "links", f"{first} is named twice; give two links"
        elif second in graph.neighbours(first):
            yield (
                "links",
                f"{first} and {second} meet in a joint, so their distance is 0; give links that do not",
            )
        yield from not_positive("least", self.least, "distance", "a length")

    def words(self, linkage: Linkage) -> str:
        first, second = self.links
        return f"links {first} and {second} at least {self.least:g} {linkage.length_unit} apart"

    def slacks(self, loop: TaskLoop) -> Callable[[Here], Slacks]:
        ends = [end for link in self.links for end in loop.rod(link)]

        def slacks(here: Here) -> Slacks:
            apart, by = distance_slopes(here.points[:, ends], here.points_by[:, ends])
            return (apart - self.least)[:, None] / loop.size, by[:, None] / loop.size

        return slacks
