"""The page on rewritten linkages, from what was compared: it has no number that the run did not count."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from evidence.circumstances import in_words
from evidence.markdown import table
from evidence.rewritten.families import LATTICE

#: Differences of a family that the page lists; of those that have a reason, so many for each.
LISTED, EXAMPLES = 12, 2

#: How names of families begin that have a line of the table to themselves, and what the others are called.
KINDS, OTHERS = ("planar", "slider-crank", "spherical", "gallery", "lattice"), "other loops"


@dataclass
class Compared:
    """What was seen of a drawing: its ways, what differs without a reason and by reason, and its time [s]."""

    name: str
    ways: int = 0
    moves: bool = False
    differences: list[str] = field(default_factory=list)
    explained: dict[str, list[str]] = field(default_factory=dict)
    seconds: float = 0.0

    def with_reason(self) -> list[str]:
        """Each reason once, with how many answers differ for it and the first of them."""
        return [
            f"{why} ({len(lines)} answer{'s' * (len(lines) > 1)}, as {'; '.join(lines[:EXAMPLES])})"
            for why, lines in self.explained.items()
        ]


def recorded(record: Path | None) -> dict[str, list[Compared]]:
    """What a record holds, by the name of the family; nothing where there is no file yet."""
    rows: dict[str, list[Compared]] = {}
    if record is not None and record.exists():
        for line in record.read_text(encoding="utf-8").splitlines():
            kept = json.loads(line)
            rows.setdefault(kept.pop("family"), []).append(Compared(**kept))
    return rows


def keep(record: Path, family: str, one: Compared) -> None:
    """Writes a line to a record."""
    with record.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"family": family, **asdict(one)}) + "\n")


def _left(found: Sequence[Compared]) -> str:
    """Which loops of the lattice were compared, where not all were."""
    numbers = sorted({int(one.name.split()[-1]) for one in found})
    if len(numbers) in (0, LATTICE):
        return ""
    spans: list[list[int]] = []
    for number in numbers:
        if spans and spans[-1][1] == number - 1:
            spans[-1][1] = number
        else:
            spans.append([number, number])
    words = ", ".join(str(a) if a == b else f"{a} to {b}" for a, b in spans)
    return f" (of {LATTICE:,}, those numbered {words}; the others were not compared)"


def written(rows: Mapping[str, Sequence[Compared]], made: Mapping[str, Any]) -> str:
    """The page as Markdown."""
    parts: dict[str, list[Compared]] = {}
    for name, found in rows.items():
        kind = name.split()[0].rstrip(",")
        parts.setdefault(kind if kind in KINDS else OTHERS, []).extend(found)
    every = [one for found in rows.values() for one in found]
    least = min((one.ways for one in every), default=0)
    lines = [
        "# One linkage, written in many ways",
        "",
        "A linkage does not know how it is written. Turned, moved a hundred of its sizes off, mirrored, "
        "a millionth to a million times as large, with axes reversed or places moved along them, from the "
        "other end, from each other joint on, as rows in place of axes: motion type, circuits, limits, "
        "ranges, dead centres, change points, mobility, four-bar, transmission angle, extremes and "
        "completeness must be the same.",
        "",
        f"`python -m evidence.rewritten` writes this page ({in_words(made)}; seed {made['seed']}).",
        "",
        f"{len(rows) - ('lattice' in rows)} named linkages, {len(rows.get('lattice', ()))} random loops with "
        f"places and axes in whole numbers{_left(rows.get('lattice', ()))}; "
        f"{sum(one.ways for one in every):,} ways, at least {least} each, "
        f"{sum(one.seconds for one in every) / 60:.0f} min of processor time. "
        f"Linkages that differ without a known reason: {sum(bool(one.differences) for one in every)}.",
        "",
        table(
            ["family", "linkages", "move", "ways", "differ", "differ with a reason"],
            [
                [
                    name,
                    str(len(found)),
                    str(sum(one.moves for one in found)),
                    f"{sum(one.ways for one in found):,}",
                    str(sum(bool(one.differences) for one in found)),
                    str(sum(bool(one.explained) for one in found)),
                ]
                for name, found in parts.items()
            ],
        ),
        "",
    ]
    kinds: dict[str, Callable[[Compared], list[str]]] = {
        "Differences": lambda one: one.differences,
        "Differences with a reason": Compared.with_reason,
    }
    for heading, lines_of in kinds.items():
        differ = [
            (name, one, lines_of(one)) for name, found in rows.items() for one in found if lines_of(one)
        ]
        lines += [f"## {heading}", ""] + ([] if differ else ["None.", ""])
        for name, one, own in differ:
            lines += [f"- {one.name if name == 'lattice' else name}: {'; '.join(own[:LISTED])}"]
            if len(own) > LISTED:
                lines[-1] += f"; {len(own) - LISTED} more"
        lines += [""] * bool(differ)
    return "\n".join(lines)
