"""Links and joints as a graph: which joints a link has, and which two links a joint is between."""

from __future__ import annotations

from collections.abc import Sized
from dataclasses import dataclass
from functools import cache, cached_property

from sevenbar.arrays import whole_number
from sevenbar.errors import RequestError


@dataclass(frozen=True)
class Graph:
    """Links, counted from 1 with the ground last, and the joints `between` them, counted from 0.

    Each joint is between two links, the first of which is "before" it and the second "after" it: its
    motion is that of the link after against the link before. A link may have any number of joints. Code that
    takes links and joints from a graph need not know the order of joints in a loop.

        >>> four_bar = loop_graph("RRRR")
        >>> four_bar.ground, four_bar.joints_of(1), four_bar.joints_of(4), four_bar.neighbours(4)
        (4, (0, 1), (3, 0), (3, 1))
    """

    between: tuple[tuple[int, int], ...]

    @cached_property
    def ground(self) -> int:
        """The number of the ground, and so how many links there are."""
        return max(max(pair) for pair in self.between)

    @property
    def joints(self) -> range:
        """The numbers of all joints."""
        return range(len(self.between))

    @property
    def links(self) -> range:
        """The numbers of all links."""
        return range(1, self.ground + 1)

    @property
    def moving(self) -> range:
        """The numbers of the links that may move: all but the ground."""
        return range(1, self.ground)

    @cached_property
    def _joints(self) -> tuple[tuple[int, ...], ...]:
        return tuple(
            tuple(joint for side in (1, 0) for joint in self.joints if self.between[joint][side] == link)
            for link in self.links
        )

    def joints_of(self, link: int) -> tuple[int, ...]:
        """The joints of a link: those that it is after, then those that it is before."""
        return self._joints[link - 1]

    def side(self, joint: int, link: int) -> int:
        """The side of a joint on which one of its links is: 0 before it, 1 after it."""
        pair = self.between[whole_number("joint", joint, 0, len(self.between) - 1, "the number of a joint")]
        if whole_number("link", link, 1, self.ground, "a link") not in pair:
            raise RequestError(f"link: link {link} is not at joint {joint}; give {pair[0]} or {pair[1]}")
        return pair.index(link)

    def others_of(self, link: int, joint: int) -> tuple[int, ...]:
        """The joints of a link but one."""
        return tuple(other for other in self.joints_of(link) if other != joint)

    def neighbours(self, link: int) -> tuple[int, ...]:
        """The links that share a joint with a link, in the order of its joints."""
        return tuple(self.between[joint][1 - self.side(joint, link)] for joint in self.joints_of(link))

    @property
    def standing(self) -> tuple[int, ...]:
        """The joints of the ground, in the order of joints."""
        return tuple(sorted(self.joints_of(self.ground)))

    @cached_property
    def tree(self) -> tuple[int, ...]:
        """Joints that lead from the ground to each moving link once, in order outwards."""
        # depth first, so that the tree of a single loop is its chain; `path` leads to the link reached last
        reached, result, path = {self.ground}, list[int](), [self.ground]
        while path:
            for joint in sorted(self.joints_of(path[-1])):
                following = set(self.between[joint]) - reached
                if following:
                    reached |= following
                    result.append(joint)
                    path += following
                    break
            else:
                path.pop()
        return tuple(result)

    @cached_property
    def apart(self) -> tuple[int, ...]:
        """The moving links to which no joints lead from the ground: those of a net that rods alone hold."""
        reached = {link for joint in self.tree for link in self.between[joint]}
        return tuple(link for link in self.moving if link not in reached)

    @property
    def closing(self) -> tuple[int, ...]:
        """The joints that are not of the tree, each of which closes a loop."""
        return tuple(joint for joint in self.joints if joint not in self.tree)

    def moving_link(self, joint: int) -> int:
        """The link that a joint moves: the one after it, or before it where the one after is the ground."""
        before, after = self.between[joint]
        return before if after == self.ground else after


def loop_graph(joints: Sized) -> Graph:
    """The graph of the joints of one loop: joint i is between link i, for 0 the ground, and link i + 1.

    >>> one = loop_graph("RRRR")
    >>> one.tree, one.closing
    ((0, 1, 2), (3,))
    """
    return _ring(len(joints))


@cache
def _ring(count: int) -> Graph:
    return Graph(tuple((joint or count, joint + 1) for joint in range(count)))
