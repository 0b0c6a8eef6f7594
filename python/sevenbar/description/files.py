"""Linkage files, TOML of format 1 or tables: read whole, checked whole, every mistake named."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sevenbar.description.angle_doubts import warn_of_angles
from sevenbar.description.forms import from_description
from sevenbar.description.gallery import names, nearest, text
from sevenbar.errors import (
    DescriptionError,
    SevenbarError,
    check_kind,
    ends_here,
    given_path,
    read_start,
    shown,
)
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.encodings import wide_text
from sevenbar.text.paths import is_file, is_folder, is_there

if TYPE_CHECKING:
    from sevenbar.description.table_reader import TableDescription

#: Endings of files that are tables; any other file is a workbook by its content, or TOML.
TABLE_ENDINGS = (".csv", ".tsv", ".tab", ".xlsx", ".xlsm", ".xls")

#: A linkage has some dozen numbers; a larger file [bytes] or a longer line [characters] is something else,
#: and could keep the TOML reader busy for hours.
LARGEST_FILE = 100_000
LONGEST_LINE = 2_000

#: A workbook of a linkage [bytes] may hold more: formats, drawings, other sheets.
LARGEST_TABLE = 20_000_000


#: How files of other programs begin, and what to do with them.
_OTHER_KINDS = {
    b"MATLAB 5.0 MAT-file": "a MATLAB file; write the table as CSV, as in writetable(T, 'loop.csv')",
    b"\x89HDF": "a file of HDF5 or MATLAB 7.3; write the table as CSV, as in writetable(T, 'loop.csv')",
    b"ISO-10303-21": "a STEP file; 'sevenbar axes' lists the axes of its cylinders, as a table to begin with",
    b"\xd0\xcf\x11\xe0": "an old Excel or Office file; save it as .xlsx or CSV",
    b"%PDF": "a PDF file; give a TOML file of format 1, or a table (.csv, .xlsx)",
}

#: Files of other programs by the ends of their names, as texts begin alike.
_OTHER_ENDINGS = {
    ".urdf": "URDF",
    ".xacro": "URDF",
    ".sdf": "SDF",
    ".mjcf": "MJCF",
    ".xml": "XML (MJCF, Simscape)",
    ".fcstd": "a FreeCAD file",
    ".sldasm": "a SolidWorks file",
    ".slx": "a Simulink file",
    ".cmd": "an ADAMS file",
}

#: The same by the heads of their texts.
_OTHER_HEADS = {b"<robot": "URDF", b"<sdf": "SDF", b"<mujoco": "MJCF", b"<?xml": "XML"}

#: Bytes of a file that give its kind.
_HEAD = 2000

#: Of the words of TOML's reader a message has at most so many characters: they may hold a text of the file.
_LONGEST_REASON = 200

#: What TOML's reader says of a place.
_PLACE = r"(.*) \(at (?:line (\d+), column \d+|end of document)\)"

#: Tables of which a file may have several.
LISTED = ("joint", "pin", "link", "point", "body", "load", "spring", "stop", "rod")

#: Slips that people make in TOML, by how the line looks: a unit next to a number, a decimal comma, a text or
#: a sign of another language.
_SLIPS = (
    (
        "[^#]*[\u201c\u201d\u201e\u2018\u2019\u00ab\u00bb].*",
        'write straight quotes, as in name = "RSSR"',
    ),
    (
        r"[^=]+=\s*[-+\d.]+\s*[A-Za-z\u00b0/]+.*",
        "write a number without its unit, which length_unit and angle_unit give for the whole file, "
        'or both in quotes, as in "25 cm"',
    ),
    (r"[^=]+=\s*[-+]?\d+,\d+\s*(#.*)?", "write a decimal point, as in 0.5"),
    (r"\s*[A-Za-z_]\w*\s*=\s*[A-Za-z_][^\"']*", 'write a text in quotes, as in kind = "R"'),
    (
        r"[^=#]+=\s*\[.*[\[,]\s*[A-Za-z_][^\"'\[\],]*[\],].*",
        'write each text in quotes, as in ["frame", "crank"]',
    ),
    (r"[^=#]+=.*\d\s+[-+.\d].*\].*", "write a comma between numbers, as in [10, 40]"),
    (r"[^=#]+=[^\]#]*\[[^\]#]*", "close the list with ]"),
    (r"\s*\w+\s*:.*", "write a key and its value with '=', as in M = 700"),
    (r"\s*\[\[[^\]]*\]?\s*|\s*\[[^\]]*", "close the head of a table, as in [rssr] or [[joint]]"),
)


@ends_here
def load(source: str | os.PathLike[str], *, agree: float | None = None) -> Linkage:
    """The linkage of a TOML file, of a table (CSV or Excel), or of the gallery by its name.

    Redundant constraints `agree` up to a closure error in all that is made of it (`Linkage.agreeing`).

    Raises `DescriptionError` with every problem of the file, each with its place, the value and what is
    allowed; `TableError` for a table that cannot be read.

        >>> import sevenbar as sb
        >>> sb.load("rssr").kind
        'RSSR'
    """
    path = given_path("source", source)
    if _in_gallery(source):
        return loads(text(str(source)), str(source)).agreeing(agree)
    content = _read(path)
    if (
        _is_table(content, path)
        and not _of_other_program(content, str(path))
        and len(content) <= LARGEST_TABLE
    ):
        return _table(content, str(source)).linkage(from_description, str(source)).agreeing(agree)
    return loads(decoded(content, str(path)), str(source)).agreeing(agree)


def toml_text(source: str | os.PathLike[str]) -> str:
    """The TOML text of a file, or of a linkage of the gallery by its name; raises as `load` does.

    Of a table it is the description that the table has become.
    """
    if _in_gallery(source):
        return text(str(source))
    path = Path(source)
    return decoded(_read(path), str(path))


def note_of(source: str | os.PathLike[str]) -> str:
    """How a table was read, in a sentence; empty for other files, and for one that is wrong."""
    path = given_path("source", source)
    # of the gallery or not, what is no file is no table
    if not is_file(path):
        return ""
    content = _read(path)
    if not _is_table(content, path):
        return ""
    try:
        result = _table(content, str(path))
        result.linkage(from_description, str(path))
    except SevenbarError:  # which the command reports
        return ""
    return result.note


@ends_here
def loads(content: str, source: str = "text") -> Linkage:
    """The linkage described by a TOML text; `source` is its name in messages.

    >>> import sevenbar as sb
    >>> from sevenbar import gallery
    >>> sb.loads(gallery.text("bennett")).name
    'Bennett linkage'
    """
    check_kind("content", content, str, "a text; give that of a TOML file, or load(path)")
    check_kind("source", source, str, "a name; give a text")
    given_path("source", source)
    return checked(toml_tables(content, source), source)


def checked(raw: Mapping[str, Any], source: str) -> Linkage:
    """The linkage that the tables of a file describe, with a warning where its angles are in doubt."""
    linkage = from_description(raw, source)
    warn_of_angles(raw, source)
    return linkage


def toml_tables(content: str, source: str) -> dict[str, Any]:
    """The tables of a TOML text; `DescriptionError` with the line where it is none."""
    lines = content.split("\n")  # as TOML counts them: its texts may hold other ends of lines
    for number, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            raise DescriptionError.of_all(
                source, f"line {number} has {len(line)} characters; a linkage file has at most {LONGEST_LINE}"
            )
    try:
        return tomllib.loads(content)
    except ValueError as error:  # not TOML, or an integer of thousands of digits
        raise DescriptionError.of_all(source, _syntax_problem(error, lines)) from None
    except RecursionError:
        raise DescriptionError.of_all(
            source, "nested too deep; a linkage file has tables of plain keys only"
        ) from None


def _syntax_problem(error: ValueError, lines: list[str]) -> str:
    """What is wrong with a text that is not TOML: the line, the reader's words, and what to do."""
    match = re.fullmatch(_PLACE, str(error))
    example = "'sevenbar gallery rssr' prints a file that is right"
    if match is None:
        return f"not valid TOML: {str(error)[:_LONGEST_REASON]}; {example}"
    reason = match[1][:1].lower() + match[1][1:_LONGEST_REASON]
    if match[2] is None:
        return f"not valid TOML: {reason}, at the end of the file; {example}"
    number = int(match[2])
    if reason == "unclosed array":
        # what is read there belongs to no list: the line above that opens one is at fault
        above = (n for n in range(number, 0, -1) if lines[n - 1].count("[") > lines[n - 1].count("]"))
        number = next(above, number)
    line = lines[number - 1]
    if reason.startswith(("cannot overwrite", "cannot declare")):
        head = re.fullmatch(r"\s*\[\s*(\w+)\s*\]\s*(#.*)?", line)
        listed = head is not None and head[1] in LISTED
        remedy = f"write [[{head[1]}]] before each one" if head and listed else "leave one of them out"
        return f"line {number}: {shown(line.strip())} stands twice; {remedy}"
    remedy = next((hint for slip, hint in _SLIPS if re.fullmatch(slip, line)), example)
    return f"line {number}: {shown(line.strip())} is not valid TOML: {reason}; {remedy}"


