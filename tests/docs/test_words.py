"""Words that the glossary rules out: none in the pages, and in the sources their number only falls.

python tests/docs/test_words.py           prints how often each is in the sources, for ALLOWED
python tests/docs/test_words.py told      prints the places of one
"""

import io
import re
import sys
import tokenize
from collections import Counter
from pathlib import Path

import pytest

from places import ROOT

#: Each word that is not used, as it is found; docs/glossary.md has what is written in its place.
WORDS = {
    "told": r"told|untold|tells|telling",
    "comes to": r"(?:come|comes|came|coming) to",
    "misfit": r"misfits?",
    "established": r"established|establishes",
    "stands": r"(?:stands|stood)(?! (?:still|for)(?![a-z]))",
    "beside": r"beside",
    "but for": r"but for",
    "parts of": r"in parts of|parts of the size",
    "looks": r"looks|looked",
    "hard use": r"hard use|hard-use|hard_use",
    "asks of": r"ask(?:s|ed)? (?:of|for)",
    "is said": r"(?:is|are) said",
}

#: Pages whose words come from another place: from results, from the program, from the changes as they were written.
MADE = ("accuracy.md", "benchmarks.md", "hard-use.md", "changelog.md", "modules.md")

#: How often each word may still be in the sources. A smaller number is always right; none may grow.
ALLOWED = {
    "told": 74,
    "comes to": 14,
    "misfit": 0,
    "established": 0,
    "stands": 64,
    "beside": 148,
    "but for": 3,
    "parts of": 38,
    "looks": 68,
    "hard use": 8,
    "asks of": 36,
    "is said": 0,
}

#: Names that the glossary for code in CONTRIBUTING.md rules out, and how often each may still be one in the package.
NAMES = {
    "found": 81,
    "own": 1126,
    "way": 377,
    "given": 402,
    "kept": 81,
    "left": 211,
    "room": 108,
    "wish": 101,
    "begun": 0,
}


def found(word: str, text: str) -> list[re.Match[str]]:
    """Where a word is in a text, as a part of a name too; a space may be the end of a line, with the mark of a comment."""
    pattern = WORDS[word].replace(" ", r"(?:\s|#:?|//[/!]?)+")
    return list(re.finditer(rf"(?<![A-Za-z])(?:{pattern})(?![a-z])", text, re.IGNORECASE))


def prose(page: str) -> str:
    """A page without code, output, formulas and addresses."""
    page = re.sub(r"^```.*?^```|^\$\$.*?^\$\$", "", page, flags=re.MULTILINE | re.DOTALL)
    page = re.sub(r"^(?:    |\t).*$", "", page, flags=re.MULTILINE)
    return re.sub(r"`[^`\n]*`|\$[^$\n]*\$|\]\([^)]*\)|https?:\S+", " ", page)


def pages() -> list[Path]:
    """The pages written by hand, in English."""
    docs = [*(ROOT / "docs").glob("*.md"), *(ROOT / "docs" / "api").glob("*.md")]
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(p for p in docs if p.name not in MADE)]


def sources() -> list[Path]:
    """What is written for the program, its evidence and its site; tests have names of their own."""
    rust = (ROOT / "crates").rglob("src/**/*.rs")
    folders = ("python/sevenbar", "evidence", "accuracy", "benches", "fuzz", "docs/_extensions")
    return sorted([*rust, *(path for name in folders for path in (ROOT / name).rglob("*.py"))])


def places(word: str) -> list[str]:
    """Each place of a word in the sources, with its line."""
    lines = []
    for path in sources():
        text = path.read_text(encoding="utf-8")
        for match in found(word, text):
            number = text.count("\n", 0, match.start()) + 1
            line = text.splitlines()[number - 1].strip()
            lines.append(f"{path.relative_to(ROOT).as_posix()}:{number}: {line}")
    return lines


def test_the_pages_have_none_of_the_words_that_the_glossary_rules_out():
    there = Counter()
    for page in pages():
        text = prose(page.read_text(encoding="utf-8"))
        if page.name == "glossary.md":
            text = text.partition("## Words we do not use")[0]
        for word in WORDS:
            there[page.name, word] += len(found(word, text))
    assert +there == Counter()


def test_names_that_the_glossary_for_code_rules_out_only_fall():
    there = Counter()
    for path in (ROOT / "python" / "sevenbar").rglob("*.py"):
        with io.StringIO(path.read_text(encoding="utf-8")) as text:
            there.update(
                token.string
                for token in tokenize.generate_tokens(text.readline)
                if token.type == tokenize.NAME
            )
    plurals = {"way": "ways", "room": "rooms"}
    counts = {name: there[name] + there[plurals.get(name, "")] for name in NAMES}
    assert {name: count for name, count in counts.items() if count > NAMES[name]} == {}


def test_the_glossary_says_what_is_written_for_each_word():
    _, _, table = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8").partition("| not | but |")
    ruled_out = " ".join(re.findall(r"^\| (.*?) \|", table, flags=re.MULTILINE))
    assert [word for word in WORDS if not found(word, ruled_out)] == []


@pytest.mark.parametrize("word", WORDS)
def test_the_sources_have_no_more_of_a_word_than_before(word):
    there = places(word)
    assert len(there) <= ALLOWED[word], "\n".join(there)


def test_words_are_found_in_prose_and_in_names_and_not_in_other_words():
    assert (
        len(found("told", "It is told, untold; _told(told_input), MOST_TOLD, but tolerance and retold")) == 5
    )
    assert len(found("comes to", "what it comes\n    # to, and came to")) == 2
    assert not found("stands", "the input stands still, it stands for a word, it understands")
    assert prose("a `told` word\n\n    told in a box\n```\ntold\n```\n").split() == ["a", "word"]


if __name__ == "__main__":
    asked = sys.argv[1:] or list(WORDS)
    for word in asked:
        lines = places(word)
        sys.stdout.write(
            "\n".join(lines) + "\n" if sys.argv[1:] else f"    {word!r}: {len(lines)},\n".replace("'", '"')
        )
