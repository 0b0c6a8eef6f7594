"""`python -m evidence.accuracy`: measures, and writes the results, the page and its figures."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from evidence import ROOT
from evidence.accuracy import figures, page, run
from sevenbar.description import gallery

#: What the results keep in all digits.
WHOLE = ("input", "ours", "steps", "distances")


def shortened(value: Any, key: str = "") -> Any:
    """Results whose errors have four digits; inputs keep all of theirs, so that rows can be found again."""
    if isinstance(value, dict):
        return {name: shortened(part, name) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [shortened(part, key) for part in value]
    return float(f"{value:.4g}") if isinstance(value, float) and key not in WHOLE else value


def as_json(results: figures.Results) -> str:
    """JSON with a line for each part of a section, so that a change of one linkage is one of its lines."""
    sections = []
    for section, parts in results.items():
        short = (",", ":")
        lines = [f"{json.dumps(name)}:{json.dumps(part, separators=short)}" for name, part in parts.items()]
        sections.append(f"{json.dumps(section)}: {{\n" + ",\n".join(lines) + "\n}")
    return "{\n" + ",\n".join(sections) + "\n}\n"


def written(results: figures.Results, folder: Path | None) -> list[Path]:
    """Results, page and figures: in their places in the source tree, or all in one folder."""
    results = shortened(results)
    if folder is None:
        kept, text, images = (
            ROOT / "evidence" / "accuracy" / "results.json",
            ROOT / "docs" / "accuracy.md",
            ROOT / "docs",
        )
    else:
        kept, text, images = folder / "results.json", folder / "accuracy.md", folder
    images = images / "images"
    images.mkdir(parents=True, exist_ok=True)
    kept.write_text(as_json(results), encoding="utf-8")
    text.write_text(page.text(results), encoding="utf-8")
    return [kept, text, *figures.write(results, images)]


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m evidence.accuracy", description=__doc__)
    parser.add_argument(
        "--only", action="append", metavar="NAME", help="a linkage of the gallery; may be repeated"
    )
    parser.add_argument("--quick", action="store_true", help="few rows: to see that it runs")
    parser.add_argument("--processes", type=int, help="how many at once; one for each core if not given")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="a folder for all files; without, a full run writes evidence/accuracy/results.json and "
        "docs/accuracy.md, any other build/accuracy",
    )
    parser.add_argument("--page", type=Path, metavar="JSON", help="measure nothing: the page of kept results")
    given = parser.parse_args(arguments)
    known = gallery.loops()
    for name in given.only or ():
        if name not in known:
            parser.error(f"--only: no linkage '{name}' in the gallery; give one of {', '.join(known)}")
    if given.processes is not None and given.processes < 1:
        parser.error(f"--processes: {given.processes} is no number of processes; give 1 or more")
    folder = given.out
    if given.page is not None:
        try:
            results = json.loads(given.page.read_text(encoding="utf-8"))
        except (OSError, json.JSONDecodeError) as error:
            parser.error(f"--page: {given.page}: {error}; give a results.json of this command")
        if not isinstance(results, dict) or not {"made", "settings", "rows"} <= set(results):
            parser.error(f"--page: {given.page}: no results; give a results.json of this command")
    else:
        # a part of the gallery, or few rows, is not for the page
        if folder is None and (given.quick or given.only):
            folder = ROOT / "build" / "accuracy"
        names = [name for name in known if given.only is None or name in given.only]
        results = run.results(names, run.QUICK if given.quick else run.FULL, processes=given.processes)
    for path in written(results, folder):
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
