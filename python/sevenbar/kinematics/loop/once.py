"""What is worked out once for a circuit or a loop, and kept as long as that lives."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

P = ParamSpec("P")
T = TypeVar("T")


def once_for(place: int, by: int | None = None) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """A function whose result is kept for its argument at this place, which must not be in the result.

    For each value of the argument at the place `by`, if that is given, one.
    """

    def kept(function: Callable[P, T]) -> Callable[P, T]:
        results: WeakKeyDictionary[Any, dict[Any, T]] = WeakKeyDictionary()

        @wraps(function)
        def found(*given: P.args, **named: P.kwargs) -> T:
            by_value = results.setdefault(given[place], {})
            value = None if by is None else given[by]
            if value not in by_value:
                by_value[value] = function(*given, **named)
            return by_value[value]

        return found

    return kept
