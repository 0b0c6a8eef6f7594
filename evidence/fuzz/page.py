"""The page on hard use, from the summary of a run: it has no number that the run did not count."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from evidence.circumstances import in_words
from evidence.fuzz import batches, checks, files
from evidence.markdown import table

#: Rows of a table at most; what is left is one row more.
MOST_ROWS = 16

#: What goes each way, in words.
TOLD = {
    "rssr batch": f"RSSRs in batches of the core: types, limits, measures; one in {batches.RSSRS_CROSSED} "
    "against its own motion",
    "loop batch": f"general loops in batches; one in {batches.LOOPS_CROSSED} against its own motion",
    "rssr": "RSSRs one by one: file, mobility, all circuits, rates to the jerk, a point, a link, "
    "measures, summary, JSON",
    "loop": "general loops one by one, the same",
    "edge": "loops at change points and beside them, in decimals, shaky, with narrow circuits, the same",
    "screw": "loops with screws, whose modes are searched: few, since they are slow",
    "file": f"mutated TOML through the loader; of those that load one in {files.COUNTED} has its mobility "
    "counted, "
    f"one in {files.ANALYSED} goes through the whole analysis",
    "table": "mutated tables of measured values and of input laws",
}


def written(plain: Mapping[str, Any]) -> str:
    """The page as Markdown."""
    ways = plain["ways"]
    parts = [
        "# Hard use",
        "Made by `make fuzz`; not edited by hand. " + _circumstances(plain),
        "Every case follows from the seed, its way and its number. Worker processes are watched: a call "
        "over its limit, a worker "
        "over its memory and a worker that dies are findings, and the run goes on without that case. A "
        "finding is kept in `evidence/fuzz/findings/` and done again by "
        "`python -m evidence.fuzz replay FILE`. A run that was stopped goes on where it was.",
        "## What was done",
        table(
            ("way", "cases", "found", "slowest call [s]", "limit [s]", "what"),
            [
                (
                    way,
                    f"{t['cases']:,}",
                    f"{sum(t['found'].values()):,}",
                    f"{t['slowest'][0]:.2f}",
                    f"{plain['limits'][way]:g}",
                    TOLD[way],
                )
                for way, t in ways.items()
            ],
        ),
        "Calls are timed and limited by their processor time, and at ten times the limit by the clock. "
        f"The most memory that a worker held was {_megabytes(plain['memory']['peak'])} MB, since a job of "
        f"`{plain['memory']['way']}` at {plain['memory']['after']:.0%} of the run.",
        "## What must hold",
        _checked(),
        "## What was found",
        _found(ways),
        "## What the linkages were",
        "Motion types, all ways together, and the rows of those that went one by one:",
        _counts(ways, "type ", "motion type"),
        _counts(ways, "row ", "status of a row"),
        "Results that report what they lack:",
        _counts(ways, "short ", "reported"),
        "Kinds of general loops:",
        _counts(ways, "kind ", "joints"),
        "## What the files came to",
        _files(ways),
        "## Not covered",
        "Nothing here proves that an answer is right: the tests do that, against closed forms, 40 digits "
        "and other programs. "
        "An interrupt stops the core within some hundredths of a second, batches too. "
        "Constraints that are redundant are taken to agree while the loop closes to 1e-9 of its size, so "
        "a row of such a loop may "
        f"keep {checks.CLOSED_REDUNDANT:g}; all other well-conditioned rows are held to {checks.CLOSED:g}.",
    ]
    return "\n\n".join(parts) + "\n"


def _circumstances(plain: Mapping[str, Any]) -> str:
    elsewhere: dict[str, list[str]] = {}
    for way, commits in plain["commits"].items():
        if commits != [plain["commit"]]:
            elsewhere.setdefault(" and ".join(commits), []).append(f"`{way}`")
    return (
        f"{in_words(plain)}. {plain['linkages']:,} linkages and {plain['files']:,} files "
        f"from seed {plain['seed']} in {plain['minutes']:.0f} minutes "
        f"on {plain['threads']} worker{'s' * (plain['threads'] != 1)}."
        + "".join(f" {' and '.join(ways)} at commit {commits}." for commits, ways in elsewhere.items())
    )


def _checked() -> str:
    lines = (
        "No panic, no exception but a `SevenbarError`, no warning, no call over its limit, no process lost.",
        "Each row with a pose closes, by the core and by a walk along the loop that shares no formula "
        f"with it: to {checks.CLOSED:g} "
        f"where its condition is below {checks.WELL:g}, to {checks.CLOSED_BADLY:g} elsewhere.",
        "No number is missing or infinite in a row whose status promises it: joint values, rates to the "
        "jerk, points, links.",
        "Limits rise and lie within a turn; the motion type fits the limits, the ranges and the circuits.",
        "A circuit whose input turns fully has its modes at any input.",
        "Each mode at an input of the rows lies on a circuit or at a change point, unless the result reports "
        "what it lacks (counted below).",
        "No well-conditioned row lies on two circuits, unless modes are reported from which no motion could "
        "be followed; no row exceeds the extremes of velocity and "
        "acceleration.",
        "The report's JSON has no NaN, its text no `nan`; measures are finite or absent.",
        "A refusal is lines of text, each with its place, printable, without words for programmers.",
        "A batch tells what each linkage's own motion tells.",
    )
    return "\n".join(f"- {line}" for line in lines)


def _found(ways: Mapping[str, Any]) -> str:
    rows = [
        (way, kind, f"{count:,}") for way, tally in ways.items() for kind, count in tally["found"].items()
    ]
    return table(("way", "finding", "cases"), rows) if rows else "Nothing."


def _counts(ways: Mapping[str, Any], prefix: str, head: str) -> str:
    every: Counter[str] = Counter()
    for way, tally in ways.items():
        if way not in ("file", "table"):
            every.update(
                {word.removeprefix(prefix): n for word, n in tally["seen"].items() if word.startswith(prefix)}
            )
    return _ranked(every, head)


def _files(ways: Mapping[str, Any]) -> str:
    parts = []
    for way in ("file", "table"):
        if way not in ways:
            continue
        seen = Counter(
            {
                word.removeprefix("refused "): n
                for word, n in ways[way]["seen"].items()
                if word.startswith("refused ")
            }
        )
        loaded = ways[way]["seen"].get("loaded", 0)
        parts.append(
            f"Of {ways[way]['cases']:,} {way}s {loaded:,} loaded; the others were refused. What is the "
            "file's own is a `~` here:"
        )
        parts.append(_ranked(seen, "message"))
    return "\n\n".join(parts)


def _ranked(counts: Counter[str], head: str) -> str:
    ranked = counts.most_common()
    # a message may hold what Markdown takes for a tag
    rows = [(word.replace("<", "&lt;"), f"{n:,}") for word, n in ranked[:MOST_ROWS]]
    rest = ranked[MOST_ROWS:]
    if rest:
        rows.append((f"{len(rest)} others", f"{sum(n for _, n in rest):,}"))
    return table((head, "cases"), rows) if rows else "None."


def _megabytes(count: int) -> str:
    return f"{count / 1e6:.0f}"
