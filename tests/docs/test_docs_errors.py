"""The page on errors: every message on it is what the program says today, and no word is left out."""

import doctest
import re
import shlex
import shutil
import sys

import pytest

from places import ROOT
from sevenbar import errors
from sevenbar.commands import cli
from sevenbar.kinematics.circuits.circuit_values import SPIN_UNDEFINED, STATUSES
from sevenbar.reporting.facts import COMPLETE

PAGE = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")

#: A file of the page, or a call of a command with all that it says.
_STEP = re.compile(
    r"^```(?:toml|text) (?P<file>\S+)\n(?P<content>.*?)^```$"
    r"|^    \$ sevenbar (?P<words>[^\n]*?)(?:  +# without (?P<without>\w+))?\n(?P<said>(?:    sevenbar: [^\n]*\n)*)",
    flags=re.MULTILINE | re.DOTALL,
)


def calls():
    """Each call with the files that stand above it on the page."""
    files = {}
    for step in _STEP.finditer(PAGE):
        if step["file"]:
            files[step["file"]] = step["content"]
        else:
            call = (dict(files), step["words"], step["without"], step["said"])
            yield pytest.param(*call, id=step["words"])


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    """A call of the program in a folder with the examples: exit code, output, messages."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("*.ipynb"))
    monkeypatch.chdir(tmp_path)

    def called(*words):
        monkeypatch.setattr("sys.argv", ["sevenbar", *words])
        with pytest.raises(SystemExit) as left:
            cli.main()
        return left.value.code, *capsys.readouterr()

    return called


@pytest.mark.parametrize(("files", "words", "without", "said"), list(calls()))
def test_a_command_of_the_page_says_what_the_page_shows(
    call, tmp_path, monkeypatch, files, words, without, said
):
    for name, content in files.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    if without:
        monkeypatch.setitem(sys.modules, without, None)
    before = sorted(tmp_path.rglob("*"))
    assert said
    code, printed, told = call(*shlex.split(words))
    # before it there may be what long work was about, as "searching .. "
    messages = re.sub(r"\A\w+ing [^\n]* \.\.\n", "", told)
    assert (code, printed, messages) == (2, "", re.sub("^    ", "", said, flags=re.MULTILINE))
    assert sorted(tmp_path.rglob("*")) == before


def test_the_page_has_calls_of_every_sort():
    assert len(list(calls())) > 40


def test_a_line_that_is_not_toml_is_told_as_the_page_shows(call, tmp_path):
    rows = re.findall(r"^\| `(.*?)` \| `(line 2: .*)` \|$", PAGE, flags=re.MULTILINE)
    assert len(rows) == 5
    for line, message in rows:
        (tmp_path / "slip.toml").write_text(f"format = 1\n{line}\n", encoding="utf-8")
        assert call("analyze", "slip.toml") == (2, "", f"sevenbar: slip.toml: {message}\n")


def test_the_python_calls_of_the_page_raise_what_it_shows():
    text = "\n".join(re.findall(r"```python\n(>>> .*?)```", PAGE, flags=re.DOTALL))
    example = doctest.DocTestParser().get_doctest(text, {}, "errors.md", None, 0)
    told = doctest.DocTestRunner(verbose=False).run(example)
    assert told.attempted >= 10
    assert told.failed == 0


def test_every_class_of_error_has_its_row_and_an_example():
    raised = {
        name
        for name, thing in vars(errors).items()
        if isinstance(thing, type) and issubclass(thing, Exception) and not issubclass(thing, Warning)
    }
    rows = set(re.findall(r"^\| \[`(\w+)`\]\(#", PAGE, flags=re.MULTILINE))
    assert rows == raised - {"SevenbarError"}


def test_every_status_and_every_word_of_completeness_is_explained():
    def words(heading):
        section = PAGE.split(f"### {heading}\n")[1].split("\n#")[0]
        return re.findall(r"^\| `([\w-]+)` \|", section, flags=re.MULTILINE)

    assert set(words("Statuses")) == {*STATUSES, SPIN_UNDEFINED}
    assert set(words("Completeness")) == set(COMPLETE)
