"""Links by name: which two each joint is between, pins, and whether they make one loop.

A file whose joints say `between` lists them in any order. Where they make one loop it becomes that loop's own
tables, joints in order, as if they had been written so; anything else is a net.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from sevenbar.description.edges import Edge, edge_of, hinges_of
from sevenbar.description.link_flaws import (
    drive_flaws,
    graph_flaws,
    ground_flaws,
    name_flaws,
    naming_flaws,
    spelling_flaws,
)
from sevenbar.description.not_covered import OF_JOINTS
from sevenbar.description.written import LINK_HEADS, drive_of, entries, has_links, misnamed_heads
from sevenbar.errors import DescriptionError, Problem, bare, is_name, shown
from sevenbar.kinematics.loop.graph import Graph

#: Keys of a whole file that only links by name need.
OWN_KEYS = ("ground", "pin")

#: Keys of a pin.
PIN_KEYS = {"at", "links", "name"}

#: A pin in a slot, seen from the link with the pin and from that with the slot.
OTHER_SLOT = {"K": "L", "L": "K"}

#: Tables that name a link, by the key that does.
NAMING = {"point": "link", "body": "link", "load": "link", "rod": "link", "spring": "links"}


@dataclass
class NamedLinks:
    """The joints and rods of a file, with what is wrong in how they join links."""

    raw: Mapping[str, Any]
    problems: list[Problem] = field(default_factory=list)
    joints: list[Edge] = field(default_factory=list)
    rods: list[Edge] = field(default_factory=list)

    def __post_init__(self) -> None:
        for word, head in sorted(misnamed_heads(self.raw).items()):
            self.problems.append(Problem(bare(word), f"is not known here; write [[{head}]]"))
        if self.problems:
            # joints and links are not known without them
            return
        for head in ("joint", "pin"):
            if head in self.raw and not entries(self.raw, head) and self.raw[head] != []:
                self.problems.append(Problem(head, f"{shown(self.raw[head])} is no list; write [[{head}]]"))
        joints = entries(self.raw, "joint")
        if joints and not any(table.keys() & {"between", *OF_JOINTS} for table in joints):
            what = 'do not name their links; each needs between, as in between = ["frame", "crank"]'
            self.problems.append(Problem("joint", what))
            return
        for i, table in enumerate(joints, 1):
            self._take(edge_of(f"joint[{i}]", table, f"theta_{i}"), self.joints)
        for i, table in enumerate(entries(self.raw, "pin"), 1):
            self._take(hinges_of(f"pin[{i}]", table, f"pin_{i}"), self.joints)
        for i, table in enumerate(entries(self.raw, "rod"), 1):
            if "between" in table or "radius" not in table:
                self._take(edge_of(f"rod[{i}]", table, f"rod_{i}"), self.rods)
        if not self.problems:
            self.problems += self._flaws()

    def _take(self, read: Edge | list[Edge] | Problem, edges: list[Edge]) -> None:
        if isinstance(read, Problem):
            self.problems.append(read)
        else:
            edges += [read] if isinstance(read, Edge) else read

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
        if not self.joints:
            return [Problem("joint", "there is none; give the joints of the linkage")]
        if problems := spelling_flaws(self.edges) or ground_flaws(self.raw, self.edges):
            return problems
        of_graph = graph_flaws(self.joints, self.rods, self.ground)
        again = [problem.place.partition(".")[0] for problem in of_graph]
        return [
            *of_graph,
            *name_flaws([edge for edge in self.edges if edge.place not in again]),
            *naming_flaws(self.raw, self.links, self.rods, NAMING),
            *(drive_flaws(drive_of(self.raw), self.joints, self.rods) if self._are_named else ()),
        ]

    @property
    def _are_named(self) -> bool:
        """Whether no joint or rod has a name that is none, so that others may mean it."""
        tables = (table for head in LINK_HEADS for table in entries(self.raw, head))
        return all(is_name(table["name"]) for table in tables if "name" in table)

    @property
    def is_loop(self) -> bool:
        """Whether joints alone make one loop through all links."""
        ends = [link for joint in self.joints for link in joint.between]
        return not self.rods and all(ends.count(link) == 2 for link in self.links)

    @cached_property
    def loop_order(self) -> list[tuple[Edge, bool]]:
        """The joints of the one loop that they make, from the ground, and which lead outwards."""
        order, link = [], self.ground
        remaining = list(self.joints)
        # the first joint of the file that is at the ground is the first of the loop
        while remaining:
            joint = next(joint for joint in remaining if link in joint.between)
            remaining.remove(joint)
            a, b = joint.between
            order.append((joint, link == a))
            link = b if link == a else a
        return order

    def loop_tables(self) -> dict[str, Any]:
        """The tables of the one loop that they make, joints in order from the ground, links by number."""
        order = self.loop_order
        tables = []
        for i, (joint, outwards) in enumerate(order):
            # the last joint of a drawing counts the link before it against the ground
            forward = outwards != (i + 1 == len(order))
            tables.append(_turned(joint, outwards=outwards, forward=forward))
        numbers = {}
        for i, (joint, outwards) in enumerate(order, 1):
            numbers[joint.between[1 if outwards else 0]] = i
        result = {key: value for key, value in self.raw.items() if key not in OWN_KEYS}
        result["joint"] = tables
        for head, key in NAMING.items():
            if head in result and isinstance(result[head], list):
                result[head] = [_numbered(table, key, numbers) for table in result[head]]
        return result

    def as_written(self, problem: Problem) -> Problem:
        """A problem of the one loop's tables, at its place in the file."""
        match = re.match(r"joint\[(\d+)\]", problem.place)
        if match is None:
            return problem
        edge = self.loop_order[int(match[1]) - 1][0]
        return Problem(edge.place + problem.place[match.end() :], problem.message)


