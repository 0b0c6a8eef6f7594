"""The mistakes a caller can make. Every one derives from `SevenbarError` and says what to do."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import date, time
from functools import wraps
from pathlib import Path
from typing import ParamSpec, TypeGuard, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class SevenbarError(Exception):
    """A mistake of the caller; its text names the place, the value and what is allowed."""


class RequestError(SevenbarError, ValueError):
    """An argument that a function cannot take."""


class NotCoveredError(SevenbarError):
    """A linkage that is well described but that this version does not analyse."""


class TableError(SevenbarError):
    """A text table, of measured values or of an input law: the file, the line, and what is wrong there."""


class OutputError(SevenbarError):
    """A file or folder that cannot be written; nothing was changed."""


class MissingExtraError(SevenbarError, ImportError):
    """An optional package that is needed but not installed."""


class EngineError(SevenbarError):
    """A motion that another program could not follow; the text says what to try."""


def ends_here(public: Callable[P, T]) -> Callable[P, T]:
    """A public function whose mistakes of the caller have a traceback that ends at the call.

    What lies below is of no use to the caller: the message has the place, the value and what to do. Faults
    of the program keep their traceback.
    """

    @wraps(public)
    def call(*given: P.args, **named: P.kwargs) -> T:
        try:
            return public(*given, **named)
        except SevenbarError as error:
            raise error.with_traceback(None) from None

    return call


class AngleUnitWarning(UserWarning):
    """Angles that may have been written in another unit; the answer takes them as they are."""


class MissingFontWarning(UserWarning):
    """No font has the characters of a language, so figures are in English."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong in a description: its place and what is the matter."""

    place: str
    message: str

    def __str__(self) -> str:
        return f"{self.place}: {self.message}" if self.place else self.message


#: Letters of the longest path that a system has.
LONGEST_PATH = 4_096

#: Letters of the longest name.
LONGEST_NAME = 200

#: What to give for a name.
NAME_TO_GIVE = f"printable text in quotes, at most {LONGEST_NAME} characters"

#: Mistakes that one message lists; more of them come from a program, and all from one cause.
MOST_LISTED = 50


class DescriptionError(SevenbarError):
    """A linkage description with mistakes: all of them in `problems`, the first `MOST_LISTED` in the text."""

    def __init__(self, problems: Sequence[Problem], source: str = "") -> None:
        self.problems = tuple(problems)
        self.source = source
        prefix = f"{source}: " if source else ""
        lines = [f"{prefix}{problem}" for problem in self.problems[:MOST_LISTED]]
        if (more := len(self.problems) - MOST_LISTED) > 0:
            lines.append(f"{prefix}and {more} more mistake{'s' * (more > 1)}; mend these first")
        super().__init__("\n".join(lines))

    @classmethod
    def of_all(cls, source: str, message: str) -> DescriptionError:
        """The error of a source as a whole, not of a place in it."""
        return cls([Problem("", message)], source)


def read_start(
    path: Path,
    most: int,
    what: str,
    refuse: Callable[[str], Exception],
    missing: Callable[[], str] | None = None,
) -> bytes:
    """The bytes of a file that should be `what`, at most so many; `refuse` makes the error of another.

    `missing` says what to do where there is no such file, in place of giving the path of one.
    """
    give = f"give the path of {what}"
    try:
        with path.open("rb") as file:
            return file.read(most)
    except FileNotFoundError:
        raise refuse(f"no such file; {missing() if missing else give}") from None
    except IsADirectoryError:
        raise refuse(f"is a folder; {give} in it") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise refuse(f"cannot be read: {reason.lower()}; {give}") from None


@contextmanager
def of_extra(extra: str, needs: str, otherwise: str = "") -> Iterator[None]:
    """Imports within are of an extra; `MissingExtraError` where one is missing, with what `needs` what."""
    try:
        yield
    except ImportError:
        them = "them" if " and " in needs else "it"
        raise MissingExtraError(
            f"{needs}; install {them} with: pip install 'sevenbar[{extra}]'{otherwise}"
        ) from None


