"""What is worked out once for a circuit or a loop, and kept as long as that lives."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

P = ParamSpec("P")
T = TypeVar("T")


def once_for(place: int) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """A function whose result is kept for its argument at this place, which must not be in the result."""

    def kept(function: Callable[P, T]) -> Callable[P, T]:
        results: WeakKeyDictionary[Any, T] = WeakKeyDictionary()

        @wraps(function)
        def found(*given: P.args, **named: P.kwargs) -> T:
            owner = given[place]
            if owner not in results:
                results[owner] = function(*given, **named)
            return results[owner]

        return found

    return kept
