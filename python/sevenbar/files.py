"""Linkage files in TOML, format 1: read whole, checked whole, every mistake named."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

from sevenbar.errors import DescriptionError, Problem, suggestion
from sevenbar.forms import from_form
from sevenbar.gallery import names, text
from sevenbar.linkage import Linkage

#: A linkage has some dozen numbers; a larger file [bytes] or a longer line [characters] is something else,
#: and could keep the TOML reader busy for hours.
LARGEST_FILE = 100_000
LONGEST_LINE = 2_000


def load(source: str | os.PathLike[str]) -> Linkage:
    """The linkage of a TOML file, or of the gallery by its name.

    Raises `DescriptionError` with every problem of the file, each with its place, the value and what is
    allowed.

        >>> import sevenbar as sb
        >>> sb.load("rssr").kind
        'RSSR'
    """
    return loads(text_of(source), str(source))


def text_of(source: str | os.PathLike[str]) -> str:
    """The TOML text of a file, or of a linkage of the gallery by its name; raises as `load` does."""
    path = Path(source)
    if isinstance(source, str) and source in names() and not path.exists():
        return text(source)
    return _read(path)


def loads(content: str, source: str = "text") -> Linkage:
    """The linkage described by a TOML text; `source` is its name in messages."""
    from sevenbar import schema

    for number, line in enumerate(content.splitlines(), 1):
        if len(line) > LONGEST_LINE:
            raise _unreadable(
                source, f"line {number} has {len(line)} characters; a linkage file has at most {LONGEST_LINE}"
            )
    try:
        raw = tomllib.loads(content)
    except ValueError as error:  # not TOML, or an integer of thousands of digits
        raise _unreadable(
            source, f"not valid TOML: {str(error)[:200]}; see the examples for the form of a linkage file"
        ) from None
    except RecursionError:
        raise _unreadable(source, "nested too deep; a linkage file has tables of plain keys only") from None
    return from_form(schema.check(raw, source=source), source)


def _read(path: Path) -> str:
    place = str(path)
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        known = names()
        raise _unreadable(
            place,
            f"no such file; {suggestion(place, known)}"
            f"give the path of a TOML file or a gallery name: {', '.join(known)}",
        ) from None
    except IsADirectoryError:
        raise _unreadable(place, "is a folder; give the path of a TOML file in it") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _unreadable(place, f"cannot be read: {reason.lower()}; give the path of a TOML file") from None
    if len(content) > LARGEST_FILE:
        raise _unreadable(
            place, f"larger than {LARGEST_FILE} bytes, so it is no linkage file; give a TOML file of format 1"
        )
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise _unreadable(
            place, f"not text: byte {error.start} is not UTF-8; give a TOML file of format 1"
        ) from None


def _unreadable(place: str, message: str) -> DescriptionError:
    return DescriptionError([Problem("", message)], place)
