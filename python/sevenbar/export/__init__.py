"""A linkage and its motion in the files of other programs: tables, meshes, CAD, robots, ADAMS.

    from sevenbar.export import export
    export(sb.load("rssr"), "step", "rssr.step", at=0.5)

The way there: a `Pose` of a circuit (`pose`), the parts as they would be built (`parts`), seated so that they
overlap little (`layout`), and one module for each kind of file.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sevenbar.errors import RequestError, check_word, shown, suggestion
from sevenbar.export.pose import take
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.reporting.folder import check_targets, fill_folder
from sevenbar.text.progress import Progress, silent

if TYPE_CHECKING:
    from sevenbar.export.parts import Assembly
    from sevenbar.export.tables import Units

__all__ = ["FORMATS", "Bodies", "Format", "Table", "ending_of", "export", "format_of"]


@dataclass(frozen=True)
class _FileKind:
    """A kind of file: its endings, and the function of a module here that writes it."""

    endings: tuple[str, ...]
    writer: str

    def _call(self, *given: Any) -> None:
        """Calls the writer, which is imported when it is used: behind it are large libraries."""
        module, _, name = self.writer.partition(".")
        getattr(import_module(f"sevenbar.export.{module}"), name)(*given)


@dataclass(frozen=True)
class Table(_FileKind):
    """A kind of file that holds all rows of every circuit."""

    def write(self, motion: Motion, path: Path, units: Units, progress: Progress) -> None:
        """Writes the rows of a motion."""
        self._call(motion, path, units, progress)


@dataclass(frozen=True)
class Bodies(_FileKind):
    """A kind of file that holds the linkage's bodies in one pose."""

    #: Whose masses it holds where the linkage has none.
    masses: str = ""
    #: How its input may be driven, the usual way first.
    drives: tuple[str, ...] = ()

    def write(self, assembly: Assembly, path: Path, progress: Progress, drive: str | None) -> None:
        """Writes the parts of an assembly."""
        self._call(assembly, path, progress, *((drive or self.drives[0],) if self.drives else ()))


Format = Table | Bodies

#: Masses of bodies as they are drawn (steel, `forces.solids.DENSITIES`).
OF_STEEL = "those of the drawn bodies in steel, 7850 kg/m^3"

#: All kinds of file, by the word that asks for them.
FORMATS: dict[str, Format] = {
    "csv": Table((".csv",), "tables.write_csv"),
    "xlsx": Table((".xlsx",), "workbook.write_xlsx"),
    "parquet": Table((".parquet",), "tables.write_parquet"),
    "npz": Table((".npz",), "tables.write_npz"),
    "mat": Table((".mat",), "tables.write_mat"),
    "json": Table((".json",), "tables.write_json"),
    "glb": Bodies((".glb",), "meshes.write_glb"),
    "stl": Bodies((".stl",), "meshes.write_stl"),
    "step": Bodies((".step", ".stp"), "cad.write_step"),
    "urdf": Bodies((".urdf",), "urdf.write_urdf", OF_STEEL),
    "mjcf": Bodies(
        (".xml", ".mjcf"),
        "model.write_mjcf",
        "1 kg for every body",
        ("velocity", "position", "motor", "flywheel"),
    ),
    "cmd": Bodies((".cmd",), "adams.write_cmd", OF_STEEL),
}

#: What people call a kind of file by the program that reads it.
ALIASES = {
    "adams": "cmd",
    "excel": "xlsx",
    "gltf": "glb",
    "matlab": "mat",
    "mujoco": "mjcf",
    "numpy": "npz",
    "octave": "mat",
    "pandas": "parquet",
    "ros": "urdf",
    "spreadsheet": "xlsx",
}

#: What to give in place of a kind of file that is not written, and that people ask for.
INSTEAD = {
    word: advice
    for words, advice in {
        "dxf dwg": "no flat drawings are written; give step for CAD, or use: sevenbar plot --figures svg",
        "svg": "pictures are drawn with: sevenbar plot --figures svg",
        "png": "pictures are drawn with: sevenbar plot --figures png",
        "gif": "films are made with: sevenbar analyze --animate move.gif",
        "mp4": "films are made with: sevenbar analyze --animate move.mp4",
        "obj": "give glb or stl for meshes",
        "3mf": "give stl for printing",
        "iges igs parasolid solidworks inventor": "give step, which every CAD program reads",
        "simscape simulink": "give urdf, which smimport reads, and close the loop by the .loop.json file",
        "xls": "give xlsx",
    }.items()
    for word in words.split()
}


