"""Standard output as it is: characters that its encoding lacks, and outputs that are full or closed."""

from __future__ import annotations

import codecs
import errno
import os
import sys
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import StringIO
from typing import Any

from sevenbar.errors import OutputError

#: What is written for a character that the encoding of an output lacks.
PLAIN = {
    "°": " deg", "±": "+-", "−": "-", "–": "-", "—": "-", "·": "*", "×": "x", "…": "...", "→": "->",
    "≤": "<=", "≥": ">=", "≈": "~", "≠": "!=", "∞": "inf", "√": "sqrt",
    "‘": "'", "’": "'", "“": '"', "”": '"',
    "µ": "u", "μ": "u", "α": "alpha", "β": "beta", "γ": "gamma", "θ": "theta", "φ": "phi", "ω": "omega",
    "；": "; ", "，": ", ", "：": ": ", "（": " (", "）": ")", "。": ".", "、": ", ",
    "•": "*",
}  # fmt: skip

#: Raised digits and signs: an exponent, `s^2`.
RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺", "0123456789-+", strict=True))

#: What an output raises that is full, broken or closed.
_NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF}

#: How the replacement is known to Python's encoders.
_NAME = "sevenbar.plain"


def plain_text(text: str) -> str:
    """A text in ASCII that reads well; `?` for a letter that has nothing like it.

    >>> plain_text("12.5° at 3 rad/s², R² ≤ 10⁻⁶, Schäfer")
    '12.5 deg at 3 rad/s^2, R^2 <= 10^-6, Schafer'
    """
    written, raised = [], False
    for letter in text:
        if letter in RAISED:
            written.append(("" if raised else "^") + RAISED[letter])
        elif letter.isascii():
            written.append(letter)
        else:
            written.append(PLAIN.get(letter) or _like(letter))
        raised = letter in RAISED
    return "".join(written)


def _like(letter: str) -> str:
    name = unicodedata.name(letter, "")
    if name.startswith("BOX DRAWINGS"):
        along = any(word in name for word in ("HORIZONTAL", "LEFT", "RIGHT"))
        return "+" if " AND " in name else "-" if along else "|"
    bare = unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode()
    return bare or "?"


def _replaced(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return plain_text(error.object[error.start : error.end]), error.end


@contextmanager
def safe_output() -> Iterator[None]:
    """Within it text is written in any encoding; what cannot be written at all is one `OutputError`."""
    _prepare()
    try:
        yield
    except OSError as error:
        # one of a file has the file's name
        if error.filename is None and error.errno in _NO_ROOM:
            _send_nowhere()
            raise _unwritable(_reason(error)) from None
        raise
    finally:
        # what is left to be written may not be
        if reason := _refused():
            raise _unwritable(reason) from None


def _prepare() -> None:
    codecs.register_error(_NAME, _replaced)
    if sys.stderr is None:
        sys.stderr = StringIO()
    if sys.stdout is None:
        raise OutputError("standard output: is closed; leave it open, or send it to a file or to /dev/null")
    for stream in (sys.stdout, sys.stderr):
        _write_plain(stream)
    # no width that anything fits into, as some terminals of CI have it
    if not os.environ.get("COLUMNS", "1").strip("0"):
        del os.environ["COLUMNS"]


def _write_plain(stream: Any) -> None:
    # of a StringIO nothing need be replaced
    if (reconfigure := getattr(stream, "reconfigure", None)) is not None:
        with suppress(LookupError, ValueError):
            reconfigure(errors=_NAME)


def _refused() -> str:
    """Why standard output takes no more, which then goes nowhere; empty where it does."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except BrokenPipeError:
        # whoever read it has enough
        _send_nowhere()
    except OSError as error:
        _send_nowhere()
        return _reason(error)
    return ""


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()


def _send_nowhere() -> None:
    """Or the interpreter would try once more at its end, and say so in its own words."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _unwritable(reason: str) -> OutputError:
    return OutputError(f"standard output: cannot be written: {reason}; make room, or send it elsewhere")
