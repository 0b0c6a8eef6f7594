"""The keys of linkage files and of task files, from the schemas that check them."""

import json
from pathlib import Path
from typing import Any

from page_tables import code, table
from sevenbar.description.net_schema import NetPointForm, NetRodForm, PinForm
from sevenbar.description.schema import TABLES, LinkageForm, TomlSchema, json_schema
from sevenbar.design.task.file.schema import MUSTS, WANTS, LimitsForm, TaskForm
from sevenbar.design.task.wants.pose_form import PoseForm

#: Where the JSON schema is written, below the pages' folder; pages link it from there.
SCHEMA = "_made/sevenbar.description.schema.json"

#: What JSON calls the values, in words.
KINDS = {
    "boolean": "true or false",
    "number": "number",
    "integer": "whole number",
    "string": "text",
    "object": "table",
    "array": "rows",
}


#: The forms of tables that only a file with links by name has.
NAMED = {"pin": PinForm, "net_rod": NetRodForm, "net_point": NetPointForm}


def keys_of(_pages: Path, head: str) -> str:
    """A table of the keys of `[head]`, of the whole file without one."""
    if head in NAMED:
        return _table(NAMED[head].model_json_schema(schema_generator=TomlSchema))
    schema = json_schema()
    form = TABLES[head] if head else LinkageForm
    return _table(schema["$defs"][form.__name__] if head else schema)


def task_keys_of(_pages: Path, head: str) -> str:
    """A table of the keys of a task file, of its `limits`, of a `pose`, or of a want or must: `must_cone`."""
    forms = {f"want_{kind}": form for kind, form in WANTS.items()}
    forms |= {f"must_{kind}": form for kind, form in MUSTS.items()}
    form = (forms | {"": TaskForm, "limits": LimitsForm, "pose": PoseForm})[head]
    return _table(form.model_json_schema(schema_generator=TomlSchema))


def _table(described: dict[str, Any]) -> str:
    required = described.get("required", [])
    rows = [
        (code(name), _allowed(key), key.get("unit", ""), _default(name, key, required), key["description"])
        for name, key in described["properties"].items()
    ]
    return table(("key", "value", "unit", "left out", "meaning"), rows)


def _default(name: str, key: dict[str, Any], required: list[str]) -> str:
    if name in required:
        return "required"
    return code(json.dumps(key["default"])) if "default" in key else ""


def _allowed(key: dict[str, Any]) -> str:
    """What a value may be, in words."""
    if "const" in key:
        return code(str(key["const"]))
    if "enum" in key:
        return " ".join(code(f'"{word}"') for word in key["enum"])
    if "$ref" in key:
        return "table"
    if "allOf" in key:  # so pydantic 2.8 writes a table that has a description of its own
        return " and ".join(map(_allowed, key["allOf"]))
    if "anyOf" in key:
        return " or ".join(map(_allowed, key["anyOf"]))
    if key["type"] == "array":
        return _listed(key)
    limits = {"exclusiveMinimum": " > ", "minimum": " >= "}
    bound = next((f"{sign}{key[limit]:g}" for limit, sign in limits.items() if limit in key), "")
    first, *others = key["type"] if isinstance(key["type"], list) else [key["type"]]
    return " or ".join([KINDS[first] + bound, *(KINDS[kind] for kind in others)])


def _listed(key: dict[str, Any]) -> str:
    items = key.get("prefixItems")
    if items is None:
        kind = key.get("items", {})
        return "names" if kind.get("type") == "string" else "tables" if kind else "rows"
    inner = items[0]
    if inner["type"] == "array":
        return f"{len(items)} times {_listed(inner)}"
    return f"{len(items)} {'names' if inner['type'] == 'string' else 'numbers'}"


def written_schema(pages: Path, _: str) -> str:
    """Writes the JSON schema beside the pages; a link to it."""
    target = pages / SCHEMA
    target.parent.mkdir(exist_ok=True)
    target.write_text(json.dumps(json_schema(), indent=2) + "\n", encoding="utf-8")
    return f"Download: [sevenbar.description.schema.json]({SCHEMA})"
