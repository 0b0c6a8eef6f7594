"""Files that the studio saves to: whole or not at all, and none replaced that it does not know."""

import os
import stat
from pathlib import Path

import pytest

from sevenbar.errors import OutputError
from sevenbar.studio.state.shelf import ChangedError, Shelf

OLD, NEW = "format = 1\n# mine\n", "format = 1\n# ours\n"


def test_a_file_that_was_read_is_saved_and_saved_again_and_nothing_is_left_beside_it(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(OLD)
    path.chmod(0o640)
    shelf = Shelf(tmp_path)
    assert shelf.read(path).decode() == OLD
    assert shelf.save("mine.toml", NEW) == path
    assert shelf.save("mine", OLD) == path
    assert path.read_text() == OLD
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert [file.name for file in tmp_path.iterdir()] == ["mine.toml"]


def test_a_file_that_changed_or_went_or_is_not_known_is_replaced_only_when_asked(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(OLD)
    shelf = Shelf(tmp_path)
    shelf.read(path)
    path.write_text(OLD + "# by another program\n")
    with pytest.raises(
        ChangedError, match=r"^mine.toml: it has changed since it was read; replace it, or give"
    ):
        shelf.save("mine.toml", NEW)
    assert path.read_text().endswith("# by another program\n")
    path.unlink()
    with pytest.raises(ChangedError, match="is gone now"):
        shelf.save("mine.toml", NEW)
    assert not path.exists()
    shelf.save("mine.toml", NEW, replace=True)
    assert path.read_text() == NEW
    # another tab has read nothing of it
    with pytest.raises(ChangedError, match=r"^mine.toml: it exists already"):
        Shelf(tmp_path).save("mine.toml", OLD)
    assert path.read_text() == NEW
    # a new one is known from then on
    shelf.save("other", NEW)
    shelf.save("other", OLD)
    assert (tmp_path / "other.toml").read_text() == OLD


def test_a_file_that_was_saved_by_another_tab_has_changed(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(OLD)
    one, other = Shelf(tmp_path), Shelf(tmp_path)
    one.read(path)
    other.read(path)
    one.save("mine.toml", NEW)
    with pytest.raises(ChangedError):
        other.save("mine.toml", OLD)


def test_the_ends_of_lines_and_the_mark_of_windows_stay(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_bytes(b"\xef\xbb\xbf" + OLD.replace("\n", "\r\n").encode())
    shelf = Shelf(tmp_path)
    shelf.read(path)
    shelf.save("mine.toml", NEW)
    assert path.read_bytes() == b"\xef\xbb\xbf" + NEW.replace("\n", "\r\n").encode()


@pytest.mark.parametrize(
    "name", ["", "  ", "../up", "a/b", "/etc/x", ".hidden", "..", "a\\b", "a\0b", "a\nb.toml", "\x1b[31m", "CON",
         "con.toml", "lpt1.x", "a:b", "a*b", "\u202eb"],
)  # fmt: skip
def test_only_names_of_files_of_the_folder_are_taken(tmp_path, name):
    home = tmp_path / "home"
    home.mkdir()
    with pytest.raises(OutputError, match="is not the name of a file in"):
        Shelf(home).save(name, NEW, replace=True)
    assert list(home.iterdir()) == []
    assert [file.name for file in tmp_path.iterdir()] == ["home"]


def test_a_link_to_a_file_stays_a_link(tmp_path):
    there = tmp_path / "there"
    there.mkdir()
    (there / "real.toml").write_text(OLD)
    (tmp_path / "mine.toml").symlink_to(there / "real.toml")
    shelf = Shelf(tmp_path)
    shelf.read(tmp_path / "mine.toml")
    shelf.save("mine.toml", NEW)
    assert (tmp_path / "mine.toml").is_symlink()
    assert (there / "real.toml").read_text() == NEW


def test_a_link_that_leads_out_of_the_folder_is_not_followed_unless_it_was_opened(tmp_path):
    folder, out = tmp_path / "home", tmp_path / "there"
    folder.mkdir()
    out.mkdir()
    (out / "real.toml").write_bytes(b"mine")
    (folder / "nowhere.toml").symlink_to(out / "new.toml")
    (folder / "real.toml").symlink_to(out / "real.toml")
    for name in ("nowhere.toml", "real.toml"):
        for replace in (False, True):
            with pytest.raises(OutputError, match="is a link out of"):
                Shelf(folder).save(name, NEW, replace=replace)
    assert not (out / "new.toml").exists()
    assert (out / "real.toml").read_bytes() == b"mine"
    shelf = Shelf(folder)
    shelf.read(folder / "real.toml")
    shelf.save("real.toml", NEW)
    assert (out / "real.toml").read_bytes() == NEW.encode()


def test_what_cannot_be_written_is_left_as_it_was(tmp_path, monkeypatch):
    path = tmp_path / "mine.toml"
    path.write_text(OLD)
    shelf = Shelf(tmp_path)
    shelf.read(path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(
        OutputError, match=r"mine.toml: cannot be written: no space left on device; give another"
    ):
        shelf.save("mine.toml", NEW)
    monkeypatch.undo()
    assert path.read_text() == OLD
    assert [file.name for file in tmp_path.iterdir()] == ["mine.toml"]
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(OutputError, match="cannot be written: is a directory"):
        shelf.save("folder.toml", NEW)
    with pytest.raises(OutputError, match="cannot be written"):
        Shelf(Path("/proc")).save("mine.toml", NEW)
