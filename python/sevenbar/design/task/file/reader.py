"""A task file read: its linkage found, values in radians and lengths, each mistake with its place."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from sevenbar.description.contradictions import FORMS
from sevenbar.description.draft import Draft
from sevenbar.description.files import near_files, toml_tables, toml_text
from sevenbar.description.gallery import names as gallery_names
from sevenbar.description.named_files import file_below
from sevenbar.description.values import TableForm
from sevenbar.design.limits import Limits
from sevenbar.design.task.contradictions import contradictions, start_flaws
from sevenbar.design.task.file.schema import LimitsForm, TaskForm, check_form
from sevenbar.design.task.given import amount
from sevenbar.design.task.musts import residuals_within
from sevenbar.design.task.task import EXACT, DesignTask, FreeNumber, Must, Want
from sevenbar.errors import (
    DescriptionError,
    Problem,
    RequestError,
    SevenbarError,
    ends_here,
    shown,
    suggestion,
)
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.single import check_single
from sevenbar.kinematics.numbers.dimensions import check_apart
from sevenbar.text.paths import is_file, is_folder, is_there


@dataclass(frozen=True, eq=False)
class TaskFile:
    """A task as its file has it: its `name`, where it came from, and hints of what may have been meant."""

    task: DesignTask
    name: str
    source: str
    hints: tuple[str, ...] = ()


@ends_here
def read_task(path: str | os.PathLike[str], *, agree: float | None = None) -> DesignTask:
    """The design task of a TOML file, checked whole: `docs/design-task.md` has its keys.

    Redundant constraints of its linkages `agree` up to a closure error (`Linkage.agreeing`). Raises
    `DescriptionError` with every mistake, each with its place.
    """
    return task_file(path, agree=agree).task


def task_file(path: str | os.PathLike[str], *, agree: float | None = None) -> TaskFile:
    """The same with the task's name and source."""
    source = str(path)
    file = Path(path)
    if is_folder(file):
        raise DescriptionError.of_all(source, "is a folder; give the path of a task file (TOML) in it")
    if not is_file(file):
        raise DescriptionError.of_all(
            source, f"no such file; {near_files(file)}give the path of a task file (TOML)"
        )
    return task_of_text(toml_text(path), source, agree=agree)


def task_of_text(text: str, source: str, *, agree: float | None = None) -> TaskFile:
    """The task of a TOML text; files that it names lie below its folder, that of `source`."""
    raw = toml_tables(text, source)
    folder = Path(source).parent
    draft = _draft(raw, source, folder, agree)
    check_single(draft.linkage)
    form = check_form(raw, draft.linkage.length_unit, source)
    mistakes = _Mistakes()
    with mistakes.of("follow"):
        draft = draft.giving(form.free).holding(form.follow or ())
    free = _free(draft, form, mistakes)
    wants, exact = _wants(draft.linkage, form, folder, mistakes)
    # a want that is wrong moves the places of those behind it
    known = wants if len(wants) == len(form.want) else []
    musts = [*_musts(draft.linkage, form, known, mistakes), *exact]
    limits = Limits()
    with mistakes.of("limits", LimitsForm):
        unit, size = draft.linkage.length_unit, form.limits.size
        ends = size and (amount("size", size[0], unit), amount("size", size[1], unit))
        limits = Limits(form.limits.transmission, ends, form.limits.motion_type)
    if not mistakes.found:
        task = DesignTask(
            draft,
            tuple(free),
            tuple(wants),
            tuple(musts),
            form.placement,  # type: ignore[arg-type]
            form.goal,  # type: ignore[arg-type]
            limits,
            form.follow or (),
        )
        mistakes.found += list(contradictions(task)) or list(start_flaws(task))
    if mistakes.found:
        raise DescriptionError(list(dict.fromkeys(mistakes.found)), source)
    return TaskFile(task, form.name or draft.linkage.heading, source, tuple(_hints(form)))


def _hints(form: TaskForm) -> Iterator[str]:
    for i, want in enumerate(form.want):
        for key, hint in want.hints():
            yield f"want[{i + 1}].{key}: {hint}"


class _Mistakes:
    """The mistakes of a file as they are found."""

    def __init__(self) -> None:
        self.found: list[Problem] = []

    @contextmanager
    def of(self, place: str, form: type[TableForm] | None = None) -> Iterator[None]:
        """Keeps what is wrong with a table: a message that begins with a key of its form is of that key."""
        try:
            yield
        except SevenbarError as error:
            key, colon, message = str(error).partition(": ")
            if colon and form is not None and key.partition("[")[0] in form.model_fields:
                self.found.append(Problem(f"{place}.{key}", message))
            else:
                self.found.append(Problem(place, str(error).removeprefix(f"{place}: ")))


