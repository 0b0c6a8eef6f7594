"""The joints of a description as written, before they are checked: names, kinds, input and output."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from sevenbar.errors import Problem, nearest, no_joint, shown
from sevenbar.kinematics.loop.graph import loop_graph
from sevenbar.kinematics.loop.joints import KINDS, column_names

#: Words that people use for the ground where a joint's kind should stand.
GROUND_WORDS = ("g", "ground", "fixed", "frame", "base")

#: Heads of tables that join links by name, and of others that may name links.
LINK_HEADS = ("joint", "pin", "rod")
OTHER_HEADS = ("link", "point", "body", "load", "spring", "stop", "drive", "forces", "rssr")

#: Names and kinds of the joints of a linkage written as [rssr].
RSSR_JOINTS = (("crank", "R"), ("ball_a", "S"), ("ball_b", "S"), ("rocker", "R"))


@dataclass(frozen=True)
class Written:
    """A joint as far as it can be read from an unchecked file: its kind is empty where that is unknown."""

    place: str
    name: str
    kind: str

    @property
    def is_ball(self) -> bool:
        """Whether it is known to be a ball."""
        return bool(self.kind) and KINDS[self.kind].is_ball

    @property
    def bends(self) -> bool:
        """Whether it is known to turn about more than one axis through one place."""
        return bool(self.kind) and KINDS[self.kind].bends

    @cached_property
    def columns(self) -> dict[str, str]:
        """What each of its freedoms does, by the name of its column."""
        freedoms = KINDS[self.kind].freedoms if self.kind else ("turn",)
        return dict(zip(column_names(self.name, freedoms), freedoms, strict=True))


def drive_of(raw: Mapping[str, Any]) -> Mapping[str, Any]:
    """The table of the drive, empty where there is none."""
    drive = raw.get("drive")
    return drive if isinstance(drive, Mapping) else {}


def joints_of(raw: Mapping[str, Any]) -> list[Written]:
    """The joints of a file, without entries that are nothing but a ground."""
    if "rssr" in raw:
        return [Written("", name, kind) for name, kind in RSSR_JOINTS]
    key, kind_key, default = ("joint", "kind", "") if "joint" in raw else ("link", "joint", "R")
    joints = []
    for i, table in enumerate(entries(raw, key), 1):
        kind, name = table.get(kind_key, default), table.get("name")
        label = name.strip() if isinstance(name, str) else ""
        if not is_only_ground(table, kind):
            known = kind if isinstance(kind, str) and kind in KINDS else ""
            joints.append(Written(f"{key}[{i}]", label or f"theta_{i}", known))
    return joints


def meant_kind(word: object) -> str:
    """The kind that a word stands for, or nothing."""
    plain = word.strip().lower().removesuffix("joint").strip() if isinstance(word, str) else ""
    return next((letter for letter, kind in KINDS.items() if plain in kind.words), "")


def names_ground(kind: object) -> bool:
    """Whether a joint's kind is a word for the ground."""
    return isinstance(kind, str) and kind.strip().lower() in GROUND_WORDS


def is_only_ground(table: Mapping[str, Any], kind: object) -> bool:
    """Whether an entry is nothing but a ground, which a loop has without a word."""
    return names_ground(kind) and not table.keys() & {"length", "twist", "offset"}