def export(
    source: Linkage | Motion,
    to: str | None,
    path: str | os.PathLike[str],
    *,
    circuit: int | None = None,
    at: float | None = None,
    branch: int | None = None,
    samples: int = 360,
    units: Units | None = None,
    drive: str | None = None,
    force: bool = False,
    progress: Progress = silent,
) -> list[Path]:
    """Writes a linkage or its motion for another program; returns the files written.

    `to` is a word of `FORMATS` or of `ALIASES`; `None` takes it from the path's ending. Tables hold every
    circuit; `units` "file" (the default) keeps the linkage's length unit, "si" takes metres and radians. The
    others hold one pose: of `circuit` (0), at the input `at` [rad, or length], on its pass `branch` (0).
    `mjcf` drives the input by an actuator for its "velocity", "position" or torque ("motor"), or by none and
    a "flywheel". `stl` with a path without an ending is a folder with one file for each part. `samples` are
    inputs in a turn, for a linkage.

    `progress(done, total, what)` is called along long work. Files appear whole or not at all, and take the
    place of others only with `force`. Raises `RequestError`
    for what cannot be, `MissingExtraError` for a library that is not installed, and `OutputError` for a file
    that exists or cannot be written.

        >>> import tempfile
        >>> import sevenbar as sb
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     [path.name for path in export(sb.load("rssr"), "mjcf", f"{folder}/rssr.xml")]
        ['rssr.xml']
    """
    target = Path(path)
    word = format_of(target, to)
    form = FORMATS[word]
    _check_choices(word, form, circuit, at, branch, units, drive)
    into_folder = word == "stl" and not target.suffix
    check_targets([] if into_folder else _files(word, target), force=force)
    motion = source.motion(samples) if isinstance(source, Linkage) else source
    if isinstance(form, Table):
        if not motion.circuits:
            raise RequestError(f"motion: {motion.motion_type}, so there are no rows to export")
        return fill_folder(
            target.parent,
            lambda aside: form.write(motion, aside / target.name, units or "file", progress),
            force=force,
        )
    from sevenbar.export.layout import arrange

    assembly = arrange(take(motion, circuit or 0, at, branch))
    if into_folder:
        from sevenbar.export.meshes import write_stl_parts

        check_targets([target / f"{part.name}.stl" for part in assembly.parts], force=force)
        return fill_folder(target, lambda aside: write_stl_parts(assembly, aside, progress), force=force)
    return fill_folder(
        target.parent, lambda aside: form.write(assembly, aside / target.name, progress, drive), force=force
    )


def format_of(path: Path, to: str | None) -> str:
    """The word for the kind of a file: the one given, else that of the path's ending."""
    known = {ending: word for word, form in FORMATS.items() for ending in form.endings}
    result = known.get(path.suffix.lower())
    word = result if to is None else _word(to)
    if word is None:
        endings = ", ".join(known)
        raise RequestError(f"{path}: {shown(path.suffix)} is the ending of no format; give one of {endings}")
    allowed = " or ".join(FORMATS[word].endings)
    if path.suffix and result != word:
        raise RequestError(f"{path}: its ending {shown(path.suffix)} is not that of {word}; give {allowed}")
    if not path.suffix and word != "stl":
        raise RequestError(f"{path}: has no ending; give {allowed}")
    return word


def ending_of(to: str) -> str:
    """The ending that a file of a kind has where none is given; raises `RequestError` for another word."""
    word = to.lower().removeprefix(".")
    ending = "." + ALIASES.get(word, word)
    own = FORMATS[_word(to)].endings
    # "stp" is asked for by its ending, "mjcf" by its name: MuJoCo's files end in .xml
    return ending if ending in own and ending[1:] not in FORMATS else own[0]


def _word(to: str) -> str:
    """The word of `FORMATS` for a kind of file, asked for by it or by an ending."""
    word = to.lower().removeprefix(".")
    word = ALIASES.get(word, word)
    known = {ending[1:]: name for name, form in FORMATS.items() for ending in form.endings}
    if word not in known:
        help_on = f"{INSTEAD[word]}; " if word in INSTEAD else suggestion(word, [*FORMATS, *ALIASES])
        raise RequestError(f"to: {shown(to)} is not a format; {help_on}allowed: {', '.join(FORMATS)}")
    return known[word]


def _check_choices(
    word: str,
    form: Format,
    circuit: int | None,
    at: float | None,
    branch: int | None,
    units: str | None,
    drive: str | None,
) -> None:
    drives = form.drives if isinstance(form, Bodies) else ()
    if drive is not None:
        if not drives:
            raise RequestError(f"drive: {word} has no actuator; leave it out, or give mjcf")
        check_word("drive", drive, drives)
    if units is not None:
        check_word("units", units, ("file", "si"))
    if isinstance(form, Table):
        for name, value in (("circuit", circuit), ("at", at), ("branch", branch)):
            if value is not None:
                raise RequestError(f"{name}: {word} holds all rows of all circuits; leave it out")
    elif units is not None:
        raise RequestError(f"units: the units of {word} are fixed; leave it out")


def _files(word: str, target: Path) -> list[Path]:
    if word != "urdf":
        return [target]
    from sevenbar.export.urdf import loop_file

    return [target, loop_file(target)]


def __dir__() -> list[str]:
    return sorted(__all__)