def _turned(joint: Edge, *, outwards: bool, forward: bool) -> dict[str, Any]:
    """The table of a joint in a loop, its links in order, its values turned round where not `forward`."""
    table = {"name": joint.name, **{k: v for k, v in joint.table.items() if k != "between"}}
    if isinstance(table.get("axes"), list | tuple) and not outwards:
        # what the first link holds is held by the second
        table["axes"] = list(reversed(table["axes"]))
        table["kind"] = OTHER_SLOT.get(table.get("kind", ""), table.get("kind"))
    if not forward:
        if "axis" in table:
            table["axis"] = _reversed(table["axis"])
        if isinstance(table.get("axes"), list | tuple):
            table["axes"] = [_reversed(axis) for axis in table["axes"]]
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
    """The links of a file by name; `DescriptionError` with all that is wrong in how joints join them.

    That is with what is wrong in their numbers.
    """
    links = NamedLinks(raw)
    if links.problems:
        # of wrong files only
        from sevenbar.description.net_schema import value_flaws

        of_values = value_flaws(raw, source)
        of_links = [_with_unknown_keys(problem, of_values) for problem in links.problems]
        raise DescriptionError(_one_each(of_links, of_values), source)
    if links.is_loop and any(pin.keys() - PIN_KEYS for pin in entries(raw, "pin")):
        from sevenbar.description.net_schema import value_flaws

        # the loop's joints have no key of their pins but these
        of_pins = [flaw for flaw in value_flaws(raw, source) if flaw.place.startswith("pin[")]
        raise DescriptionError(of_pins, source)
    return links


def in_loop_order(raw: Mapping[str, Any], source: str = "") -> Mapping[str, Any]:
    """A file's tables, those of one loop by its links' names as the loop's own."""
    if not has_links(raw):
        return raw
    links = named_links(raw, source)
    return links.loop_tables() if links.is_loop else raw


def _with_unknown_keys(problem: Problem, of_values: list[Problem]) -> Problem:
    """A problem of a key that is missing, with the unknown keys of its table that it does not name."""
    from sevenbar.description.mistakes import NOT_KNOWN

    alike = next((other.message for other in of_values if other.place == problem.place), "")
    _, words, keys = alike.partition(NOT_KNOWN)
    if not words or f"in place of {keys}" in problem.message:
        return problem
    return Problem(problem.place, problem.message + words + keys)


def _one_each(of_links: list[Problem], of_values: list[Problem]) -> list[Problem]:
    """Both, without a second one on the links of a table, and on what is no table at all."""
    no_tables = [problem.place for problem in of_values if "." not in problem.place]
    first = [problem for problem in of_links if problem.place.partition(".")[0] not in no_tables]
    tables = {problem.place.partition(".")[0] for problem in first}
    places = {problem.place for problem in first}
    keys = re.compile(rf"\.({'|'.join(['between', *OF_JOINTS])})\b")
    rest = []
    for problem in of_values:
        table = problem.place.partition(".")[0]
        head = table.partition("[")[0]
        on_links = keys.search(problem.place) and tables & {table, head}
        if not on_links and places.isdisjoint((problem.place, table)):
            rest.append(problem)
    return first + rest
