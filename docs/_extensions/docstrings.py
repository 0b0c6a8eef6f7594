"""Docstrings as this project writes them, for Sphinx."""

import dataclasses
import inspect
import re
from collections.abc import Mapping
from typing import Any

from sphinx.application import Sphinx
from sphinx.util.inspect import stringify_signature

import sevenbar as sb

#: What stands in these docstrings in plain text and means something else to reStructuredText: bars of
#: lengths, stars of patterns, trailing underscores. Code in backticks is left as it is.
_CODE = re.compile(r"(`+[^`]+`+)")
_MARKS = re.compile(r"([|*_\\])")

_SOURCE = re.compile(r"^Source: ", re.MULTILINE)

#: A word of an annotation, not one of a text in it.
_WORD = re.compile(r"(?<!['\"\w-])[A-Za-z_][\w.]*(?!['\"\w-])")

_PAGE = re.compile(r"docs/(\w+)\.md")


def _plain(line: str) -> str:
    """A line of prose for reStructuredText."""
    parts = _CODE.split(line)
    parts[::2] = [_PAGE.sub(r":doc:`/\1`", _MARKS.sub(r"\\\1", part)) for part in parts[::2]]
    return _SOURCE.sub("*Source:* ", "".join(parts))


def _written(_app: Sphinx, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """The docstring's prose without marks that are none; its examples at the left edge."""
    example = False
    for index, line in enumerate(lines):
        if line.lstrip().startswith(">>>"):
            example = True
        elif not line.strip():
            example = False
        lines[index] = line.strip() if example else _plain(line)


def _signature(_app: Sphinx, what: str, _name: str, obj: Any, *_: Any) -> tuple[str, str | None] | None:
    """The types as they are written; none for a class of values, whose fields stand below it."""
    if what == "class" and dataclasses.is_dataclass(obj):
        return "", None
    if what not in ("function", "method"):
        return None
    signature = inspect.signature(obj)
    known = {name: getattr(sb, name) for name in sb.__all__} | getattr(obj, "__globals__", {})
    parameters = [
        parameter.replace(annotation=_linked(parameter.annotation, known))
        for name, parameter in signature.parameters.items()
        if name != "self"
    ]
    shown_signature = inspect.Signature(
        parameters, return_annotation=_linked(signature.return_annotation, known)
    )
    arguments, _, result = stringify_signature(shown_signature).rpartition(" -> ")
    return arguments, result


def _linked(annotation: Any, known: Mapping[str, Any]) -> Any:
    """An annotation with each of our classes by its full name, `~` before it, and NumPy's without theirs."""

    def full(word: re.Match[str]) -> str:
        found = known.get(word[0])
        if inspect.isclass(found) and found.__module__.startswith("sevenbar."):
            return f"~{found.__module__}.{found.__qualname__}"
        return word[0].removeprefix("npt.").removeprefix("np.")

    return _WORD.sub(full, annotation) if isinstance(annotation, str) else annotation


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.connect("autodoc-process-docstring", _written)
    app.connect("autodoc-process-signature", _signature)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
