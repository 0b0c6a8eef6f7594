"""A description as TOML text, without a library for it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any


def toml_text(raw: Mapping[str, Any], head: Sequence[str] = ()) -> str:
    """A description as a file has it; `head` are lines of comment above it.

    >>> print(toml_text({"format": 1, "link": [{"length": 2.5}]}, ["rows"]), end="")
    # rows
    format = 1
    <BLANKLINE>
    [[link]]
    length = 2.5
    """
    # a name may hold what a comment may not
    lines = [f"# {''.join(c if c.isprintable() else '?' for c in line)}" for line in head]
    tables: list[str] = []
    for key, value in raw.items():
        if isinstance(value, Mapping):
            tables += ["", f"[{key}]", *_pairs(value)]
        elif is_tables(value):
            for table in value:
                tables += ["", f"[[{key}]]", *_pairs(table)]
        elif value != []:
            lines.append(f"{key} = {_value(value)}")
    return "\n".join([*lines, *tables]) + "\n"


def _pairs(table: Mapping[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in table.items()]


def is_tables(value: object) -> bool:
    """Whether a value is an array of tables, as [[joint]] writes one."""
    return isinstance(value, list) and bool(value) and all(isinstance(row, Mapping) for row in value)


def _value(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, str):
        # TOML's basic strings have JSON's escapes, except for pairs of surrogates
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return repr(value)
