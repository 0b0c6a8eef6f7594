"""Whether libraries are there, before a line says that they are put to work."""

from __future__ import annotations

from importlib.util import find_spec


def installed(*packages: str) -> bool:
    """Whether all of these can be imported; none is.

    >>> installed("json"), installed("json", "no_such_package")
    (True, False)
    """
    return all(map(_is_there, packages))


def _is_there(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ValueError:
        # one that was shut out
        return False
