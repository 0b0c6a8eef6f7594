"""Tables that would take the memory or the time are refused before they are read, each in one line."""

from __future__ import annotations

import warnings
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import openpyxl
import pytest

import sevenbar as sb
from command_runs import mistake
from sevenbar.description.files import note_of
from sevenbar.errors import DescriptionError, OutputError, RequestError, SevenbarError, TableError
from sevenbar.sweep import Sweep
from sevenbar.text import table, workbook
from sevenbar.text.expression import WrongFormulaError, parsed

LONG = "x" * 5000
HEAD = ["length [mm]", "twist [deg]"]
ROWS = [[60, 40], [90.16282937626413, 75], [60, 40], [90.16282937626413, 75]]


def book(path: Path, **cells: object) -> Path:
    made = openpyxl.Workbook()
    for row in [HEAD, *ROWS]:
        made.active.append(row)
    for name, value in cells.items():
        made.active[name] = value
    made.save(path)
    return path


def of_sheet(path: Path, xml: bytes) -> Path:
    """A workbook whose one sheet is this."""
    whole = book(path.with_name("whole.xlsx"))
    with ZipFile(whole) as source, ZipFile(path, "w", ZIP_DEFLATED) as made:
        for name in source.namelist():
            made.writestr(name, xml if name == "xl/worksheets/sheet1.xml" else source.read(name))
    return path


def sheet(rows: bytes) -> bytes:
    main = b"http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    return b'<worksheet xmlns="' + main + b'"><sheetData>' + rows + b"</sheetData></worksheet>"


@pytest.mark.parametrize("cell", ["XFD1048576", "A1000000", "XFD1", "ALM3", "B200001"])
def test_a_cell_far_out_is_named_and_refused(tmp_path, cell):
    path = book(tmp_path / "far.xlsx", **{cell: 1})
    message = (
        rf"far.xlsx: sheet 'Sheet' has a value in cell {cell}; a table has at most 200,000 rows and 1,000 col"
    )
    with pytest.raises(TableError, match=message):
        sb.load(path)
    with pytest.raises(TableError, match=message):
        sb.load_law(path, sb.load("rssr"))


@pytest.mark.parametrize("cell", ["XFD3", "A1000000", "ALL2"])
def test_cells_far_out_that_are_empty_change_nothing(tmp_path, cell):
    near, far = book(tmp_path / "near.xlsx"), tmp_path / "far.xlsx"
    made = openpyxl.load_workbook(near)
    made.active[cell].font = openpyxl.styles.Font(bold=True)
    made.save(far)
    assert sb.load(far).dimensions == sb.load(near).dimensions


def test_a_workbook_is_refused_by_its_size_unpacked_before_it_is(tmp_path):
    bomb = of_sheet(tmp_path / "bomb.xlsx", sheet(b'<row r="1"><c r="A1"><v>1</v></c></row>' * 1_500_000))
    assert bomb.stat().st_size < 300_000
    with pytest.raises(
        TableError, match=r"bomb.xlsx: holds 58,\d+,\d+ bytes unpacked; a workbook with a table has"
    ):
        sb.load(bomb)


def test_a_sheet_of_very_many_empty_cells_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(workbook, "MOST_CELLS", 100_000)
    rows = b"".join(b'<row r="%d"><c r="XFD%d"/></row>' % (i, i) for i in range(1, 50))
    with pytest.raises(
        TableError, match=r"many.xlsx: sheet 'Sheet' has more than 100,000 cells; give a sheet with"
    ):
        sb.load(of_sheet(tmp_path / "many.xlsx", sheet(rows)))


def test_a_sheet_that_is_no_xml_is_no_workbook_that_can_be_read(tmp_path):
    with pytest.raises(TableError, match=r"is no Excel workbook that can be read"):
        sb.load(of_sheet(tmp_path / "cut.xlsx", sheet(b"<row")[:-20]))


def test_a_table_of_too_many_lines_is_refused_whatever_ends_them(tmp_path, monkeypatch):
    monkeypatch.setattr(table, "MOST_LINES", 1_000)
    for number, end in enumerate(["\n", "\r\n", "\r", "\f", "\u2028"]):
        path = tmp_path / f"{number}.csv"
        path.write_text(f"time [s],crank [deg]{end}" + f"0.1,2{end}" * 1_000, encoding="utf-8", newline="")
        with pytest.raises(TableError, match=r"has 1,001 lines; give a table of at most 1,000 rows"):
            sb.load_law(path, sb.load("rssr"))
        with pytest.raises(SevenbarError, match=r"has 1,001 lines"):
            sb.load(path)


def test_a_line_of_many_columns_is_no_row_of_a_table(tmp_path):
    path = tmp_path / "wide.csv"
    path.write_text(",".join(["1"] * 200_000) + "\n")
    for read in (sb.load, lambda path: sb.load_law(path, sb.load("rssr"))):
        with pytest.raises(
            SevenbarError, match=r"wide.csv: line 1 has 399999 characters, so it is no row of a table"
        ):
            read(path)


@pytest.mark.parametrize("filling", [" ", "[", "_a", ",a/"])
def test_a_name_as_long_as_a_line_is_read_at_once(tmp_path, filling):
    """A search for the unit behind it would take minutes."""
    path = tmp_path / "long.csv"
    name = f"a{filling * (99_000 // len(filling))}b"
    path.write_text(f'time [s],"{name}"\n0,1\n1,2\n')
    with pytest.raises(TableError, match=r"long.csv"):
        sb.load_law(path, sb.load("rssr"))


def test_quotes_that_are_never_closed_are_a_mistake_of_the_table(tmp_path):
    path = tmp_path / "open.csv"
    path.write_text('length [mm],twist [deg]\n"' + ("6" * 70 + "\n") * 2_000)
    with pytest.raises(DescriptionError, match=r"open.csv: a cell goes on over many lines; close the quotes"):
        sb.load(path)


def test_a_path_that_no_system_takes_is_no_file(tmp_path):
    with pytest.raises(RequestError, match="is longer than any path; give that of a file"):
        note_of(LONG)
    assert "is longer than any path; give that of a file" in mistake("analyze", LONG)
    assert "file name too long" in mistake("analyze", "rssr", "--out", tmp_path / LONG)
    assert "file name too long" in mistake("modes", "rssr", "--out", tmp_path / f"{LONG}.svg")


@pytest.mark.parametrize(
    "text",
    ['{"format": 1, "made_by": []}', "[" * 100_000, '{"format": 1, "made_by": 3, "parts": "x"}', "[]", ""],
)
def test_another_description_is_no_sweep(tmp_path, text):
    (tmp_path / "sweep.json").write_text(text)
    with pytest.raises(
        OutputError,
        match=r"sweep.json: is (no description of a|a) sweep of format \d.*; (give|sweep into) another",
    ):
        Sweep.of_folder(tmp_path)


def test_brackets_without_end_are_no_survey(tmp_path):
    call = [
        "design",
        "survey",
        "--output-range",
        "0:23.75deg",
        "--count",
        "1000",
        "--journal",
        tmp_path / "s",
    ]
    (tmp_path / "s").mkdir()
    (tmp_path / "s" / "survey.json").write_text("[" * 100_000)
    assert mistake(*call).endswith("survey.json: is no description of a survey; give another folder")


@pytest.mark.parametrize("text", ["1if", "2or 3", "5in x", "0xor 1", "'\\d'", "3and"])
def test_the_parser_of_python_has_no_say_of_its_own_on_formulas(text):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises((WrongFormulaError, RequestError)):
            parsed(text, ("x",))
