"""Linkage files in TOML, format 1: read whole, checked whole, every mistake named."""

from __future__ import annotations

import os
import re
import tomllib
from pathlib import Path

from sevenbar.description.forms import from_description
from sevenbar.description.gallery import names, nearest, text
from sevenbar.errors import DescriptionError, Problem, ends_here, shown
from sevenbar.kinematics.linkage import Linkage

#: A linkage has some dozen numbers; a larger file [bytes] or a longer line [characters] is something else,
#: and could keep the TOML reader busy for hours.
LARGEST_FILE = 100_000
LONGEST_LINE = 2_000


@ends_here
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


@ends_here
def loads(content: str, source: str = "text") -> Linkage:
    """The linkage described by a TOML text; `source` is its name in messages.

    >>> import sevenbar as sb
    >>> from sevenbar import gallery
    >>> sb.loads(gallery.text("bennett")).name
    'Bennett linkage'
    """
    for number, line in enumerate(content.splitlines(), 1):
        if len(line) > LONGEST_LINE:
            raise _unreadable(
                source, f"line {number} has {len(line)} characters; a linkage file has at most {LONGEST_LINE}"
            )
    try:
        raw = tomllib.loads(content)
    except ValueError as error:  # not TOML, or an integer of thousands of digits
        raise _unreadable(source, _told(error, content.split("\n"))) from None
    except RecursionError:
        raise _unreadable(source, "nested too deep; a linkage file has tables of plain keys only") from None
    return from_description(raw, source)


#: What TOML's reader says of a place.
_PLACE = re.compile(r"(.*) \(at (?:line (\d+), column \d+|end of document)\)")

#: Slips that people make in TOML, by how the line looks: a unit beside a number, a decimal comma, a text or
#: a sign of another language.
_SLIPS = (
    (
        re.compile(r"[^=]+=\s*[-+\d.]+\s*[A-Za-z\u00b0/]+.*"),
        "write a number without its unit, which length_unit and angle_unit tell for the whole file",
    ),
    (re.compile(r"[^=]+=\s*[-+]?\d+,\d+\s*(#.*)?"), "write a decimal point, as in 0.5"),
    (re.compile(r"\s*[A-Za-z_]\w*\s*=\s*[A-Za-z_][^\"']*"), 'write a text in quotes, as in kind = "R"'),
    (re.compile(r"\s*\w+\s*:.*"), "write a key and its value with '=', as in M = 700"),
    (re.compile(r"\s*\[+[^\]]*"), "close the head of a table, as in [rssr] or [[joint]]"),
)


def _told(error: ValueError, lines: list[str]) -> str:
    """What is wrong with a text that is not TOML: the line, the reader's words, and what to do."""
    match = _PLACE.fullmatch(str(error))
    example = "'sevenbar gallery rssr' prints a file that is right"
    if match is None:
        return f"not valid TOML: {str(error)[:200]}; {example}"
    reason = match[1][:1].lower() + match[1][1:200]
    if match[2] is None:
        return f"not valid TOML: {reason}, at the end of the file; {example}"
    line = lines[int(match[2]) - 1]
    if reason.startswith(("cannot overwrite", "cannot declare")):
        return f"line {match[2]}: {shown(line.strip())} stands twice; leave one of them out"
    remedy = next((told for slip, told in _SLIPS if slip.fullmatch(line)), example)
    return f"line {match[2]}: {shown(line.strip())} is not valid TOML: {reason}; {remedy}"


def _read(path: Path) -> str:
    place = str(path)
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise _unreadable(
            place,
            f"no such file; {_offer(path)}"
            "give the path of a TOML file, or a name that 'sevenbar gallery' lists",
        ) from None
    except IsADirectoryError:
        raise _unreadable(place, "is a folder; give the path of a TOML file in it") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise _unreadable(place, f"cannot be read: {reason.lower()}; give the path of a TOML file") from None
    return decoded(content, place)


def decoded(content: bytes, place: str) -> str:
    """The TOML text of a file's bytes; `place` is its name in messages. Raises as `load` does."""
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


def _offer(path: Path) -> str:
    """`did you mean 'rssr' or 'rsur'? `: files of the folder and names of the gallery, or nothing."""
    try:
        files = sorted(file.name for file in path.parent.glob("*.toml"))
    except (OSError, ValueError):  # a folder that may not be read; a path that cannot be
        files = []
    near = [f"'{path.with_name(name) if name in files else name}'" for name in nearest(path.name, files)]
    return f"did you mean {' or '.join(near)}? " if near else ""


def _unreadable(place: str, message: str) -> DescriptionError:
    return DescriptionError([Problem("", message)], place)
