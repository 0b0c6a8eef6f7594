"""Linkages that come with Sevenbar, single loops and nets, each a TOML file that names its source."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from functools import cache
from pathlib import Path

#: Names that a message offers for one that does not exist.
MOST_OFFERED = 3

_FOLDER = Path(__file__).with_name("gallery")


#: Of `_FOLDER`: linkages of several loops; all others are single loops.
_NETS = "nets"


@cache
def loops() -> tuple[str, ...]:
    """The names of the single loops of the gallery, in alphabetic order.

    >>> len(loops()), loops()[0]
    (23, 'bennett')
    """
    return _stems(_FOLDER)


@cache
def nets() -> tuple[str, ...]:
    """The names of the linkages of several loops in the gallery, in alphabetic order.

    >>> len(nets()), nets()[-1]
    (10, 'watt')
    """
    return _stems(_FOLDER / _NETS)


def names() -> tuple[str, ...]:
    """The names of all linkages of the gallery: the loops, then the nets."""
    return (*loops(), *nets())


def _stems(folder: Path) -> tuple[str, ...]:
    return tuple(sorted(file.stem for file in folder.glob("*.toml")))


def title(name: str) -> str:
    """What a linkage of the gallery is called.

    >>> title("bennett")
    'Bennett linkage'
    """
    return str(tomllib.loads(text(name))["name"])


def nearest(word: str, others: Iterable[str] = ()) -> tuple[str, ...]:
    """The names most like a word, best first, at most three: of the gallery and of `others` (file names).

    A name of the gallery also counts where its title has the word.

        >>> nearest("Seven-R")
        ('seven_r',)
        >>> nearest("7R")
        ('seven_r',)
    """
    # of words that are wrong only
    from difflib import get_close_matches

    plain = {_plain(name): name for name in (*names(), *others)}
    sought = _plain(word[:100])
    if not sought:
        return ()
    if sought in plain:
        return (plain[sought],)
    near = get_close_matches(sought, plain, n=MOST_OFFERED, cutoff=0.7)
    if len(sought) > 1:
        near += [name for name in plain if sought in name or name in sought]
    result = [plain[name] for name in near]
    if not result:
        result = [name for name in names() if sought in map(_plain, title(name).split())]
    return tuple(dict.fromkeys(result))[:MOST_OFFERED]


def _plain(name: str) -> str:
    """A name without what people leave out or write otherwise: case, `_`, `-`, spaces, the ending."""
    return re.sub(r"[\W_]", "", name.lower().removesuffix(".toml"))


def text(name: str) -> str:
    """The TOML text of a linkage of the gallery."""
    folder = _FOLDER / _NETS if name in nets() else _FOLDER
    return (folder / f"{name}.toml").read_text(encoding="utf-8")
