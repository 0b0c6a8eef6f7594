"""A description as the TOML text of a file, every digit kept."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any


def written(description: Mapping[str, Any]) -> str:
    """The text of a file that holds these tables and keys."""
    plain = {key: value for key, value in description.items() if not _is_table(value)}
    parts = [_keys(plain)]
    for name, value in description.items():
        if isinstance(value, Mapping):
            parts.append(f"[{name}]\n{_keys(value)}")
        elif _is_table(value):
            parts += [f"[[{name}]]\n{_keys(row)}" for row in value]
    return "\n".join(parts)


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    )


def _keys(table: Mapping[str, Any]) -> str:
    return "".join(f"{key} = {_value(value)}\n" for key, value in table.items())


def _value(value: Any) -> str:
    if isinstance(value, list | tuple):
        return f"[{', '.join(_value(v) for v in value)}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)