def _in_gallery(source: str | os.PathLike[str]) -> bool:
    """Whether a source is the name of a linkage of the gallery, and no file; a folder may have that name."""
    return isinstance(source, str) and source in names() and (is_folder(source) or not is_there(source))


def _read(path: Path) -> bytes:
    def missing() -> str:
        return f"{near_files(path)}give the path of a TOML file, or a name that 'sevenbar gallery' lists"

    refuse = partial(DescriptionError.of_all, str(path))
    return read_start(path, LARGEST_TABLE + 1, "a TOML file", refuse, missing)


def _is_table(content: bytes, path: Path) -> bool:
    """Whether a file is a table: by its ending, a workbook by its content."""
    from sevenbar.text.workbook import ZIP

    return path.suffix.lower() in TABLE_ENDINGS or content.startswith(ZIP)


def _table(content: bytes, place: str) -> TableDescription:
    # most files are none
    from sevenbar.description.table_files import description_of_bytes

    return description_of_bytes(content, place)


def decoded(content: bytes, place: str) -> str:
    """The TOML text of a file's bytes; `place` is its name in messages. Raises as `load` does."""
    table = _is_table(content, Path(place))
    kind = next((what for mark, what in _OTHER_KINDS.items() if content.startswith(mark)), "")
    kind = kind or _of_other_program(content, place)
    if kind and (not table or Path(place).suffix.lower() in _OTHER_ENDINGS):
        raise DescriptionError.of_all(place, kind)
    largest = LARGEST_TABLE if table else LARGEST_FILE
    if len(content) > largest:
        raise DescriptionError.of_all(
            place, f"larger than {largest} bytes, so it is no linkage file; give a TOML file of format 1"
        )
    if table:
        result = _table(content, place)
        result.linkage(from_description, place)  # its mistakes, with their places in the table
        return result.toml(Path(place).name)
    # UTF-16, as Notepad's "Unicode" writes it
    wide = wide_text(content)
    try:
        return content.decode(wide or "utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        damaged = "damaged UTF-16 text; save the file as UTF-8"
        flaw = damaged if wide else _not_utf8(content, error.start)
        raise DescriptionError.of_all(place, flaw) from None


def _of_other_program(content: bytes, place: str) -> str:
    """What to say of a file of a robot or CAD program; empty for others."""
    head = content[:_HEAD].lstrip()
    word = next((what for mark, what in _OTHER_HEADS.items() if mark in head and head[:1] == b"<"), "")
    word = _OTHER_ENDINGS.get(Path(place).suffix.lower(), "") or word
    if word:
        return (
            f"{word} cannot be read; write the joints of its loop as [[joint]] with place and axis in one "
            "pose, or as a table (.csv, .xlsx); 'sevenbar axes' reads axes from STEP"
        )
    if head[:1] == b"{":
        return (
            'line 1: JSON cannot be read; write TOML, a key as in name = "rocker"; '
            "'sevenbar gallery rssr' prints a file that is right"
        )
    return ""


def _not_utf8(content: bytes, start: int) -> str:
    """What is wrong with bytes that are no UTF-8 from `start` on: the line of a text, or no text at all."""
    if b"\0" in content:
        return f"not text: byte {start} is not UTF-8; give a TOML file of format 1, or a table (.csv, .xlsx)"
    number = content.count(b"\n", 0, start) + 1
    line = content.split(b"\n")[number - 1].decode("cp1252", errors="replace").strip()
    return f"line {number}: {shown(line)} is not UTF-8; save the file as UTF-8"


def near_files(path: Path) -> str:
    """`did you mean 'mine.toml'? `: files of the folder and names of the gallery like a path, or nothing."""
    try:
        known = (".toml", *TABLE_ENDINGS)
        files = sorted(file.name for file in path.parent.iterdir() if file.suffix.lower() in known)
    except (OSError, ValueError):  # a folder that may not be read; a path that cannot be
        files = []
    near = [f"'{path.with_name(name) if name in files else name}'" for name in nearest(path.name, files)]
    return f"did you mean {' or '.join(near)}? " if near else ""
