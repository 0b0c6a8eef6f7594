"""A folder of files to keep: all of them appear, or none."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from sevenbar.errors import OutputError
from sevenbar.text.aside import aside_prefix, clear_left
from sevenbar.text.paths import is_folder, is_there

#: Endings of files that commands write, which a folder hardly has.
ENDINGS = (".png", ".svg", ".pdf", ".csv", ".json", ".md", ".html", ".gif", ".mp4", ".toml", ".xlsx")


def check_targets(files: Iterable[Path], *, force: bool) -> None:
    """Raises `OutputError` where files cannot go, or would replace others without `force`; changes nothing.

    Asked before long work, so that it is not done in vain.
    """
    for file in files:
        _check_folder(file.parent)
        _check_name(file)
        if is_folder(file):
            raise OutputError(f"{file}: is a folder where a file should go; give another path")
        if not force and is_there(file):
            raise OutputError(f"{file}: exists already; give another path, or --force to replace it")


def check_folder_name(out: Path) -> None:
    """Raises `OutputError` where nothing is there yet and the name is that of a file."""
    if out.suffix.lower() in ENDINGS and not is_there(out):
        raise OutputError(
            f"{out}: is the name of a file, and --out is a folder here; "
            f"give one, as in --out {out.with_suffix('')}"
        )


def _check_name(file: Path) -> None:
    """Raises `OutputError` for a name that the system does not take, as one of 5,000 letters."""
    try:
        file.lstat()
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        pass
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise OutputError(f"{file}: cannot be written: {reason.lower()}; give another name") from None


def _check_folder(folder: Path) -> None:
    """Raises `OutputError` for a folder that can be neither made nor written."""
    # a path that is too long for the system has no file, where `Path` would raise
    nearest = next((place for place in (folder, *folder.parents) if is_there(place)), folder)
    if not is_folder(nearest):
        who = "it" if nearest == folder else str(nearest)
        raise _unwritable(folder, f"{who} is a file")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise _unwritable(folder, "permission denied")


def _unwritable(folder: Path, reason: str) -> OutputError:
    return OutputError(f"{folder}: cannot be written: {reason}; give a folder that can be made or written")


class Stopped(KeyboardInterrupt):
    """Ctrl+C while files were written, which left those that were whole by then."""

    def __init__(self, files: Sequence[Path]) -> None:
        super().__init__()
        self.files = tuple(files)

    @property
    def kept(self) -> str:
        """What is left, in words."""
        return f"these files are whole and kept: {', '.join(map(str, self.files))}"


def fill_folder(folder: Path, fill: Callable[[Path], object], *, force: bool = False) -> list[Path]:
    """Lets `fill` write into a folder aside, then moves its files into `folder`: whole, or not at all.

    Without `force` a file that is there already is an `OutputError`, and nothing is changed. Where `fill` is
    a generator of its files, each yielded once it is whole, those that are whole outlive Ctrl+C: `Stopped`.
    """
    _check_folder(folder)
    made = [p for p in (folder, *folder.parents) if not is_there(p)]
    staging = None
    whole: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        clear_left(folder)
        # only what writes needs it
        import tempfile

        staging = Path(tempfile.mkdtemp(prefix=aside_prefix(), dir=folder))
        filling = fill(staging)
        if isinstance(filling, Iterator):
            whole.extend(filling)
        files = sorted(staging.iterdir())
        check_targets([folder / file.name for file in files], force=force)
        return [file.replace(folder / file.name) for file in files]
    except OSError as error:
        _undo(made, staging)
        raise _unwritable(folder, (error.strerror or str(error)).lower()) from None
    except KeyboardInterrupt:
        selected = _keep(whole, folder, force=force)
        _undo([] if selected else made, staging)
        if selected:
            raise Stopped(selected) from None
        raise
    except BaseException:
        _undo(made, staging)
        raise
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)


def _keep(whole: Sequence[Path], folder: Path, *, force: bool) -> list[Path]:
    """Moves files that are there and may be put into a folder."""
    return [
        file.replace(folder / file.name)
        for file in whole
        if file.exists() and (force or not (folder / file.name).exists())
    ]


def _undo(made: Sequence[Path], staging: Path | None) -> None:
    if staging is not None:
        shutil.rmtree(staging, ignore_errors=True)
    for path in made:
        with suppress(OSError):
            path.rmdir()
