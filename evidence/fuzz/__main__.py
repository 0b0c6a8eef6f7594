"""`python -m evidence.fuzz run`: linkages and files by the million; `replay FILE`: one finding again."""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
from pathlib import Path

#: Seconds between two lines on how far a run is.
TELLING = 30.0


def main() -> int:
    """Runs what the command line requests; 1 where something was found."""
    from evidence.fuzz.ways import WAYS

    parser = argparse.ArgumentParser(prog="python -m evidence.fuzz", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="draw and judge; goes on where the same run was stopped")
    run.add_argument("--linkages", type=int, default=1_000_000)
    run.add_argument("--files", type=int, default=10_000_000)
    run.add_argument("--threads", type=int, default=2, help="worker processes")
    run.add_argument("--seed", type=int, default=1)
    run.add_argument("--again", nargs="+", default=[], choices=WAYS, help="ways to do anew after a change")
    run.add_argument("--page", action="store_true", help="write docs/hard-use.json and docs/hard-use.md")
    replay = commands.add_parser("replay", help="judge the case of a finding again")
    replay.add_argument("file", type=Path)
    given = parser.parse_args()
    return _replay(given.file) if given.command == "replay" else _run(given)


def _run(given: argparse.Namespace) -> int:
    from evidence import ROOT
    from evidence.fuzz.page import written
    from evidence.fuzz.summary import SUMMARY, Run

    run = Run(given.linkages, given.files, given.seed, given.threads)
    run.forget(given.again)
    start = told = time.monotonic()
    total = run.linkages + run.files

    def tell(words: str | None) -> None:
        nonlocal told
        now = time.monotonic()
        if words is None and now - told > TELLING:
            done = sum(tally.cases for tally in run.tallies.values())
            words = f"{done:,} of {total:,} cases after {(now - start) / 60:.1f} min"
            told = now
        if words is not None:
            sys.stdout.write(words + "\n")
            sys.stdout.flush()

    # a shell that runs a script starts what is in the background deaf to it
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        run.go(tell)
    except KeyboardInterrupt:
        tell("stopped; the same command goes on from here")
        return 130
    plain = run.plain()
    for way, tally in plain["ways"].items():
        tell(
            f"{way}: {tally['cases']:,} cases, slowest call {tally['slowest'][0]:.2f} s, found "
            f"{tally['found'] or 'nothing'}"
        )
    if given.page:
        SUMMARY.write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")
        (ROOT / "docs" / "hard-use.md").write_text(written(plain), encoding="utf-8")
    return int(any(tally["found"] for tally in plain["ways"].values()))


def _replay(path: Path) -> int:
    from evidence.fuzz.tally import Finding
    from evidence.fuzz.ways import again

    kept = json.loads(path.read_text(encoding="utf-8"))
    seen = again(Finding(**{key: kept[key] for key in ("way", "index", "what", "detail", "content")}))
    for finding in seen.findings:
        sys.stdout.write(f"again: {finding.what}\n{finding.detail}")
    if not seen.findings:
        sys.stdout.write(f"no longer: {kept['what']}\nnow: {', '.join(seen.seen)}\n")
    return int(bool(seen.findings))


if __name__ == "__main__":
    sys.exit(main())