def shown(value: object, longest: int = 60) -> str:
    """A value as it is quoted in a message: its repr, a date or time as a file has it; cut short."""
    try:
        text = str(value) if isinstance(value, date | time) else repr(value)
    except (RecursionError, ValueError):  # nested without end; an integer too long to print
        text = f"{'a number' if isinstance(value, int) else 'a value'} too large to print"
    if "\n" in text:  # of what prints itself in several lines
        text = " ".join(text.split())
    return text if len(text) <= longest else text[: longest - 3] + "..."


def bare(word: str) -> str:
    """A word as a message shows it without quotes: cut short, characters that are not printed escaped."""
    return word if word.isprintable() and len(word) <= 60 else shown(word)


def nearest(word: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """The known word near to a word, empty where none is; `cutoff` is the share of like letters.

    >>> nearest("crnak", ["crank", "rocker"])
    'crank'
    """
    # of words that are wrong only
    from difflib import get_close_matches

    lowered = {k.lower(): k for k in known}
    near = get_close_matches(word[:100].lower(), lowered, n=1, cutoff=cutoff)
    return lowered[near[0]] if near else ""


def suggestion(word: object, known: Iterable[str]) -> str:
    """`did you mean 'L1'? ` for a word near a known one, else nothing."""
    near = nearest(word, known) if isinstance(word, str) else ""
    return f"did you mean {shown(near)}? " if near else ""


def check_word(key: str, word: object, known: Iterable[str], what: str = "offered") -> None:
    """Raises `RequestError` for a word that is none of those `known`: it is not `what`.

    >>> check_word("measure", "rms", ("greatest", "rms"))
    """
    words = tuple(known)
    # an array is equal to no word, and to each in every place
    if not isinstance(word, str) or word not in words:
        *most, last = words
        listed = f"{', '.join(most)} or {last}" if most else last
        near = suggestion(word, [*most, last])
        raise RequestError(f"{key}: {shown(word)} is not {what}; {near}give {listed}")


def check_kind(key: str, value: object, kind: type | tuple[type, ...], what: str) -> None:
    """Raises `RequestError` for a value that is not of a kind: it is not `what`, with what to give.

    >>> check_kind("content", "format = 1", str, "a text; give one")
    """
    if not isinstance(value, kind):
        raise RequestError(f"{key}: {shown(value)} is not {what}")


def is_name(value: object) -> TypeGuard[str]:
    """Whether a value is a name: a text of `LONGEST_NAME` letters at most, all of them printable."""
    return (
        isinstance(value, str) and bool(value.strip()) and len(value) <= LONGEST_NAME and value.isprintable()
    )


def check_name(key: str, value: object, *, may_be_empty: bool = False) -> None:
    """Raises `RequestError` for what is no name.

    >>> check_name("name", "crank")
    """
    if not is_name(value) and not (may_be_empty and isinstance(value, str) and not value):
        raise RequestError(f"{key}: {shown(value)} is not a name; give {NAME_TO_GIVE}")


def given_path(key: str, value: str | os.PathLike[str]) -> Path:
    """The path that a caller gives, or `RequestError`."""
    check_kind(key, value, (str, os.PathLike), "a path; give that of a file")
    if len(str(value)) > LONGEST_PATH:
        raise RequestError(f"{key}: {shown(value)} is longer than any path; give that of a file")
    return Path(value)


def no_joint_but(name: str, joints: Sequence[str], of_link: Sequence[str] | None = None) -> str:
    """The message for a rod where a joint belongs, or for a link, of which some joints may be given.

    >>> no_joint_but("coupler", ["pin_2", "pin_3", "rocker"], of_link=["pin_2", "pin_3"])
    "'coupler' is a link; give one of its joints: pin_2, pin_3"
    """
    if of_link:
        return f"{shown(name)} is a link; give one of its joints: {', '.join(map(bare, of_link))}"
    what = "a rod, whose length stays" if of_link is None else "a link that balls and rods alone hold"
    return f"{shown(name)} is {what}; give a joint: {', '.join(map(bare, joints))}"


def no_joint(name: object, names: Sequence[str]) -> str:
    """The message for a joint that does not exist."""
    known = ", ".join(map(bare, names))
    # the first of a pin that has several hinges
    first = f"{name}.1" if isinstance(name, str) else None
    near = f"did you mean {shown(first)}? " if first in names else suggestion(name, names)
    return f"no joint {shown(name)}; {near}this linkage has {known}"