def _draft(raw: dict[str, Any], source: str, folder: Path, agree: float | None) -> Draft:
    """The linkage that a task is about; `DescriptionError` where there is none."""
    given = raw.get("linkage")

    def wrong(message: str) -> DescriptionError:
        return DescriptionError([Problem("linkage", message)], source)

    if isinstance(given, dict):
        try:
            return Draft.of_tables(given, source, agree=agree)
        except DescriptionError as error:
            problems = [Problem(f"linkage.{p.place}".rstrip("."), p.message) for p in error.problems]
            raise DescriptionError(problems, source) from None
    if given is None and raw.keys() & set(FORMS):
        what = "is a linkage file and not a task; a task names its linkage, as in"
        raise DescriptionError.of_all(
            source, f"{what} linkage = {shown(Path(source).name)}, with [free] and [[want]]"
        )
    if not isinstance(given, str) or not given.strip():
        what = "is missing" if given is None else f"{shown(given)} is none"
        hint = (
            "give a file in the folder of this one, as in 'rssr.toml', a name of the gallery, "
            "or a table [linkage]"
        )
        raise wrong(f"{what}; {hint}")
    name = given.strip()
    try:
        path = file_below(folder, name, "rssr.toml")
    except RequestError as error:
        raise wrong(str(error)) from None
    if not is_there(path) and name in gallery_names():
        return Draft.of(toml_text(name), name, agree=agree)
    if not is_file(path):
        near = suggestion(name, gallery_names())
        raise wrong(
            f"{shown(name)}: no such file in the folder of this one, nor such a name in the gallery; {near}"
            "give one"
        )
    return Draft.of(toml_text(path), str(path), agree=agree)


def _free(draft: Draft, form: TaskForm, mistakes: _Mistakes) -> list[FreeNumber]:
    """The free numbers in the order of the linkage's file; a name goes before a pattern."""
    every = [*(d for d in draft.dimensions if d.kind != "speed"), *draft.masses]
    chosen: dict[str, tuple[str, FreeNumber]] = {}
    for name, ends in sorted(form.free.items(), key=lambda item: _is_pattern(item[0])):
        with mistakes.of(f"free.{name}"):
            result = [d for d in every if name in (d.name, d.key) or fnmatchcase(d.name, name)]
            if not result:
                known = [d.name for d in (*draft.lengths, *every)]
                raise RequestError(
                    f"is not a number of the linkage; {suggestion(name, known)}give some of "
                    f"{', '.join(known)}, or a pattern as 'L*'"
                )
            if len({d.unit for d in result}) > 1 and any(isinstance(end, str) for end in ends):
                raise RequestError("names numbers of several units; give them one by one")
            for d in result:
                low, high = (d.read(end) if isinstance(end, str) else end for end in ends)
                if d.name not in chosen:
                    chosen[d.name] = name, FreeNumber(d.name, low, high)
                elif _is_pattern(chosen[d.name][0]):
                    raise RequestError(f"{d.name} is matched by '{chosen[d.name][0]}', too; leave one out")
    with mistakes.of("free"):
        check_apart("free", [d for d in every if d.name in chosen])
    return [chosen[d.name][1] for d in every if d.name in chosen]


def _is_pattern(name: str) -> bool:
    return any(sign in name for sign in "*?[")


def _wants(
    linkage: Linkage, form: TaskForm, folder: Path, mistakes: _Mistakes
) -> tuple[list[Want], list[Must]]:
    """The wants, and that some of them are met exactly."""
    wants: list[Want] = []
    exact: list[Must] = []
    for i, one in enumerate(form.want):
        with mistakes.of(f"want[{i + 1}]", type(one)):
            wants.append(one.want(linkage, folder))
            if one.is_exact:
                exact.append(residuals_within(i, EXACT))
    return wants, exact


def _musts(linkage: Linkage, form: TaskForm, wants: list[Want], mistakes: _Mistakes) -> list[Must]:
    result: list[Must] = []
    for i, one in enumerate(form.must):
        with mistakes.of(f"must[{i + 1}]", type(one)):
            result.append(one.must(linkage, wants))
    return result
