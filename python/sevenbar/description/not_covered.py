"""What people write into a linkage file that is not covered, and what to do about it."""

from __future__ import annotations

_LOOPS = (
    "a file has one loop, in which each joint joins the next link to the last; links by name, of one loop or "
    'of several, are given as between = ["frame", "crank"] of each joint and as ground = "frame"'
)
_FRICTION = "friction is not covered: joints have none here; leave it out"

#: By the words that people use, for tables, keys and kinds of joints.
NOT_COVERED = {
    **dict.fromkeys(("loop", "loops", "chain", "chains"), _LOOPS),
    **dict.fromkeys(("friction", "mu"), _FRICTION),
    **dict.fromkeys(
        ("gear", "gears", "gearbox", "rack", "pinion"), "gears are not covered; give the loop of links alone"
    ),
    **dict.fromkeys(
        ("cam", "cams", "follower", "slot"),
        "cams are not covered; a follower that a curve moves can be given by a --law",
    ),
    **dict.fromkeys(
        ("belt", "belts", "pulley", "rope"), "belts are not covered; give the loop of links alone"
    ),
    **dict.fromkeys(("contact", "collision"), "contact is not covered; stops say how far joints may go"),
}

#: The same for keys of a joint: what it joins.
OF_JOINTS = dict.fromkeys(("links", "link", "parent", "child", "bodies", "body"), _LOOPS)


def not_covered(word: object, *, of_joint: bool = False) -> str:
    """What to say of a word of a file that means something that is not covered; empty for others."""
    plain = str(word).strip().lower()
    return NOT_COVERED.get(plain) or (OF_JOINTS.get(plain, "") if of_joint else "")
