"""A want or a must of a design is one file: nothing else of the package knows any of them by name."""

import ast
import inspect
from pathlib import Path

import pytest

from places import PACKAGE, ROOT
from sevenbar.design.task.file.schema import MUSTS as MUST_FORMS
from sevenbar.design.task.file.schema import WANTS as WANT_FORMS
from sevenbar.design.task.musts import MUSTS
from sevenbar.design.task.task import Must, MustForm, SampledWant, Want, WantForm
from sevenbar.design.task.wants import WANTS

TASK = PACKAGE / "design" / "task"

KINDS = [*WANTS, *MUSTS]

#: Words and keys of one kind that mean something else, too: faults of the search, dimensions, columns of tables.
COMMON = {
    "angle",
    "box",
    "figure",
    "input",
    "length",
    "link",
    "output",
    "pairs",
    "points",
    "unit",
    "value",
    "want",
    "x",
    "y",
}

#: Who makes tasks of certain wants, as users do: by the public names.
PRESETS = {"synthesis/function/generation.py", "synthesis/path/task.py", "exact/starts.py"}

#: The public names, and the two registries.
REGISTRIES = {TASK / "__init__.py", TASK / "wants" / "__init__.py", TASK / "musts" / "__init__.py"}


def names_in(path):
    """The names that a module uses, and its texts that are one word."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Name):
            found.add(node.id)
        elif isinstance(node, ast.Attribute):
            found.add(node.attr)
        elif isinstance(node, ast.alias):
            found.add(node.name)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.isidentifier():
            found.add(repr(node.value))
    return found


def words_of(kind):
    """The words of a kind in files that are no other's: its own and its keys."""
    own = {word for word, form in [*WANT_FORMS.items(), *MUST_FORMS.items()] if form is kind.form}
    keys = {
        key
        for form in (*WANT_FORMS.values(), *MUST_FORMS.values())
        if form is not kind.form
        for key in form.model_fields
    }
    return {word for word in own | set(kind.form.model_fields) if word not in keys | COMMON}


def test_each_kind_is_registered_once():
    assert len(set(KINDS)) == len(KINDS)
    for base, registry, forms in ((Want, WANTS, WANT_FORMS), (Must, MUSTS, MUST_FORMS)):
        assert list(forms.values()) == [kind.form for kind in registry]
        found, todo = set(), [base]
        while todo:
            todo += (below := todo.pop().__subclasses__())
            found |= {one for one in below if not inspect.isabstract(one)}
        assert found == set(registry)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_kind_has_all_that_is_its_own_in_its_file(kind):
    file = inspect.getsourcefile(kind)
    assert inspect.getsourcefile(kind.form) == file
    own = [kind.form.want if issubclass(kind, Want) else kind.form.must, kind.flaws, kind.words]
    own += [kind.in_loop] if issubclass(kind, SampledWant) else []
    own += [kind.slacks] if hasattr(kind, "slacks") else []
    assert {inspect.getsourcefile(one) for one in own} == {file}
    assert issubclass(kind.form, WantForm if issubclass(kind, Want) else MustForm)
    # no other kind is in it
    assert [other for other in KINDS if inspect.getsourcefile(other) == file] == [kind]
    assert not kind.__abstractmethods__


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: path.stem)
def test_nobody_else_names_a_kind(path):
    if path in REGISTRIES:
        return
    used = names_in(path)
    for kind in KINDS:
        if Path(inspect.getsourcefile(kind)) == path:
            continue
        inside = path.is_relative_to(PACKAGE / "design" / "task")
        preset = path.is_relative_to(PACKAGE / "design") and not inside
        preset = preset and path.relative_to(PACKAGE / "design").as_posix() in PRESETS
        names = {kind.form.__name__} | (set() if preset else {kind.__name__})
        # words of the file in the design of tasks, where they can mean nothing else
        names |= set(map(repr, words_of(kind))) if inside else set()
        assert not names & used, path.relative_to(ROOT)
