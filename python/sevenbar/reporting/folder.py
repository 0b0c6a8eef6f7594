"""A folder of files to keep, the figures and the rows of a motion: all of them appear, or none."""

from __future__ import annotations

import csv
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sevenbar.errors import OutputError
from sevenbar.kinematics.motion import Motion

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def check_targets(files: Iterable[Path], *, force: bool) -> None:
    """Raises `OutputError` where files cannot go, or would replace others without `force`; changes nothing.

    Asked before long work, so that it is not done in vain.
    """
    for file in files:
        _check_folder(file.parent)
        if file.is_dir():
            raise OutputError(f"{file}: is a folder where a file should go; give another path")
        if not force and file.exists():
            raise OutputError(f"{file}: exists already; give another path, or --force to replace it")


def _check_folder(folder: Path) -> None:
    """Raises `OutputError` for a folder that can be neither made nor written."""
    nearest = next((place for place in (folder, *folder.parents) if place.exists()), folder)
    if not nearest.is_dir():
        who = "it" if nearest == folder else str(nearest)
        raise _unwritable(folder, f"{who} is a file")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise _unwritable(folder, "permission denied")


def _unwritable(folder: Path, reason: str) -> OutputError:
    return OutputError(f"{folder}: cannot be written: {reason}; give a folder that can be made or written")


def fill_folder(folder: Path, fill: Callable[[Path], None], *, force: bool = False) -> list[Path]:
    """Lets `fill` write into a folder aside, then moves its files into `folder`: whole, or not at all.

    Without `force` a file that is there already is an `OutputError`, and nothing is changed.
    """
    _check_folder(folder)
    made = [p for p in (folder, *folder.parents) if not p.exists()]
    staging = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".partial-", dir=folder))
        fill(staging)
        files = sorted(staging.iterdir())
        check_targets([folder / file.name for file in files], force=force)
        return [file.replace(folder / file.name) for file in files]
    except OSError as error:
        _undo(made, staging)
        raise _unwritable(folder, (error.strerror or str(error)).lower()) from None
    except BaseException:
        _undo(made, staging)
        raise
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)


def _undo(made: Sequence[Path], staging: Path | None) -> None:
    if staging is not None:
        shutil.rmtree(staging, ignore_errors=True)
    for path in made:
        with suppress(OSError):
            path.rmdir()


Places = Mapping[str, tuple[int, tuple[float, float, float]]]


def write_figures(
    motion: Motion,
    folder: str | os.PathLike[str],
    kinds: Sequence[str],
    points: Places,
    *,
    circuit: int = 0,
    figures: Sequence[str] = ("png",),
    force: bool = False,
) -> list[Path]:
    """Writes figures of these kinds into a folder, all or none; returns their paths.

    `kinds` of curves, joints, modes, configuration, point; `points` (link, at) by name, for the last. Raises
    `OutputError` where one of the files exists and `force` is not given.
    """
    return fill_folder(
        Path(folder), lambda staging: draw(motion, staging, kinds, points, circuit, figures), force=force
    )


def draw(
    motion: Motion, folder: Path, kinds: Sequence[str], points: Places, circuit: int, figures: Sequence[str]
) -> None:
    """Draws figures of these kinds into a folder, in each of the formats `figures`."""
    from sevenbar.drawing import plot
    from sevenbar.kinematics.motion import chosen_circuit

    def made() -> Iterator[tuple[str, Figure]]:
        linkage = motion.linkage
        if "curves" in kinds:
            yield "motion", plot.curves(motion)
        if "joints" in kinds:
            yield "joints", plot.joints(motion)
        if "configuration" in kinds:
            yield "configuration", plot.configuration(motion, circuit)
        if "point" in kinds:
            for name, (link, at) in points.items():
                yield f"path_{_file_name(name)}", plot.point_path(motion, (link, at), circuit, name=name)
        if "modes" in kinds:
            chosen = chosen_circuit(motion, circuit)
            # a limit is no place to show modes at: there two are one
            ends = chosen.pass_range(0)
            value = float(chosen.input[0]) if ends is None else (ends[0] + ends[1]) / 2
            modes = linkage.assembly_modes(value, input=motion.input)
            yield "modes", plot.modes_overview(linkage, modes, input=motion.input, output=motion.output)

    for name, figure in made():
        for ending in figures:
            plot.save(figure, folder / f"{name}.{ending}")


def _file_name(name: str) -> str:
    """The name of a point as a part of a file's name."""
    return re.sub(r"[^\w.-]+", "_", name).strip("_.") or "point"


def write_columns(path: Path, columns: Mapping[str, npt.ArrayLike]) -> None:
    """Writes columns of one length (n,) as CSV, their names as its head; as `write_csv` for the rest."""
    write_csv(path, list(columns), zip(*(np.asarray(c).tolist() for c in columns.values()), strict=True))


def write_csv(path: Path, head: Sequence[str], lines: Iterable[Iterable[Any]]) -> None:
    """Writes a table as CSV; a value that does not exist, NaN or None, is an empty cell."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(["" if cell is None or cell != cell else cell for cell in line] for line in lines)
