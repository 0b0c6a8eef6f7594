"""What is wrong in how joints join links by name: slips of names, links apart, pairs joined twice."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from sevenbar.description.edges import Edge
from sevenbar.description.written import drive_of, entries
from sevenbar.errors import Problem, is_name, nearest, no_joint_but, shown, suggestion

#: Most joints and rods of a net.
MOST_EDGES = 40

#: Names with this share of like letters may be slips of each other; 'lower arm' and 'upper arm' are none.
SLIP = 0.81

#: What a link needs.
LOOSE = "a link needs two joints, or a joint and a rod"

#: Tables that stand above no key of the whole file.
LISTS = ("joint", "pin", "rod", "point")


def ground_flaws(raw: Mapping[str, Any], edges: Sequence[Edge]) -> list[Problem]:
    """What is wrong with the name of the link that stands still."""
    named = list(dict.fromkeys(link for edge in edges for link in edge.between))
    written = raw.get("ground")
    if is_name(written) and written.strip() in named:
        return []
    below = {f"{head}[{i}]": table for head in LISTS for i, table in enumerate(entries(raw, head), 1)}
    for place, table in {"drive": drive_of(raw), **below}.items():
        if written is None and "ground" in table:
            return [Problem(f"{place}.ground", "is a key of the whole file; write it above the first table")]
    known = ", ".join(named)
    if written is None:
        return [Problem("ground", f"is missing; name the link that stands still, one of {known}")]
    if not is_name(written):
        example = shown(named[0]).replace("'", '"')
        what = f"{shown(written)} is not the name of a link; give one, as in ground = {example}"
        return [Problem("ground", what)]
    what = f"no joint is at a link {shown(written)}; {suggestion(written, named)}"
    return [Problem("ground", f"{what}name the link that stands still, one of {known}")]


def spelling_flaws(edges: Sequence[Edge]) -> list[Problem]:
    """Links whose names differ in capitals, blanks, `_` or `-` alone: one link, written in two ways."""
    counts = Counter(link for edge in edges for link in edge.between)
    usual: dict[str, str] = {}
    for link in counts:
        best = usual.setdefault(_plain(link), link)
        if counts[link] > counts[best]:
            usual[_plain(link)] = link
    return [
        Problem(edge.links_place, f"{shown(link)} is written {shown(best)} elsewhere; give one name")
        for edge in edges
        for link in edge.between
        if (best := usual[_plain(link)]) != link
    ]


def graph_flaws(joints: Sequence[Edge], rods: Sequence[Edge], ground: str) -> list[Problem]:
    """What is wrong with the graph of links: too many joints, loose ends, pairs joined twice, parts apart."""
    edges = [*joints, *rods]
    if len(edges) > MOST_EDGES:
        count = f"{len(edges)} joints and rods"
        return [Problem(edges[0].place.partition("[")[0], f"{count} are not taken; give up to {MOST_EDGES}")]
    return _loose(edges) + _joined_twice(joints) + _rods_twice(rods) + _apart(edges, ground)


def _loose(edges: Sequence[Edge]) -> list[Problem]:
    counts = Counter(link for edge in edges for link in edge.between)
    alone = {link: edge for edge in edges for link in edge.between if counts[link] == 1}
    problems, slips = [], set[str]()
    for link, edge in alone.items():
        if link in slips:
            continue
        # two names that are near each other are one link of two joints
        others = [other for other in alone if other != link and alone[other] is not edge]
        if pair := _slip(link, others):
            slips.add(pair)
            what = f"{shown(pair)} is named only here, and {shown(link)} only at {edge.place}"
            what += "; give them one name, or each another joint"
            problems.append(Problem(alone[pair].links_place, what))
        else:
            near = _slip(link, [other for other in counts if other not in alone])
            near = f"did you mean {shown(near)}? " if near else ""
            problems.append(Problem(edge.links_place, f"{shown(link)} is named only here; {near}{LOOSE}"))
    return problems


def _slip(link: str, others: Sequence[str]) -> str:
    """The other name of which a link's may be a slip; one that has another number is none."""
    plain = re.sub(r"\d", "", link)
    return nearest(link, [other for other in others if re.sub(r"\d", "", other) != plain], SLIP)


def _joined_twice(joints: Sequence[Edge]) -> list[Problem]:
    problems = []
    pairs: dict[frozenset[str], Edge] = {}
    for joint in joints:
        first = pairs.setdefault(frozenset(joint.between), joint)
        if first is joint:
            continue
        what = f"{' and '.join(joint.between)} are joined twice, by {first.name} and {joint.name}"
        apart = _distance(first.table.get("at"), joint.table.get("at"))
        remedy = "give one joint with the freedoms that both leave"
        if "R" == first.table.get("kind") == joint.table.get("kind") and apart is not None:
            what += f", {apart:.3g} apart" if apart else " in one place"
            remedy = "leave one out, or name another link"
        problems.append(Problem(joint.links_place, f"{what}; {remedy}"))
    return problems


