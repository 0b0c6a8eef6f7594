"""Joints, pins and rods of a file as edges between links by name, read before they are checked."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sevenbar.description.not_covered import OF_JOINTS
from sevenbar.errors import NAME_TO_GIVE, Problem, is_name, shown
from sevenbar.kinematics.loop.joints import KINDS, column_names

#: The axis of a pin.
ACROSS = [0, 0, 1]

#: What separates the names of a text; where it has none of these, blanks do.
SEPARATORS = r"[;,|]"

#: What the names of two links may look like.
EXAMPLE = '["frame", "crank"]'


@dataclass(frozen=True)
class Edge:
    """A joint or a rod as written: its place in the file, its name, its two links, its table."""

    place: str
    name: str
    between: tuple[str, str]
    table: Mapping[str, Any]
    is_named: bool = True

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of its columns, none of a rod."""
        kind = self.table.get("kind")
        if not isinstance(kind, str) or kind not in KINDS:
            return ()
        return tuple(column_names(self.name, KINDS[kind].freedoms))

    @property
    def is_ball(self) -> bool:
        """Whether it is known to be a ball."""
        kind = self.table.get("kind")
        return isinstance(kind, str) and kind in KINDS and KINDS[kind].is_ball

    @property
    def links_place(self) -> str:
        """Where the file has its links."""
        return f"{self.place}.{'links' if self.place.startswith('pin') else 'between'}"


def edge_of(place: str, table: Mapping[str, Any], default: str) -> Edge | Problem:
    """A joint or a rod, with a `default` for its name; or what is wrong with its links."""
    if "links" in table and "kind" not in table and place.startswith("joint"):
        return Problem(place, "is a pin, with links and no kind; write it as [[pin]]")
    if "between" not in table:
        message = "is missing; where one joint says which two links it is between, all do"
        if others := [key for key in OF_JOINTS if key in table]:
            what = place.partition("[")[0]
            message = (
                f"is missing; a {what} has it in place of {' and '.join(others)}, as in between = {EXAMPLE}"
            )
        return Problem(f"{place}.between", message)
    between = table["between"]
    if wrong := _no_names(between, "two links, one after the other"):
        return Problem(f"{place}.between", wrong)
    if len(between) != 2:
        what = f"{shown(between)} are not two links; give their names, as in {EXAMPLE}"
        return Problem(f"{place}.between", what)
    first, second = (link.strip() for link in between)
    if first == second:
        return Problem(f"{place}.between", f"{shown(first)} is joined to itself; give two links")
    label, is_named = label_of(table, default)
    return Edge(place, label, (first, second), table, is_named)


def hinges_of(place: str, table: Mapping[str, Any], default: str) -> list[Edge] | Problem:
    """The hinges of a pin, with a `default` for its name; or what is wrong with its links or its place."""
    if "between" in table and "kind" in table:
        return Problem(place, "is a joint, with between and a kind; write it as [[joint]]")
    if "links" not in table:
        message = f"is missing; give the names of two or more, as in {EXAMPLE}"
        if "between" in table:
            message = f"is missing; a pin has it in place of between, as in links = {EXAMPLE}"
        return Problem(f"{place}.links", message)
    links = table["links"]
    if wrong := _no_names(links, "the links that turn on the pin"):
        return Problem(f"{place}.links", wrong)
    if len(links) < 2:
        message = f"{shown(links)} are no links; give the names of two or more, as in {EXAMPLE}"
        return Problem(f"{place}.links", message)
    first, *others = (link.strip() for link in links)
    if len({first, *others}) < len(links):
        return Problem(f"{place}.links", f"{shown(links)} names a link twice; give each once")
    at = table.get("at")
    if not isinstance(at, list | tuple) or len(at) != 2:
        what = f"{shown(at)} is not a place" if "at" in table else "is missing"
        return Problem(f"{place}.at", f"{what}; give x and y, as in [40, 0]")
    label, is_named = label_of(table, default)
    edges = []
    for k, other in enumerate(others, 1):
        hinge = label if len(others) == 1 else f"{label}.{k}"
        joint = {"name": hinge, "kind": "R", "at": [*at, 0], "axis": ACROSS}
        edges.append(Edge(place, hinge, (first, other), joint, is_named))
    return edges


def label_of(table: Mapping[str, Any], default: str) -> tuple[str, bool]:
    """The name of a table, `default` where it has none, and whether it has one."""
    name = table.get("name")
    return (name.strip(), True) if is_name(name) else (default, False)


def names_in(text: str) -> list[str]:
    """The names in a text: between `;`, `,` or `|`, or between blanks where it has none of these.

    >>> names_in("frame; lower arm"), names_in("frame crank")
    (['frame', 'lower arm'], ['frame', 'crank'])
    """
    names = re.split(SEPARATORS, text) if re.search(SEPARATORS, text) else text.split()
    return [name.strip() for name in names if name.strip()]


def _no_names(links: Any, what: str) -> str:
    """What is wrong with a value that should be a list of names; empty for one that is."""
    if isinstance(links, str) and links.strip():
        names = names_in(links)
        example = json.dumps(names, ensure_ascii=False) if len(names) > 1 else EXAMPLE
        return f"{shown(links)} is one text; give {what}, as a list: {example}"
    if not isinstance(links, list | tuple) or not links:
        return f"{shown(links)} are no links; give {what}, as in {EXAMPLE}"
    wrong = next((link for link in links if not is_name(link)), None)
    if isinstance(wrong, str) and wrong.strip():
        return f"{shown(wrong)} is not the name of a link; give {NAME_TO_GIVE}"
    if wrong is not None or None in links:
        return f"{shown(wrong)} is not the name of a link; give {what}, as in {EXAMPLE}"
    return ""
