"""Files that are not what is wanted: the message says what they are and what to do."""

import pytest

import sevenbar as sb
from command_runs import mistake
from sevenbar.description import gallery
from sevenbar.errors import DescriptionError

TEXT = gallery.text("rssr").replace('name = "RSSR of Sun and Zhou"', 'name = "Prüfstand"')


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_file_of_notepad_is_read(tmp_path, encoding):
    path = tmp_path / "f.toml"
    mark = "\ufeff" if encoding in ("utf-16-le", "utf-16-be") else ""
    path.write_bytes((mark + TEXT).replace("\n", "\r\n").encode(encoding))
    assert sb.load(path).name == "Prüfstand"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (TEXT.encode("latin-1"), "line 4: 'name = \"Prüfstand\"' is not UTF-8; save the file as UTF-8"),
        (TEXT.replace('"mm"', "\u201cmm\u201d").encode(),
         "line 5: 'length_unit = \u201cmm\u201d' is not valid TOML: invalid value; write straight quotes, as in name = \"RSSR\""),
        (b"\xff\xfe[\x00r\x00s\x00]\x00\n", "damaged UTF-16 text; save the file as UTF-8"),
        (b"MATLAB 5.0 MAT-file, Platform: GLNXA64" + bytes(100),
         "a MATLAB file; write the table as CSV, as in writetable(T, 'loop.csv')"),
        (b"\x89HDF\r\n\x1a\n" + bytes(100),
         "a file of HDF5 or MATLAB 7.3; write the table as CSV, as in writetable(T, 'loop.csv')"),
        (b"ISO-10303-21;\nHEADER;" + b" " * 200_000,
         "a STEP file; 'sevenbar axes' lists the axes of its cylinders, as a table to begin with"),
        (b"\xd0\xcf\x11\xe0" + bytes(100), "an old Excel or Office file; save it as .xlsx or CSV"),
        (b"%PDF-1.7\n", "a PDF file; give a TOML file of format 1, or a table (.csv, .xlsx)"),
    ],
)  # fmt: skip
def test_each_wrong_file_has_its_message(tmp_path, content, message):
    path = tmp_path / "f.toml"
    path.write_bytes(content)
    with pytest.raises(DescriptionError) as refused:
        sb.load(path)
    assert str(refused.value) == f"{path}: {message}"


def test_an_old_workbook_by_its_ending_is_refused_too(tmp_path):
    (tmp_path / "dh.xls").write_bytes(b"\xd0\xcf\x11\xe0" + bytes(100))
    assert mistake("analyze", "dh.xls", cwd=tmp_path) == (
        "dh.xls: is a workbook of the old kind (.xls); save it as .xlsx or CSV"
    )


def test_a_line_too_long_has_the_number_that_an_editor_shows():
    with pytest.raises(DescriptionError, match=r"^f.toml: line 2 has 3000 characters"):
        sb.loads("# a sign \u2028 that ends no line of TOML\n" + "x" * 3000, "f.toml")


def test_a_folder_named_as_a_linkage_of_the_gallery_does_not_hide_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rssr").mkdir()
    assert sb.load("rssr").kind == "RSSR"
