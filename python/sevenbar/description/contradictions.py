"""Contradictions between the keys of a description: each is valid alone, together they are not.

Values of a wrong form are skipped here; the schema reports them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sevenbar.description.not_covered import not_covered
from sevenbar.description.written import (
    Written,
    drive_of,
    driven,
    entries,
    is_only_ground,
    joints_of,
    names_ground,
    unknown_link,
)
from sevenbar.errors import Problem, shown
from sevenbar.kinematics.loop.graph import loop_graph
from sevenbar.kinematics.loop.joints import JOINT_KINDS, KINDS, READ_KINDS, ROW_KINDS, no_reading

#: The keys of the three ways to write a linkage: a file has one of them.
FORMS = ("rssr", "joint", "link")

FEWEST_JOINTS, MOST_JOINTS = 2, 12


def other_file(raw: Mapping[str, Any]) -> str:
    """What to say of tables that describe no linkage at all: an empty file, a design task; else nothing."""
    if not raw:
        return "is empty; begin with a linkage of the gallery, as in 'sevenbar gallery rssr > mine.toml'"
    if not raw.keys() & set(FORMS):
        for word in raw:
            if lacking := not_covered(word):
                return f"{word}: {lacking}"
    if "want" in raw and not raw.keys() & set(FORMS):
        return "is a design task and not a linkage; 'sevenbar design task' takes it"
    return ""


def contradictions(raw: Mapping[str, Any]) -> list[Problem]:
    """All contradictions of a description, in the order of its keys."""
    written = [key for key in FORMS if key in raw]
    if len(written) != 1:
        if not written:
            return [
                Problem("", "no linkage is described; give one of [rssr], [[joint]], [[pin]] or [[link]]")
            ]
        what = f"{' and '.join(written)} are given together"
        return [Problem("", f"{what}; give exactly one of [rssr], [[joint]] or [[link]]")]
    (key,) = written
    joints = joints_of(raw)
    problems = []
    if key == "joint":
        tables = [(i, t) for i, t in enumerate(entries(raw, key), 1) if t.get("kind") in JOINT_KINDS]
        problems = [
            Problem(f"joint[{i}].{name}", message) for i, t in tables for name, message in wrong_keys(t)
        ]
        if tables and tables[-1][0] == len(entries(raw, key)) and "longer" in tables[-1][1]:
            message = (
                "does not belong to the last joint; the ground is as its joints are drawn, so leave it out"
            )
            problems.append(Problem(f"joint[{tables[-1][0]}].longer", message))
    elif key == "link":
        tables = [(i, t) for i, t in enumerate(entries(raw, key), 1) if t.get("joint", "R") in ROW_KINDS]
        problems = [Problem(f"link[{i}].{name}", m) for i, t in tables for name, m in _wrong_row_keys(t)]
    number = len(loop_graph(joints).joints)
    countable = FEWEST_JOINTS <= number <= MOST_JOINTS
    if isinstance(raw[key], list) and not countable:
        count = f"a loop of {number} joint{'' if number == 1 else 's'}"
        problems.append(Problem(key, f"{count} is not taken; give {FEWEST_JOINTS} to {MOST_JOINTS}"))
    problems += taken_names(joints) + _misplaced_points(raw, joints)
    return problems + (driven(joints, drive_of(raw))[2] if countable else [])


def taken_names(joints: Sequence[Written]) -> list[Problem]:
    """Names of joints that another joint, or a column of it, has already."""
    problems, taken = [], set[str]()
    for joint in joints:
        labels = {joint.name, *joint.columns}
        if labels & taken:
            message = f"{shown(joint.name)} is taken already; give each joint its own name"
            problems.append(Problem(f"{joint.place}.name", message))
        taken |= labels
    return problems


def _misplaced_points(raw: Mapping[str, Any], joints: Sequence[Written]) -> list[Problem]:
    problems = []
    taken = {"A", "B"} if [joint.kind for joint in joints] == ["R", "S", "S", "R"] else set()
    for i, table in enumerate(entries(raw, "point"), 1):
        link, name = table.get("link"), table.get("name")
        if isinstance(link, int) and not isinstance(link, bool):
            problems += unknown_link(f"point[{i}].link", link, joints)
        # no name at all is reported elsewhere
        if isinstance(name, str) and name.strip() and name.strip() in taken:
            problems.append(
                Problem(f"point[{i}].name", f"{shown(name)} is taken already; give each point its own name")
            )
        taken.add(str(name).strip())
    return problems


#: The keys of directions, of which a kind has one at most, each with an example.
_DIRECTIONS = {"axis": "[0, 0, 1]", "axes": "[[1, 0, 0], [0, 1, 0]]"}


def wrong_keys(joint: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Keys of a drawn joint that its kind needs and that are missing, or that its kind has no use for."""
    kind = joint["kind"]
    needs = set(KINDS[kind].drawn_keys)
    present = joint.keys() & {key for row in KINDS.values() for key in row.drawn_keys}
    missing = []
    for right, wrong in (("axis", "axes"), ("axes", "axis")):
        # one in place of the other is one mistake
        if right in needs - present and wrong in present - needs:
            give = f"give its {right}, as in {right} = {_DIRECTIONS[right]}"
            missing.append((wrong, f"does not belong to a joint of kind {kind}; {give}"))
            needs, present = needs - {right}, present - {wrong}
    missing += [(key, f"is missing; a joint of kind {kind} needs it") for key in sorted(needs - present)]
    if "value" in joint and kind not in READ_KINDS:
        missing.append(("value", no_reading(kind)))
    return missing + [
        (key, f"does not belong to a joint of kind {kind}; leave it out") for key in sorted(present - needs)
    ]


def _wrong_row_keys(row: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The same for a Denavit-Hartenberg row; the number that moves is the joint's value, not written."""
    kind = row.get("joint", "R")
    moving, has_pitch = KINDS[kind].moving_key, "pitch" in KINDS[kind].row_keys
    wrong = []
    if has_pitch and "pitch" not in row:
        wrong.append(("pitch", f"is missing; a joint of kind {kind} needs it"))
    if moving in row:
        wrong.append((moving, f"is what moves in a joint of kind {kind}; leave it out"))
    if not has_pitch and "pitch" in row:
        wrong.append(("pitch", f"does not belong to a joint of kind {kind}; leave it out"))
    return wrong


def grounds(raw: Mapping[str, Any]) -> dict[tuple[int | str, ...], str]:
    """A message for each key that declares a ground: the last link is the ground without an entry.

    An entry that is nothing else is a place of its own, without a message.
    """
    last = len(joints_of(raw))
    already = f"link {last} is the ground already"
    leave = f"is not known here; {already}; leave it out"
    result: dict[tuple[int | str, ...], str] = {("ground",): leave}
    for key, kind_key in (("joint", "kind"), ("link", "joint")):
        for i, table in enumerate(entries(raw, key)):
            result[(key, i, "ground")] = leave
            kind = table.get(kind_key)
            if not names_ground(kind):
                continue
            what = f"{shown(kind)} is not a joint kind; {already}"
            if is_only_ground(table, kind):
                result[(key, i)] = ""
                result[(key, i, kind_key)] = f"{what} and needs no entry; leave this one out"
            else:
                kinds = ", ".join(ROW_KINDS)
                result[(key, i, kind_key)] = f"{what}, being the last; give the joint before it: {kinds}"
    return result
