"""What an error's message must be: place first, a line for each mistake, words for people; its family."""

from __future__ import annotations

import re

from evidence.fuzz.checks import hold
from sevenbar.errors import MOST_LISTED, DescriptionError, SevenbarError

#: A line of a message [characters]: a place, a value cut to 60, what is allowed, a remedy.
LONGEST_LINE = 700

#: Lines of one message at most: a file is refused for its first mistakes, not for thousands.
MOST_LINES = 100

#: What programs say to programmers.
_FOREIGN = re.compile(
    r"Traceback|object at 0x|NoneType|<class|Input should|validation error|[a-z]+_type\b|"
    r"Errno|\bdict\b|pydantic|panicked|unexpected keyword|not supported between|is not allowed;"
)

#: Parts of a message that are the file's own: quoted texts, places, numbers.
_QUOTED = re.compile(r"'(?:[^'\\]|\\.)*'|\"(?:[^\"\\]|\\.)*\"|\[[^\]]*\]|\{[^}]*\}")
_NUMBER = re.compile(r"[-+]?\d[\w.+]*")

#: A family's name [characters].
FAMILY = 64


def look_at(error: SevenbarError, source: str) -> None:
    """Raises `Broken` for a message that people cannot use."""
    text = str(error)
    lines = text.split("\n")
    hold(text.strip(), "an empty message")
    hold(len(lines) <= MOST_LINES, f"a message of {len(lines)} lines")
    for line in lines:
        hold(len(line) <= LONGEST_LINE, f"a line of {len(line)} characters in a message")
        hold(line.isprintable(), "a message with characters that are not printed")
        hold(not line.endswith("."), f"a full stop: {line[-60:]}")
        match = _FOREIGN.search(line)
        hold(match is None, f"words for programmers: {match[0] if match else ''}: {line[:200]}")
    if source:
        hold(all(line.startswith(f"{source}: ") for line in lines), "a line without the file's name")
        hold(all(len(line) > len(source) + 10 for line in lines), "a line that says nothing")
    if isinstance(error, DescriptionError):
        told = min(len(error.problems), MOST_LISTED + 1)
        hold(len(lines) == told, "a problem of more than one line")


def family(error: SevenbarError, source: str) -> str:
    """What all messages of one kind share: the first line without what is the caller's own."""
    line = str(error).split("\n")[0].removeprefix(f"{source}: ")
    # places lead, apart by colons
    line = re.sub(r"^(?:[\w\[\].' \\]{1,90}: )+", "", line) or line
    plain = _NUMBER.sub("~", _QUOTED.sub("~", line))
    return plain.split("; ")[0][:FAMILY]
