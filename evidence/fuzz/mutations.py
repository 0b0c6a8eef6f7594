"""Mutated TOML: a right file as tokens, edited a few times as slips, programs and malice do."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

from sevenbar.description.gallery import loops, text

#: A token: a comment, a text, a number, a word, a line's end, blanks, or any other character.
_TOKEN = re.compile(
    r'#[^\n]*|"[^"\n]*"|[-+]?\d[\d_]*\.?\d*(?:[eE][-+]?\d+)?|[A-Za-z_][\w-]*|\n|[ \t]+|\[\[|\]\]|.', re.DOTALL
)
_NUMBER = re.compile(r"[-+]?\d")

#: Edits of one file at most.
MOST_EDITS = 4

#: The share of files that are edited as bytes too.
AS_BYTES = 0.1

#: Numbers at the ends of what a number can be.
EXTREMES = (
    "0", "-0.0", "1e308", "-1e308", "1e309", "1e-308", "1e-320", "5e-324", "nan", "-nan", "inf", "-inf",
    "+inf", "1e100", "1.0000000000000002e100", "1e-100", "9.9e-101", "1e50", "1e51", "1e-50",
    "9007199254740993", "-1", "1", "2", "13", "180", "90", "360", "1" + "0" * 99, "1" + "0" * 400,
    "9" * 5000, "0x7fffffffffffffff", "0b1", "0o17", "1_0", "1__0", "0001", "1.", ".5", "1e",
)  # fmt: skip

#: Values of another type than the one that stands there.
VALUES = (
    "true", "false", "[]", "{}", '""', "''", '" "', '"R"', '"S"', '"U"', '"C"', '"H"', '"P"', '"X"',
    '"ground"', '"ball joint"', '"10 mm"', '"60 rpm"', '"1 in/s"', '"0 rad/s"', '"1e400 rpm"',
    '"9e-400 rpm"', '"mm"', '"m"', '"ft"', '"deg"', '"rad"', '"furlong"', "[0, 0, 0]", "[1, 0, 0]",
    "[0, 0, 1]", "[1e-320, 0, 0]", "[1, 2]", "[1, 2, 3, 4]", "[[1, 0, 0], [0, 1, 0]]",
    "[[1, 0, 0], [1, 0, 0]]", "[[1, 0, 0]]", "[nan, 0, 0]", '["1", 0, 0]', "[true, 0, 0]", "1979-05-27",
    "07:32:00", "1979-05-27T07:32:00Z", "{x = 1}", "[{x = 1}, 2]", "'theta_1'", '"theta_2"', '"theta_7"',
    '"crank"', '"\\u0000"', '"\\n"', '"\\u202e"', '"{message}"', '"%s"', "[1, ]", "1 # 2",
    '"250 g"', '"3 N m"', '"40 N/mm"', '"1 N m/"', '"1 kg^"', '"kg"', '"rod"', '"point"', '"drawn"', '"link"',
    "[4, 5, 6, 0.1, 0.2, 0.3]", "[1, 1, 3, 0, 0, 0]", "[[0, 0], [30, 1]]", "[[0, 0], [0, 1]]",
    '"no.csv"', '"."',
)  # fmt: skip

#: Words that a key or a table may be taken for.
WORDS = (
    "format", "name", "length_unit", "angle_unit", "drive", "rssr", "joint", "link", "point", "kind", "at",
    "axis", "axes", "pitch", "length", "twist", "offset", "angle", "speed", "output", "input", "M", "N",
    "L1", "L2", "L3", "D", "ground", "Axis", "lenght", "a.b", '"a b"', "''", '"\u00e9"', "1", "__proto__",
    "model_config", "link.1", "constructor", "forces", "body", "load", "spring", "gravity", "mass_unit",
    "mass", "centre", "inertia", "solid", "force", "torque", "between", "table", "links", "stiffness",
    "damping", "free",
)  # fmt: skip

#: Characters that texts of other programs and languages bring.
STRANGE = (
    "\x00\x07\x1b\x7f\u0085\u00a0\u00b0\u00df\u0130\u200b\u2028\u202e\u4e2d\ufeff\ufffd\U0001f600"
    "\r\t,;:'"
    '"\\{}[]=#.-+eE'
)

Edit = Callable[[random.Random, list[str]], None]


def seeds() -> list[list[str]]:
    """The tokens of each file to begin with: the gallery without comments, the least of each form."""
    texts = [re.sub(r"^#.*\n", "", text(name), flags=re.MULTILINE) for name in loops()]
    return [_TOKEN.findall(content) for content in (*texts, *LEAST * LEAST_TIMES)]


#: How often the least files stand beside the gallery: the shorter a file, the more of them a second.
LEAST_TIMES = 12

#: A small file of each form: most mutations of these still reach the checks between keys.
LEAST = (
    "format = 1\n[rssr]\nM = 7\nN = 7\nL1 = 2.5\nL3 = 5.5\nD = 0\n",
    'format = 1\n[drive]\nspeed = "60 rpm"\njoint = "theta_1"\n'
    + 2 * "[[link]]\nlength = 1\ntwist = 20\n[[link]]\nlength = 2\ntwist = 43.2\n",
    'format = 1\n[[joint]]\nkind = "R"\nat = [0, 0, 7]\naxis = [0, 0, 1]\n[[joint]]\nkind = "S"\n'
    'at = [2, 0, 7]\n[[joint]]\nkind = "S"\nat = [7, 5, 0]\n'
    '[[joint]]\nkind = "R"\nat = [7, 0, 0]\naxis = [1, 0, 0]\n'
    '[[point]]\nname = "P"\nlink = 2\nat = [1, 1, 1]\n',
    "format = 1\n[rssr]\nM = 7\nN = 7\nL1 = 2.5\nL3 = 5.5\nD = 0\n"
    '[forces]\ngravity = [0, 0, -9.8]\nmass_unit = "g"\n'
    "[[body]]\nlink = 1\nmass = 3\ncentre = [1, 0, 0]\ninertia = [4, 5, 6, 0, 0, 0]\n"
    '[[body]]\nlink = 2\nmass = "2 kg"\nsolid = "rod"\n'
    '[[load]]\nlink = 3\nat = [0, 0, 0]\nforce = [0, 0, "1 kN"]\nbetween = [30, 90]\n'
    '[[load]]\nlink = 1\ntorque = [0, 0, 1]\naxes = "link"\ntable = [[0, 0], [30, 1]]\n'
    "[[spring]]\nlinks = [1, 4]\nat = [[0, 0, 0], [1, 2, 3]]\nstiffness = 0.3\nlength = 2\n"
    '[[spring]]\njoint = "rocker"\nstiffness = "2 N m/rad"\nfree = 20\ndamping = 0.1\n',
    'format = 1\nlength_unit = "in"\nangle_unit = "rad"\n[[joint]]\nkind = "C"\nat = [0, 0, 0]\n'
    "axis = [0, 0, 1]\n"
    '[[joint]]\nkind = "U"\nat = [1, 0, 0]\naxes = [[1, 0, 0], [0, 1, 0]]\n'
    '[[joint]]\nkind = "H"\nat = [0, 2, 0]\naxis = [0, 1, 0]\npitch = 3\n'
    '[[joint]]\nkind = "P"\nat = [0, 2, 5]\naxis = [1, 1, 0]\n'
    '[[joint]]\nkind = "R"\nat = [1, 2, 3]\naxis = [1, 1, 2]\n',
)


def mutated(rng: random.Random, files: list[list[str]]) -> bytes | str:
    """A file with some edits: a text, or bytes, which need not be text."""
    tokens = list(rng.choice(files))
    for _ in range(rng.randint(1, MOST_EDITS)):
        if tokens:
            _choose(rng, EDITS)(rng, tokens)
        if rng.random() < SPLICED:
            _splice(rng, tokens, rng.choice(files))
    content = "".join(tokens)
    return _bytes(rng, content) if rng.random() < AS_BYTES else content


def _choose(rng: random.Random, edits: tuple[Edit, ...]) -> Edit:
    return edits[int(rng.random() * len(edits))]


def _place(rng: random.Random, tokens: list[str]) -> int:
    return int(rng.random() * len(tokens))


def _from(rng: random.Random, tokens: list[str], fits: Callable[[str], object]) -> int:
    """The first token of a kind at or after a random place; that place itself where there is none."""
    start = _place(rng, tokens)
    for place in (*range(start, len(tokens)), *range(start)):
        if fits(tokens[place]):
            return place
    return start


def _number_to_extreme(rng: random.Random, tokens: list[str]) -> None:
    tokens[_from(rng, tokens, _NUMBER.match)] = rng.choice(EXTREMES)


def _number_nudged(rng: random.Random, tokens: list[str]) -> None:
    place = _from(rng, tokens, _NUMBER.match)
    try:
        value = float(tokens[place])
    except ValueError:
        return
    tokens[place] = repr(
        rng.choice((-value, value * 1e3, value * (1 + 1e-9), value + 1, float(f"{value:.0f}"), value / 3))
    )


def _value_of_another_type(rng: random.Random, tokens: list[str]) -> None:
    tokens[_from(rng, tokens, lambda t: _NUMBER.match(t) or t.startswith('"'))] = rng.choice(VALUES)


def _key_renamed(rng: random.Random, tokens: list[str]) -> None:
    tokens[_from(rng, tokens, lambda t: t[0].isalpha())] = rng.choice(WORDS)


def _line_dropped(rng: random.Random, tokens: list[str]) -> None:
    first, last = _line(rng, tokens)
    del tokens[first:last]


def _line_repeated(rng: random.Random, tokens: list[str]) -> None:
    first, last = _line(rng, tokens)
    tokens[last:last] = tokens[first:last] * rng.choice((1, 1, 1, 2, 20))


def _lines_swapped(rng: random.Random, tokens: list[str]) -> None:
    first, last = _line(rng, tokens)
    moved = tokens[first:last]
    del tokens[first:last]
    if tokens:
        to = _line(rng, tokens)[0]
        tokens[to:to] = moved


def _line(rng: random.Random, tokens: list[str]) -> tuple[int, int]:
    last = first = _place(rng, tokens)
    while first > 0 and tokens[first - 1] != "\n":
        first -= 1
    while last < len(tokens) and tokens[last] != "\n":
        last += 1
    return first, last + 1


def _tokens_dropped(rng: random.Random, tokens: list[str]) -> None:
    place = _place(rng, tokens)
    del tokens[place : place + rng.randint(1, 6)]


def _tokens_repeated(rng: random.Random, tokens: list[str]) -> None:
    place = _place(rng, tokens)
    tokens[place:place] = tokens[place : place + rng.randint(1, 30)] * rng.choice((1, 1, 3))


def _strange_character(rng: random.Random, tokens: list[str]) -> None:
    place = _place(rng, tokens)
    token = tokens[place]
    inside = rng.randint(0, len(token))
    tokens[place] = token[:inside] + rng.choice(STRANGE) * rng.choice((1, 1, 1, 3)) + token[inside:]


def _nested(rng: random.Random, tokens: list[str]) -> None:
    depth = rng.choice((2, 5, 50, 400, 900))
    opened, closed = rng.choice((("[", "]"), ("{a = ", "}"), ("[\n", "\n]")))
    place = _from(rng, tokens, lambda t: _NUMBER.match(t) or t.startswith('"'))
    tokens[place] = opened * depth + tokens[place] + closed * rng.choice((depth, depth, depth - 1))


def _dotted(rng: random.Random, tokens: list[str]) -> None:
    place = _from(rng, tokens, lambda t: t[0].isalpha())
    tokens[place] = ".".join([tokens[place]] * rng.choice((2, 3, 300)))


def _head_changed(rng: random.Random, tokens: list[str]) -> None:
    head = rng.choice(
        (
            "[rssr]",
            "[[rssr]]",
            "[joint]",
            "[[joint]]",
            "[link]",
            "[[link]]",
            "[point]",
            "[[point]]",
            "[forces]",
            "[[forces]]",
            "[body]",
            "[[body]]",
            "[[load]]",
            "[[spring]]",
            "[drive]",
            "[[drive]]",
        )
    )
    first, last = _line(rng, tokens)
    tokens[first:last] = [head, "\n"]


#: Kinds of edits, those that leave the file TOML more often than the others.
EDITS: tuple[Edit, ...] = (
    *(_number_to_extreme,) * 5,
    *(_number_nudged,) * 4,
    *(_value_of_another_type,) * 4,
    *(_key_renamed,) * 3,
    *(_line_dropped,) * 2,
    _line_repeated,
    _lines_swapped,
    _tokens_dropped,
    _tokens_repeated,
    _strange_character,
    _nested,
    _dotted,
    _head_changed,
)

#: The share of edits beside which a piece of another file is brought in.
SPLICED = 0.08


def _splice(rng: random.Random, tokens: list[str], other: list[str]) -> None:
    start = _place(rng, other)
    place = rng.randint(0, len(tokens))
    tokens[place:place] = other[start : start + rng.randint(1, 60)]


def _bytes(rng: random.Random, content: str) -> bytes:
    data = bytearray(content.encode("utf-8", "surrogatepass"))
    for _ in range(rng.randint(1, 3)):
        if not data:
            break
        place = rng.randrange(len(data))
        match rng.randint(0, 3):
            case 0:
                data[place] = rng.randrange(256)
            case 1:
                data[place] ^= 1 << rng.randrange(8)
            case 2:
                del data[place : place + rng.randint(1, 40)]
            case _:
                data[place:place] = rng.choice(
                    (b"\xff\xfe", b"\xef\xbb\xbf", b"\x00", b"\r\n", b"\xc3", b"\xed\xa0\x80")
                )
    return bytes(data)
