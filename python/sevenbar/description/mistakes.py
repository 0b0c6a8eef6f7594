"""What is wrong with a file, in the words that people read: pydantic's errors with their places."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from pydantic_core import ErrorDetails

from sevenbar.description.not_covered import not_covered
from sevenbar.description.values import EXAMPLE_OF_AXES, TableForm
from sevenbar.errors import Problem, bare, shown, suggestion

#: What pydantic adds to the keys and numbers of a place.
_NO_PLACE = ("tuple",)

#: What leads to the unknown keys of a table that lacks one.
NOT_KNOWN = "; not known here: "

#: What to say of the key `value` in rows.
ROW_READS = "is of joints as drawn; a row reads its own angle, or offset of P, so leave it out"

#: Other names that people give the ends of a stop, and what to say of them.
STOP_ENDS = ("limits", "limit", "ends", "between", "min", "max", "low", "high")
RANGE = "is not known here; give range = [low, high]"

#: What to say of `input` above all tables or in [drive].
INPUT = "is not known here; the input is the joint of [drive]: write joint = .. below that head"


@dataclass(frozen=True)
class FileForms:
    """The forms of a kind of file: of the `whole`, and of each table by its head without brackets.

    Tables in `once` are written `[head]`, others `[[head]]`. `kinds` has the forms of tables whose key `kind`
    decides, by their heads and kinds.
    """

    whole: type[TableForm]
    tables: Mapping[str, type[TableForm]]
    once: tuple[str, ...]
    kinds: Mapping[str, Mapping[str, type[TableForm]]] = field(default_factory=dict)

    def problem(self, detail: ErrorDetails, besides: Sequence[str] = ()) -> Problem:
        """What an error says, and where; `besides` are unknown keys of a table that lacks one."""
        location = [part for part in detail["loc"] if part not in _NO_PLACE]
        owner = self._form_at(location[:-1])
        if location and location[0] in self.kinds and len(location) > 2:
            # pydantic names the kind after the number of the table
            owner = self.kinds[str(location[0])].get(str(location[2])) if len(location) == 4 else None
            del location[2]
        value = shown(detail["input"])
        keys = ", ".join(owner.model_fields) if owner else ""
        match detail["type"]:
            case "sevenbar":
                message = str(detail["ctx"]["message"])
            case "missing":
                message = _missing(location, owner)
                message += f"{NOT_KNOWN}{', '.join(map(bare, besides))}" if besides else ""
            case "extra_forbidden":
                near = suggestion(str(location[-1]), owner.model_fields if owner else ())
                home = not_covered(location[-1], of_joint=location[0] == "joint" and len(location) > 1)
                home = home or ROW_READS * (location[0] == "link" and location[-1] == "value")
                home = home or RANGE * (location[0] == "stop" and location[-1] in STOP_ENDS)
                if "drive" in self.tables and location in (["input"], ["drive", "input"]):
                    home = INPUT
                home = home or ("" if near else self._home(str(location[-1])))
                message = home or f"is not known here; {near}allowed: {keys}"
            case "literal_error" | "int_parsing_size":
                message = f"{value} is not a format of this version; give format = 1"
            case "union_tag_invalid" | "union_tag_not_found":
                message = self._kind(str(location[0]), detail["input"])
                location.append("kind")
            case "model_type" if isinstance(detail["input"], list) and location[-1] in self.once:
                message = f"{value} is a list; write [{location[-1]}], once"
            case "model_type" | "dict_type" | "model_attributes_type":
                message = f"{value} is not a table; give keys with values"
            case "tuple_type" | "too_short" | "too_long":
                message = f"{value} does not fit here; {_array_hint(location)}"
            case "int_type" | "int_from_float" | "greater_than_equal":
                message = f"{value} is not a link; give its number, counted from 1"
            case "bool_type" | "bool_parsing":
                message = f"{value} is neither true nor false; give one of the two, without quotes"
            case _:
                message = f"{value} is not allowed; {detail['msg'].lower()}"
        return Problem(path_of(location), message)

    def _form_at(self, location: Sequence[int | str]) -> type[TableForm] | None:
        """The form that owns a place: the file's own, or that of the table that the path enters."""
        words = [part for part in location if isinstance(part, str)]
        if not words:
            return self.whole
        return self.tables.get(words[0]) if len(words) == 1 else None

    def _kind(self, head: str, table: object) -> str:
        """What is wrong with the key that decides what a table is."""
        known = self.kinds[head]
        given = table.get("kind") if isinstance(table, Mapping) else None
        what = "is missing; " if given is None else f"{shown(given)} is none; {suggestion(given, known)}"
        return f"{what}give one of {', '.join(known)}"

    def _home(self, key: str) -> str:
        """Where a misplaced key belongs, if it can belong to one place only."""
        homes = [table for table, form in self.tables.items() if key in form.model_fields]
        if key in self.whole.model_fields and not homes:
            return "is a key of the whole file; write it above the first table"
        if len(homes) != 1 or key in self.whole.model_fields:
            return ""
        (table,) = homes
        head = f"[{table}]" if table in self.once else f"[[{table}]]"
        return f"is a key of {head}; write it below that head"


def with_unknown(
    details: Sequence[ErrorDetails], is_known: Callable[[ErrorDetails], object]
) -> list[tuple[ErrorDetails, list[str]]]:
    """Errors, each with the unknown keys of its table that are no errors of their own.

    What is unknown in a table that lacks a key was most often written in its place: both are one mistake.
    Unknown keys for which `is_known` has words remain. The first key that is missing names all needed ones.
    """
    lacking = {detail["loc"][:-1]: detail for detail in reversed(details) if detail["type"] == "missing"}
    lacking.pop((), None)
    unknown: dict[int, list[str]] = {id(detail): [] for detail in details}
    remaining = []
    for detail in details:
        owner = lacking.get(detail["loc"][:-1])
        if owner is not None and detail["type"] == "extra_forbidden" and not is_known(detail):
            unknown[id(owner)].append(str(detail["loc"][-1]))
        elif detail["type"] != "missing" or owner in (None, detail):
            remaining.append(detail)
    return [(detail, unknown[id(detail)]) for detail in remaining]


def path_of(location: Sequence[int | str]) -> str:
    """A place in a file as messages have it: `joint[2].at`."""
    path = ""
    for part in location:
        path += f"[{part + 1}]" if isinstance(part, int) else f".{bare(part)}"
    return path.lstrip(".")


def _missing(location: list[int | str], owner: type[TableForm] | None) -> str:
    if location[-1] == "format":
        return "is missing; give format = 1"
    if isinstance(location[-1], int):
        return f"is missing; {_array_hint(location[:-1])}"
    needed = [name for name, field in owner.model_fields.items() if field.is_required()] if owner else []
    return f"is missing; needed here: {', '.join(needed)}"


def _array_hint(location: list[int | str]) -> str:
    if location and location[-1] == "axes":
        return f"give two directions, {EXAMPLE_OF_AXES}"
    return f"write [[{location[-1] if location else 'joint'}]] before each one"