def _rods_twice(rods: Sequence[Edge]) -> list[Problem]:
    problems = []
    for k, rod in enumerate(rods):
        ends = _ends(rod)
        first = next((other for other in rods[:k] if _ends(other) == ends), None)
        if first is not None:
            problems.append(Problem(rod.place, f"is {first.place} again; leave one out"))
    return problems


def _apart(edges: Sequence[Edge], ground: str) -> list[Problem]:
    reached, ahead = {ground}, [ground]
    while ahead:
        link = ahead.pop()
        for edge in edges:
            if link in edge.between:
                ahead += [other for other in edge.between if other not in reached]
                reached |= set(edge.between)
    apart = dict.fromkeys(link for edge in edges for link in edge.between if link not in reached)
    return [Problem("ground", f"{', '.join(apart)}: nothing joins them to {shown(ground)}")] if apart else []


def name_flaws(edges: Sequence[Edge]) -> list[Problem]:
    """Names of joints and rods that another one has already; where only one is written, at that one."""
    problems, taken = dict[str, Problem](), dict[str, Edge]()
    for edge in edges:
        labels = (edge.name, *edge.columns)
        first = next((taken[label] for label in labels if label in taken), edge)
        taken |= dict.fromkeys(labels, edge)
        if first.place == edge.place:
            continue
        at, other = (edge, first) if edge.is_named else (first, edge)
        place = f"{at.place}.name"
        what = f"{shown(edge.name)} is taken already, by {other.place}; give each joint and rod its own name"
        # hinges of one pin have one name
        problems.setdefault(place, Problem(place, what))
    return list(problems.values())


def naming_flaws(
    raw: Mapping[str, Any], links: Sequence[str], rods: Sequence[Edge], naming: Mapping[str, str]
) -> list[Problem]:
    """Links that are named elsewhere and are not there; names that two points have.

    `naming` has the key that names a link, by the head of its table.
    """
    problems, taken = [], set[str]()
    known = ", ".join(links)
    for head, key in naming.items():
        for i, table in enumerate(entries(raw, head), 1):
            name, carriers = table.get("name"), table.get(key)
            if head == "point" and is_name(name):
                if name.strip() in taken:
                    message = f"{shown(name)} is taken already; give each point its own name"
                    problems.append(Problem(f"point[{i}].name", message))
                taken.add(name.strip())
            for link in carriers if isinstance(carriers, list | tuple) else [carriers]:
                if not is_name(link) or link.strip() in links:
                    continue
                what = f"no link {shown(link)}; {suggestion(link, links)}this linkage has {known}"
                if link.strip() in [rod.name for rod in rods]:
                    what = (
                        f"{shown(link)} is a rod, which takes part with its length alone; give one of {known}"
                    )
                problems.append(Problem(f"{head}[{i}].{key}", what))
    return problems


def drive_flaws(drive: Mapping[str, Any], joints: Sequence[Edge], rods: Sequence[Edge]) -> list[Problem]:
    """Links and rods that are named where a joint drives."""
    problems = []
    names = {joint.name for joint in joints}
    links = {link for joint in joints for link in joint.between}
    may = [joint for joint in joints if not joint.is_ball]
    for key in ("joint", "output"):
        word = drive.get(key)
        if not isinstance(word, str) or (name := word.strip()) in names:
            continue
        of_link = [joint.name for joint in may if name in joint.between] if name in links else None
        if of_link is not None or name in [rod.name for rod in rods]:
            what = no_joint_but(name, [joint.name for joint in may], of_link)
            problems.append(Problem(f"drive.{key}", what))
    return problems


def _plain(name: str) -> str:
    return re.sub(r"[\s_-]+", " ", name).lower()


def _distance(first: Any, second: Any) -> float | None:
    """How far two places are from each other, where both are three numbers."""
    places = [at for at in (first, second) if isinstance(at, list | tuple) and len(at) == 3]
    numbers = [float(x) for at in places for x in at if isinstance(x, int | float)]
    return math.dist(numbers[:3], numbers[3:]) if len(numbers) == 6 else None


def _ends(rod: Edge) -> Any:
    """What a rod joins where, in no order; its place where it has no two ends."""
    at = rod.table.get("at")
    if not isinstance(at, list | tuple) or len(at) != 2:
        return rod.place
    return {(link, shown(end)) for link, end in zip(rod.between, at, strict=True)}
