"""Why a loop is rigid, or has a link without length, as a sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.loop.reason import OffJoint, Reason
from sevenbar.text.words import say


def reason_text(motion: Motion) -> str:
    """Which joints are off, by how much, and how the loop would move if not; empty without a reason."""
    reason = motion.reason
    if reason is None:
        return ""
    if reason.common == "one-axis":
        return _one_axis(motion, reason)
    unit = motion.linkage.length_unit
    all_turn = _all_turn(motion, reason)
    off = [_off_text(joint, reason, unit, all_turn=all_turn) for joint in reason.off]
    said = say("{fitting}, but {off}", fitting=_fitting_text(motion, reason), off=_listed(off))
    if reason.motion_type is None:
        return said
    return say(
        "{said}; without that it would move as a {motion_type}",
        said=said,
        motion_type=say(reason.motion_type),
    )


def _one_axis(motion: Motion, reason: Reason) -> str:
    linkage = motion.linkage
    first, second = reason.joints
    ends = {number for number, joint in enumerate(linkage.joints) if joint.name in reason.joints}
    link = next(link for link in linkage.graph.links if ends <= {*linkage.graph.joints_of(link)})
    if link == linkage.graph.ground:
        return say(
            "{first} and {second} are on one axis: the ground has length 0 between them",
            first=first,
            second=second,
        )
    return say(
        "{first} and {second} are on one axis: link {link} has length 0 between them",
        first=first,
        second=second,
        link=linkage.link_label(link),
    )


def _fitting_text(motion: Motion, reason: Reason) -> str:
    """What the joints that fit have in common."""
    names = _listed(reason.joints)
    if reason.common == "point":
        if not reason.joints:
            return say("the axes go through one point nearly")
        return say("the axes of {joints} go through one point", joints=names)
    if not _all_turn(motion, reason):
        return say("{joints} move in one plane", joints=names)
    if len(reason.joints) == 1:
        return say("the axes are parallel to that of {joint} nearly", joint=names)
    return say("the axes of {joints} are parallel", joints=names)


def _all_turn(motion: Motion, reason: Reason) -> bool:
    """Whether the joints that fit turn about axes square to the plane."""
    kinds = {joint.name: joint.kind for joint in motion.linkage.joints}
    return {kinds[name] for name in reason.joints} <= {"R", "E"}


def _off_text(off: OffJoint, reason: Reason, unit: str, *, all_turn: bool) -> str:
    if reason.common == "point":
        return say(
            "that of {joint} passes it at {distance:.3g} {unit}", joint=off.joint, distance=off.by, unit=unit
        )
    angle = math.degrees(off.by)
    if off.what == "slide":
        plane = say("the plane square to them") if all_turn else say("it")
        return say(
            "the slide of {joint} is {angle:.3g} deg off {plane}", joint=off.joint, angle=angle, plane=plane
        )
    if all_turn:
        return say("that of {joint} is {angle:.3g} deg off", joint=off.joint, angle=angle)
    return say("the axis of {joint} is {angle:.3g} deg off", joint=off.joint, angle=angle)


def _listed(words: Sequence[str]) -> str:
    """Words as a list that ends in "and"."""
    if len(words) < 2:
        return "".join(words)
    return say("{words} and {last}", words=say(", ").join(words[:-1]), last=words[-1])