def driven(
    joints: Sequence[Written],
    drive: Mapping[str, Any],
    places: Sequence[str] = (),
    what: Literal["a loop", "a net"] = "a loop",
) -> tuple[str, str, list[Problem]]:
    """The columns of input and output, and what is wrong with those that are named.

    The plain name of a joint of several freedoms is its first one. Without a word the input is the first
    joint that is no ball, and the output the last one; where there is no other, the last of the `places` of
    links that rods alone hold.
    """
    firsts = [next(iter(joint.columns)) for joint in joints if not joint.is_ball]
    free = [column for joint in joints if not joint.is_ball for column in joint.columns]
    if not free or len(free) + len(places) < 2:
        kinds = " ".join(joint.kind for joint in joints)
        count = "one freedom" if free else "no freedom"
        message = f"{what} {kinds} has {count} outside its balls; an input and an output need two"
        known_kinds = all(joint.kind for joint in joints)
        return "", "", [Problem("joint", message)] if known_kinds else []
    # two joints of one name are reported elsewhere; to choose from they are one
    choices = list(dict.fromkeys(free))
    problems = []
    chosen: dict[str, str] = {}
    for key in ("joint", "output"):
        name = drive.get(key)
        if not isinstance(name, str):
            continue
        column, wrong = named_column(name, joints, places if key == "output" else ())
        if wrong:
            problems.append(Problem(f"drive.{key}", wrong))
        else:
            chosen[key] = column
    first = chosen.get("joint", firsts[0])
    others = [column for column in choices if column != first] or [*places]
    # `first` where one name stands for every joint, which is reported elsewhere
    last = chosen.get(
        "output", next((c for c in [*reversed(firsts), *reversed(others)] if c != first), first)
    )
    # an input that is named wrongly may be any other
    if chosen.get("output") == first and not (problems and "joint" not in chosen):
        one = len(others) == 1
        rest = f"the output is the other one, {others[0]}" if one else f"give another: {', '.join(others)}"
        problems.append(Problem("drive.output", f"joint {shown(first)} is the input; {rest}"))
    return first, last, problems


def named_column(name: str, joints: Sequence[Written], places: Sequence[str] = ()) -> tuple[str, str]:
    """The column that a name means, the first one of a joint's name, and what is wrong with the name.

    `places` are columns of links that rods alone hold which it may mean as well.
    """
    name = name.strip()
    if name in places:
        return name, ""
    owner = next((joint for joint in joints if name == joint.name or name in joint.columns), None)
    if owner is None:
        known = (name for j in joints for name in ([j.name] if j.is_ball else j.columns))
        return "", no_joint(name, [*dict.fromkeys(known), *places])
    if owner.is_ball:
        free = dict.fromkeys(column for joint in joints if not joint.is_ball for column in joint.columns)
        return "", f"joint {shown(owner.name)} is a ball; give a joint with one freedom: {', '.join(free)}"
    return next(iter(owner.columns)) if name == owner.name else name, ""


def unknown_link(place: str, link: int, joints: Sequence[Written]) -> list[Problem]:
    """What is wrong with the number of a link that a loop of these joints does not have."""
    if not joints or link <= (ground := loop_graph(joints).ground):
        return []
    return [Problem(place, f"{shown(link)} is not a link; give 1 to {ground}, the last is the ground")]


def has_links(raw: Mapping[str, Any]) -> bool:
    """Whether a file has links by name."""
    if "pin" in raw or misnamed_heads(raw):
        return True
    if "ground" in raw and raw.keys().isdisjoint(("rssr", "joint", "link")):
        return True
    named = any("between" in table for head in ("joint", "rod") for table in _tables(raw, head))
    return named or any("links" in table and "kind" not in table for table in entries(raw, "joint"))


def _tables(raw: Mapping[str, Any], head: str) -> list[Mapping[str, Any]]:
    """The tables of a head, also where they are no list but one table, or have names."""
    value = raw.get(head)
    if not isinstance(value, Mapping):
        return entries(raw, head)
    return [value, *(table for table in value.values() if isinstance(table, Mapping))]


def misnamed_heads(raw: Mapping[str, Any]) -> dict[str, str]:
    """The heads of a file's tables that name their links and are called otherwise, each with its own."""
    result = {}
    for word in raw.keys() - set(LINK_HEADS) - set(OTHER_HEADS):
        tables = [table for table in entries(raw, word) if _names_links(table)]
        if not tables:
            continue
        at = tables[0].get("at")
        is_rod = isinstance(at, list | tuple) and len(at) == 2 and isinstance(at[0], list | tuple)
        head = "pin" if "links" in tables[0] else "rod" if is_rod else "joint"
        near = nearest(word, (*LINK_HEADS, *OTHER_HEADS))
        if near not in OTHER_HEADS:
            result[word] = near or head
    return result


def _names_links(table: Mapping[str, Any]) -> bool:
    links = table.get("links", table.get("between"))
    return isinstance(links, list | tuple) and any(isinstance(link, str) for link in links)


def entries(raw: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    """The entries of a list of tables; one that is none counts as empty."""
    rows = raw.get(key)
    return [row if isinstance(row, Mapping) else {} for row in rows] if isinstance(rows, list) else []
