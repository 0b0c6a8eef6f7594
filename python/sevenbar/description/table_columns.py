"""The columns that tables of a linkage have, in the spellings of people and of other programs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches

from sevenbar.text.table import INDEX_BEFORE, plain_name

#: Letters of coordinates, and how the columns of a place or a direction begin.
_PLACES = ("", "at ", "point ", "p ", "position ", "pos ", "location ", "coordinate ")
_AXES = ("axis ", "axis 1 ", "direction ", "dir ", "axis direction ", "u ", "n ", "vector ")
_SECOND_AXES = ("axis 2 ", "second axis ", "direction 2 ", "dir 2 ", "axis2 ")

#: Every column that is read, by its key, and its spellings as `plain_name` has them.
SPELLINGS: Mapping[str, tuple[str, ...]] = {
    "kind": ("kind", "type", "joint type", "joint kind", "jointtype", "jointkind"),
    "joint": ("joint", "i", "no", "no.", "nr", "nr.", "number", "index", "row"),
    "name": ("name", "label", "joint name"),
    "length": ("length", "a", "a i", "ai", "link length", "r"),
    "twist": ("twist", "alpha", "\u03b1", "alpha i", "\u03b1 i", "link twist", "twist angle"),
    "offset": ("offset", "d", "d i", "di", "s", "joint offset", "link offset"),
    "angle": ("angle", "theta", "\u03b8", "theta i", "\u03b8 i", "joint angle"),
    "pitch": ("pitch", "h", "lead"),
    "longer": ("longer",),
    "value": ("value",),
    "link": ("link", "body", "on link"),
    "between": ("between", "links", "joins", "bodies", "link names"),
    "between a": ("between a", "between 1", "link a", "link 1", "first link", "from link"),
    "between b": ("between b", "between 2", "link b", "link 2", "second link", "to link"),
    "ground": ("ground", "fixed link", "ground link"),
    "order": ("order", "sequence", "loop order"),
    "input": ("input", "drive", "driver", "driven", "driving"),
    "output": ("output", "out"),
    "layout": ("layout",),
    "speed": ("speed", "drive speed", "input speed"),
    **{letter: tuple(f"{head}{letter}" for head in _PLACES) for letter in "xyz"},
    **{f"end {letter}": (f"end {letter}", f"to {letter}", f"{letter} 2") for letter in "xyz"},
    **{letter: (letter,) for letter in "uvw"},
    **{f"axis {letter}": tuple(f"{head}{letter}" for head in _AXES) for letter in "xyz"},
    **{f"axis 2 {letter}": tuple(f"{head}{letter}" for head in _SECOND_AXES) for letter in "xyz"},
}

#: The RSSR paper's dimensions, which are letters of their own: D is none of a Denavit-Hartenberg row.
DIMENSIONS = ("M", "N", "L1", "L3", "D", "L2")

#: What distinguishes one sort of table from the others.
ROWS = ("length", "twist", "offset")
PLACES = ("x", "y")

_KEYS = {spelling: key for key, spellings in SPELLINGS.items() for spelling in spellings}
#: With the letters of coordinates written together, as in `pointx`, `ux`, `axisx`.
_KEYS |= {spelling.replace(" ", ""): key for spelling, key in _KEYS.items() if spelling[-2:-1] == " "} | _KEYS

#: Lengths and twists of the row before: Craig's convention.
_MODIFIED = re.compile(
    rf"(?:a|alpha|\u03b1|length|twist)[\s_{{(\[]*{INDEX_BEFORE.pattern}[\s}})\]]*", re.IGNORECASE
)

#: A spelling this near to a known one is a slip of it; shorter words are too near to others.
CLOSE, SHORTEST = 0.8, 4


def key_of(label: str) -> str:
    """The key of a column by its name without the unit; empty where it is not known.

    >>> key_of("Link length"), key_of("axis_z"), key_of("comment")
    ('length', 'axis z', '')
    """
    return _KEYS.get(plain_name(label), "")


def is_header(labels: Sequence[str]) -> bool:
    """Whether cells are the header of a table of a linkage: two columns of a kind that no text has."""
    known = {key_of(label) for label in labels} - {
        "",
        "kind",
        "joint",
        "name",
        "link",
        "ground",
        "order",
        "value",
    }
    return len(known) >= 2 or has_dimensions(labels) or any(map(is_modified, labels))


def has_dimensions(labels: Sequence[str]) -> bool:
    """Whether the columns are the RSSR paper's dimensions."""
    return {"M", "N", "L1", "L3"} <= set(labels)


def is_modified(label: str) -> bool:
    """Whether a column is of Denavit-Hartenberg rows in Craig's convention, as `a_i-1`."""
    return _MODIFIED.fullmatch(label.strip()) is not None


def slip_of(label: str) -> str:
    """The known spelling of which a column's name is a slip; empty where there is none."""
    word = plain_name(label)
    if len(word) < SHORTEST or word in _KEYS:
        return ""
    near = get_close_matches(word, [known for known in _KEYS if len(known) >= SHORTEST], n=1, cutoff=CLOSE)
    return near[0] if near else ""
