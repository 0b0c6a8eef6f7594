"""The reference of the site: every public name has its place, every command its page, every key its meaning."""

import dataclasses
import importlib
import inspect
import json
import pkgutil
import re
import tomllib

import jsonschema
import pytest

import sevenbar as sb
from places import ROOT
from sevenbar import errors
from sevenbar.description import gallery
from sevenbar.description.forms import from_description
from sevenbar.description.schema import TABLES, LinkageForm, json_schema

DOCS = ROOT / "docs"
DIRECTIVE = re.compile(r"^\.\. auto(\w+):: (sevenbar[\w.]*)", flags=re.MULTILINE)


@pytest.fixture(autouse=True)
def _extensions(monkeypatch):
    monkeypatch.syspath_prepend(DOCS / "_extensions")


def looked_up(name):
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)


def told():
    """What stands on the pages of the reference: name and thing."""
    pages = sorted((DOCS / "api").glob("*.md"))
    return {name: looked_up(name) for page in pages for _, name in DIRECTIVE.findall(page.read_text("utf-8"))}


def public():
    """Every public name: of the package, of its packages, and of its modules that are imported on demand."""
    places = [sb, *map(importlib.import_module, sb._ON_DEMAND.values())]
    for module in pkgutil.walk_packages(sb.__path__, "sevenbar."):
        if module.ispkg and ".studio" not in module.name:
            places.append(importlib.import_module(module.name))
    return {
        f"{place.__name__}.{name}": getattr(place, name)
        for place in places
        for name in getattr(place, "__all__", [])
        if not inspect.ismodule(getattr(place, name))
    }


def test_every_public_name_has_a_place_in_the_reference():
    there = list(told().values())
    missing = [name for name, thing in public().items() if not any(thing is other for other in there)]
    assert missing == []
    assert len(public()) > 60


def test_every_error_has_a_place_in_the_reference():
    there = set(told())
    classes = [
        name
        for name, thing in vars(errors).items()
        if inspect.isclass(thing) and thing.__module__ == errors.__name__
    ]
    assert {f"sevenbar.errors.{name}" for name in classes} <= there


def test_a_class_that_a_public_function_gives_has_a_place_in_the_reference():
    there = {thing for thing in told().values() if inspect.isclass(thing)}
    functions = {name: thing for name, thing in told().items() if inspect.isfunction(thing)}
    missing = {
        f"{name} gives {given.__module__}.{given.__name__}"
        for name, function in functions.items()
        for word in re.findall(r"\w+", str(function.__annotations__["return"]))
        if dataclasses.is_dataclass(given := function.__globals__.get(word)) and given not in there
    }
    assert missing == set()


def test_every_command_has_a_page_that_shows_it():
    from command_tables import PAGES, all_commands, commands

    assert set(commands()) == set(PAGES)
    for words, page in PAGES.items():
        text = (DOCS / page.split("#")[0]).read_text(encoding="utf-8")
        assert re.search(rf"sevenbar {words}\b", text), f"{page} does not show sevenbar {words}"
    made = all_commands(DOCS, "")
    assert made.count("\n| `--") > 100
    assert "| `--samples` | `COUNT` | Inputs in a full turn, as in 720 or 1e5. Left out: `360`. |" in made


def test_every_key_of_a_file_has_its_meaning_on_the_page():
    from key_tables import keys_of

    page = (DOCS / "file-format.md").read_text(encoding="utf-8")
    for head in ("", *TABLES):
        assert f"<!-- made: keys{' ' + head if head else ''} -->" in page
        form = TABLES[head] if head else LinkageForm
        rows = keys_of(DOCS, head).splitlines()[2:]
        by_name = {"": ["ground", "pin"], "joint": ["between"]}
        assert [re.match(r"\| `(\w+)`", row)[1] for row in rows] == [
            *form.model_fields,
            *by_name.get(head, []),
        ]
        assert all(row.rstrip("| ").rpartition("|")[2].strip() for row in rows)
    assert "| `L1` | number > 0 or text | length | required | crank |" in keys_of(DOCS, "rssr")


def test_the_keys_of_links_by_name_have_their_meaning_on_the_page():
    from key_tables import NAMED, keys_of

    page = (DOCS / "file-format.md").read_text(encoding="utf-8")
    for head, form in NAMED.items():
        assert f"<!-- made: keys {head} -->" in page
        rows = keys_of(DOCS, head).splitlines()[2:]
        assert [re.match(r"\| `(\w+)`", row)[1] for row in rows] == [*form.model_fields]
        assert all(row.rstrip("| ").rpartition("|")[2].strip() for row in rows)
    assert "| `at` | 2 numbers | length | required | its place as drawn: x, y |" in keys_of(DOCS, "pin")


def test_the_pages_have_the_tables_that_the_program_makes():
    from written_parts import PAGES, written

    stale = []
    for page in sorted(PAGES.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        assert text.count("<!-- end -->") == len(re.findall(r"<!-- made: (?!schema|gallery )", text)), page
        if written(text) != text:
            stale.append(page.name)
    assert not stale, f"{', '.join(stale)}: run make pages"


def test_the_json_schema_takes_the_files_that_the_program_takes():
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    takes = jsonschema.Draft202012Validator(schema).is_valid
    files = [gallery.text(name) for name in gallery.names()]
    files += [path.read_text(encoding="utf-8") for path in sorted((ROOT / "examples").glob("*.toml"))]
    assert len(files) > 20
    for text in files:
        assert takes(tomllib.loads(text))
    right = tomllib.loads(gallery.text("rssr"))
    assert json.loads(json.dumps(right)) == right
    for mistake in (
        {"format": 2},
        {"length_unit": "yard"},
        {"lenght": 3},
        {"rssr": {**right["rssr"], "L1": -1}},
        {"rssr": {**right["rssr"], "M": "wide"}},
        {"joint": [{"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]}]},
        {"point": [{"name": "P", "link": 0, "at": [0, 0, 0]}]},
    ):
        assert not takes(right | mistake), mistake
        with pytest.raises(errors.DescriptionError):
            from_description(right | mistake)
