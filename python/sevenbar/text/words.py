"""The language of reports and figures: sentences are written in English, a catalogue has them in another."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path

from sevenbar.errors import RequestError, shown, suggestion

#: The languages by their codes, and what each calls itself.
LANGUAGES = {"en": "English", "zh": "中文"}

#: The part of a catalogue with sentences that are filled in before a language is chosen.
MADE_BEFORE = "made before"

_spoken: ContextVar[str] = ContextVar("language", default="en")

#: A place for a value, as `re.escape` leaves it in a sentence.
_PLACE = re.compile(r"\\\{(\w+)\\\}")


@contextmanager
def language(code: str | None) -> Iterator[None]:
    """Reports and figures that are made within are in a language, "en" or "zh"; `None` changes nothing.

    Names of joints and points, units, CSV and JSON stay as they are. Raises `RequestError` for another code.

        >>> import sevenbar as sb
        >>> with sb.language("zh"):
        ...     title = sb.report.markdown(sb.load("rssr").motion()).splitlines()[4]
        >>> title
        '- 驱动: crank，10 rad/s；输出 rocker'
    """
    token = _spoken.set(_spoken.get() if code is None else check_language(code))
    try:
        yield
    finally:
        _spoken.reset(token)


def check_language(code: str, key: str = "language") -> str:
    """The code of a language; raises `RequestError` for another."""
    if not isinstance(code, str) or code not in LANGUAGES:
        known = " or ".join(f"{each} ({name})" for each, name in LANGUAGES.items())
        raise RequestError(
            f"{key}: {shown(code)} is not offered; {suggestion(code, list(LANGUAGES))}give {known}"
        )
    return code


def spoken() -> str:
    """The code of the language that is spoken now."""
    return _spoken.get()


def say(sentence: str, /, **values: object) -> str:
    """A sentence in the language that is spoken, its places filled with values.

    >>> say("{count} circuits", count=3)
    '3 circuits'
    """
    result = catalogue(_spoken.get()).get(sentence, sentence)
    return result.format(**values) if values else result


def retold(text: str) -> str:
    """A text that was made in English, in the spoken language if its catalogue has the sentence.

    A sentence with values is recognised by what is between them.
    """
    known = catalogue(_spoken.get()).get(text)
    if known is not None:
        return known
    for pattern, translation in _patterns(_spoken.get()):
        if match := pattern.fullmatch(text):
            return translation.format(**match.groupdict())
    return text


def retold_parts(text: str, between: str) -> str:
    """`retold` for each part of a list."""
    return say(between).join(map(retold, text.split(between)))


@cache
def catalogue(code: str) -> Mapping[str, str]:
    """What each English sentence is in a language; empty for English."""
    return {sentence: text for part in _parts(code).values() for sentence, text in part.items()}


@cache
def _parts(code: str) -> Mapping[str, Mapping[str, str]]:
    if code == "en":
        return {}
    return tomllib.loads(Path(__file__).with_name(f"words_{code}.toml").read_text(encoding="utf-8"))


@cache
def _patterns(code: str) -> list[tuple[re.Pattern[str], str]]:
    """The sentences of `MADE_BEFORE`, each as a pattern with a group for each value."""
    return [
        (re.compile(_PLACE.sub(r"(?P<\1>.+?)", re.escape(sentence))), text)
        for sentence, text in _parts(code).get(MADE_BEFORE, {}).items()
    ]
