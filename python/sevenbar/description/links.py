"""Links by name: which two each joint is between, pins, and whether they make one loop.

A file whose joints say `between` lists them in any order. Where they make one loop it becomes that loop's own
tables, joints in order, as if they had been written so; anything else is a net.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from sevenbar.description.written import entries, has_links
from sevenbar.errors import DescriptionError, Problem, is_name, shown, suggestion
from sevenbar.kinematics.loop.graph import Graph

#: Most joints and rods of a net.
MOST_EDGES = 40

#: Keys of a whole file that only links by name need.
OWN_KEYS = ("ground", "pin")

#: The axis of a pin.
ACROSS = [0, 0, 1]

#: A pin in a slot, seen from the link with the pin and from that with the slot.
OTHER_SLOT = {"K": "L", "L": "K"}

#: Tables that name a link, by the key that does.
NAMING = {"point": "link", "body": "link", "load": "link", "rod": "link", "spring": "links"}


@dataclass(frozen=True)
class Edge:
    """A joint or a rod as written: its place in the file, its name, its two links, its table."""

    place: str
    name: str
    between: tuple[str, str]
    table: Mapping[str, Any]


@dataclass
class NamedLinks:
    """The joints and rods of a file, with what is wrong in how they join links."""

    raw: Mapping[str, Any]
    problems: list[Problem] = field(default_factory=list)
    joints: list[Edge] = field(default_factory=list)
    rods: list[Edge] = field(default_factory=list)

    def __post_init__(self) -> None:
        for i, table in enumerate(entries(self.raw, "joint"), 1):
            self._read(f"joint[{i}]", table, f"theta_{i}", self.joints)
        for i, table in enumerate(entries(self.raw, "pin"), 1):
            self._read_pin(f"pin[{i}]", table, f"pin_{i}")
        for i, table in enumerate(entries(self.raw, "rod"), 1):
            if "radius" not in table:
                self._read(f"rod[{i}]", table, f"rod_{i}", self.rods)
        if not self.problems:
            self.problems += self._flaws()

    def _read(self, place: str, table: Mapping[str, Any], name: str, edges: list[Edge]) -> None:
        between = table.get("between")
        if "between" not in table:
            message = "is missing; where one joint says which two links it is between, all do"
        elif not isinstance(between, list | tuple) or len(between) != 2 or not all(map(is_name, between)):
            message = f'{shown(between)} are not two links; give their names, as in ["frame", "crank"]'
        elif between[0].strip() == between[1].strip():
            message = f"{shown(between[0])} is joined to itself; give two links"
        else:
            first, second = (link.strip() for link in between)
            label = table.get("name")
            label = label.strip() if is_name(label) else name
            edges.append(Edge(place, label, (first, second), table))
            return
        self.problems.append(Problem(f"{place}.between", message))

    def _read_pin(self, place: str, table: Mapping[str, Any], name: str) -> None:
        links, at = table.get("links"), table.get("at")
        if not isinstance(links, list | tuple) or len(links) < 2 or not all(map(is_name, links)):
            message = f'{shown(links)} are no links; give the names of two or more, as in ["frame", "crank"]'
            self.problems.append(Problem(f"{place}.links", message))
            return
        if len({link.strip() for link in links}) < len(links):
            self.problems.append(
                Problem(f"{place}.links", f"{shown(links)} names a link twice; give each once")
            )
            return
        if not isinstance(at, list | tuple) or len(at) != 2:
            self.problems.append(
                Problem(f"{place}.at", f"{shown(at)} is not a place; give x and y, as in [40, 0]")
            )
            return
        label = table.get("name")
        label = label.strip() if is_name(label) else name
        first, *others = (link.strip() for link in links)
        for k, other in enumerate(others, 1):
            hinge = label if len(others) == 1 else f"{label}.{k}"
            joint = {"name": hinge, "kind": "R", "at": [*at, 0], "axis": ACROSS}
            self.joints.append(Edge(place, hinge, (first, other), joint))

    @property
    def edges(self) -> list[Edge]:
        """Joints, then rods."""
        return [*self.joints, *self.rods]

    @property
    def ground(self) -> str:
        """The name of the link that stands still."""
        written = self.raw.get("ground")
        return written.strip() if is_name(written) else ""

    @cached_property
    def links(self) -> list[str]:
        """The names of all links, in the order in which they are first named, the ground last."""
        named = dict.fromkeys(link for edge in self.edges for link in edge.between if link != self.ground)
        return [*named, self.ground]

    @cached_property
    def graph(self) -> Graph:
        """Links and joints; rods are not in it."""
        number = {link: i for i, link in enumerate(self.links, 1)}
        return Graph(tuple((number[a], number[b]) for a, b in (joint.between for joint in self.joints)))

    def _flaws(self) -> list[Problem]:
        """What is wrong with the links and joints together."""
        named = [link for edge in self.edges for link in edge.between]
        if not self.joints:
            return [Problem("joint", "there is none; give the joints of the linkage")]
        if not self.ground or self.ground not in named:
            written = self.raw.get("ground")
            near = "" if written is None else suggestion(written, named)
            what = "is missing" if written is None else f"no joint is at a link {shown(written)}"
            known = ", ".join(dict.fromkeys(named))
            return [Problem("ground", f"{what}; {near}name the link that stands still, one of {known}")]
        problems = [
            Problem(
                f"{edge.place}.between",
                f"{shown(link)} is named only here; a link needs two joints, or a joint and a rod",
            )
            for edge in self.edges
            for link in edge.between
            if named.count(link) == 1
        ]
        pairs: dict[frozenset[str], Edge] = {}
        for joint in self.joints:
            first = pairs.setdefault(frozenset(joint.between), joint)
            if first is not joint:
                what = f"{' and '.join(joint.between)} are joined twice, by {first.name} and {joint.name}"
                remedy = "give one joint with the freedoms that both leave"
                problems.append(Problem(f"{joint.place}.between", f"{what}; {remedy}"))
        if len(self.edges) > MOST_EDGES:
            count = f"{len(self.edges)} joints and rods"
            problems.append(Problem("joint", f"{count} are not taken; give up to {MOST_EDGES}"))
        reached = self._reached()
        if apart := [link for link in self.links if link not in reached]:
            named_apart = ", ".join(apart)
            problems.append(Problem("ground", f"{named_apart}: nothing joins them to {shown(self.ground)}"))
        return problems

    def _reached(self) -> set[str]:
        reached, ahead = {self.ground}, [self.ground]
        while ahead:
            link = ahead.pop()
            for edge in self.edges:
                if link in edge.between:
                    ahead += [other for other in edge.between if other not in reached]
                    reached |= set(edge.between)
        return reached

    @property
    def is_loop(self) -> bool:
        """Whether joints alone make one loop through all links."""
        ends = [link for joint in self.joints for link in joint.between]
        return not self.rods and all(ends.count(link) == 2 for link in self.links)

    def loop_tables(self) -> dict[str, Any]:
        """The tables of the one loop that they make, joints in order from the ground, links by number."""
        order, link = [], self.ground
        remaining = list(self.joints)
        # the first joint of the file that is at the ground is the first of the loop
        while remaining:
            joint = next(joint for joint in remaining if link in joint.between)
            remaining.remove(joint)
            a, b = joint.between
            order.append((joint, link == a))
            link = b if link == a else a
        tables = []
        for i, (joint, outwards) in enumerate(order):
            # the last joint of a drawing counts the link before it against the ground
            forward = outwards != (i + 1 == len(order))
            tables.append(_turned(joint, forward=forward))
        numbers = {}
        for i, (joint, outwards) in enumerate(order, 1):
            numbers[joint.between[1 if outwards else 0]] = i
        result = {key: value for key, value in self.raw.items() if key not in OWN_KEYS}
        result["joint"] = tables
        for head, key in NAMING.items():
            if head in result and isinstance(result[head], list):
                result[head] = [_numbered(table, key, numbers) for table in result[head]]
        return result


def _turned(joint: Edge, *, forward: bool) -> dict[str, Any]:
    """The table of a joint in a loop, its links turned round where not `forward`."""
    table = {"name": joint.name, **{k: v for k, v in joint.table.items() if k != "between"}}
    if forward:
        return table
    if "axis" in table:
        table["axis"] = _reversed(table["axis"])
    if isinstance(table.get("axes"), list | tuple):
        # what the first link holds is held by the second
        table["axes"] = [_reversed(axis) for axis in reversed(table["axes"])]
        table["kind"] = OTHER_SLOT.get(table.get("kind", ""), table.get("kind"))
    return table


def _reversed(axis: Any) -> Any:
    if not isinstance(axis, list | tuple):
        return axis
    return [-x if isinstance(x, int | float) and not isinstance(x, bool) else x for x in axis]


def _numbered(table: Any, key: str, numbers: Mapping[str, int]) -> Any:
    """A table whose links are numbers, as far as it names links that there are."""
    if not isinstance(table, Mapping) or key not in table:
        return table
    value = table[key]
    if isinstance(value, list | tuple):
        return {**table, key: [_number(one, numbers) for one in value]}
    return {**table, key: _number(value, numbers)}


def _number(link: Any, numbers: Mapping[str, int]) -> Any:
    return numbers.get(link.strip(), link) if isinstance(link, str) else link


def named_links(raw: Mapping[str, Any], source: str = "") -> NamedLinks:
    """The links of a file by name; `DescriptionError` with all that is wrong in how joints join them."""
    links = NamedLinks(raw)
    if links.problems:
        raise DescriptionError(links.problems, source)
    return links


def in_loop_order(raw: Mapping[str, Any], source: str = "") -> Mapping[str, Any]:
    """A file's tables, those of one loop by its links' names as the loop's own."""
    if not has_links(raw):
        return raw
    links = named_links(raw, source)
    return links.loop_tables() if links.is_loop else raw
