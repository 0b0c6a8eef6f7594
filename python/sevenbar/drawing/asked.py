"""Choices for figures: parts of a path, and the style and the view that a person chose for all of a call."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

#: What a figure of a path can show: the path alone, with arrows of either rate, and the speed over the input.
PATH_PARTS = ("path", "velocity", "acceleration", "speed")

_style: ContextVar[str | None] = ContextVar("style", default=None)
_view: ContextVar[str | tuple[float, float] | None] = ContextVar("view", default=None)


@contextmanager
def drawn_as(*, style: str | None = None, view: str | tuple[float, float] | None = None) -> Iterator[None]:
    """Figures that are drawn within have this style and this view unless they are given their own."""
    tokens = _style.set(style or _style.get()), _view.set(view or _view.get())
    try:
        yield
    finally:
        _style.reset(tokens[0])
        _view.reset(tokens[1])


def asked_style() -> str | None:
    """The style chosen for all figures, if one is."""
    return _style.get()


def asked_view() -> str | tuple[float, float] | None:
    """The view chosen for all figures, if one is."""
    return _view.get()
