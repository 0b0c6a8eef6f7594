"""How results print themselves: what it is, then what a person asks first; arrays by their shape.

What a result prints is written where its words are: `text_of` and `picture_of` take one function for each
kind, in the module that `SAID_IN` names for its folder, imported when the first one is printed.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping, Sized
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import singledispatch
from textwrap import wrap
from typing import Any

import numpy as np

from sevenbar.errors import SevenbarError, ends_here
from sevenbar.text.above import SAID_IN
from sevenbar.text.words import language

#: Characters of a line.
WIDTH = 100

#: Characters that a text has at least, after a label that leaves no room: a name may be longer than a line.
LEAST_WIDTH = 40

#: Dots an inch of a picture in a notebook.
DPI = 64


class Printed:
    """A result that prints itself in a few lines, in notebooks with a picture where one helps."""

    def __repr__(self) -> str:
        _import_words(self)
        with language("en"):
            return text_of(self)

    def _repr_html_(self) -> str:
        """The lines, and beside them the picture."""
        # only notebooks need these
        import io
        from base64 import b64encode
        from html import escape

        lines = f'<pre style="margin: 0">{escape(repr(self))}</pre>'
        # matplotlib may be missing, and some results have no pose
        with suppress(ImportError, SevenbarError):
            figure = picture_of(self)
            if figure is not None:
                file = io.BytesIO()
                figure.savefig(file, format="png", dpi=DPI)
                data = b64encode(file.getvalue()).decode("ascii")
                lines += f'<img alt="" src="data:image/png;base64,{data}">'
        return f'<div style="display: flex; gap: 1em; align-items: center">{lines}</div>'

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if not name.startswith("_")]


class Drawable(Printed):
    """A result with a figure of its own."""

    @ends_here
    def plot(self, **options: Any) -> Any:
        """Its figure, a matplotlib Figure, as `sevenbar.plot` draws it with these options.

        A linkage is drawn in space, a motion as the curves of its output; `kind` names another function of
        `sevenbar.plot` that takes it, as in `motion.plot(kind="joints")`.
        """
        _import_words(self)
        return figure_of(self, **options)


def _import_words(value: object) -> None:
    module = type(value).__module__
    for folder, words in SAID_IN.items():
        if module.startswith(f"{folder}."):
            importlib.import_module(words)
            return


@singledispatch
def text_of(value: Any) -> str:
    """The lines that a result prints: by default its fields."""
    listed = [(f.name, brief(getattr(value, f.name))) for f in fields(value) if f.repr]
    return lines(type(value).__name__, listed)


@singledispatch
def picture_of(value: object) -> Any:  # noqa: ARG001
    """A small matplotlib figure of a result; `None` where there is nothing to draw."""
    return None


@singledispatch
def figure_of(value: object, **options: Any) -> Any:
    """The figure of a result; what each kind has is registered where figures are known."""
    raise NotImplementedError(f"no figure of {type(value).__name__} with {options}")


def lines(head: str, facts: Iterable[tuple[str, str]]) -> str:
    """A head, and below it facts: labels and texts in two columns, long texts in several lines."""
    selected = [(label, text) for label, text in facts if text]
    left = max((len(label) for label, _ in selected), default=0)
    printed = [head]
    for label, text in selected:
        parts = wrap(text, max(WIDTH - left - 4, LEAST_WIDTH), break_long_words=False) or [""]
        printed.append(f"  {label:{left}}  {parts[0]}")
        printed += [f"  {'':{left}}  {part}" for part in parts[1:]]
    return "\n".join(printed)


def brief(value: object) -> str:
    """A value on one line: a vector by its numbers, an array by its shape, a result by its head."""
    if isinstance(value, np.ndarray):
        if value.shape == (3,):
            return f"({', '.join(f'{x + 0.0:.6g}' for x in value)})"
        return f"array {value.shape}"
    if isinstance(value, Printed):
        return repr(value).partition("\n")[0]
    if isinstance(value, float):
        return f"{value:.6g}"
    if is_dataclass(value) and hasattr(value, "name"):
        return str(value.name)
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {brief(item)}" for key, item in value.items())
    text = value if isinstance(value, str) else repr(value)
    if len(text) > WIDTH and isinstance(value, Sized):
        return f"{len(value)} of them"
    return text
