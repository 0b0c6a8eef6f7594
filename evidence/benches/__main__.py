"""Runs the cases, each in a process of its own, and writes the JSON, the figures and the page.

python -m evidence.benches [--only CASE ..] [--quick] [--install]
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from evidence import ROOT
from evidence.benches.cases import CASES, case
from evidence.benches.outcome import Outcome
from evidence.benches.page import write
from evidence.benches.peers import Peer, installed, looked_at, of_text, requirements, to_text
from evidence.benches.setting import Setting
from evidence.circumstances import circumstances

RESULTS = ROOT / "evidence" / "benches" / "results.json"

#: Libraries that would start threads of their own have one; nothing comes from what an earlier run derived.
ALIKE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1") | {
    "SSIK_DERIVATION_CACHE": "off"
}

#: Longest time [s] of one case; more, and it hangs.
LONGEST_CASE = 900.0


def main() -> None:
    """All that was requested; ends with 1 where a case failed."""
    arguments = parsed()
    if arguments.child:
        setting = Setting(of_text(sys.stdin.read()), arguments.quick)
        arguments.to.write_text(json.dumps(case(arguments.child).run(setting).to_json()), encoding="utf-8")
        return
    names = requirements()
    reasons = installed(names) if arguments.install else {}
    peers = [looked_at(name, reasons.get(name, "")) for name in names]
    made = circumstances() | {"kind": "quick" if arguments.quick else "full"}
    cases: dict[str, Any] = {}
    if arguments.only and arguments.results.exists():
        cases = json.loads(arguments.results.read_text(encoding="utf-8"))["cases"]
    failed = []
    for name in arguments.only or CASES:
        start = time.perf_counter()
        outcome = in_a_process(name, peers, quick=arguments.quick)
        print(f"{name}: {time.perf_counter() - start:.0f} s {outcome.failure}".rstrip(), file=sys.stderr)
        failed += [name] if outcome.failure else []
        cases[name] = outcome.to_json() | {"made": made["date"]}
    kept = {name: cases[name] for name in CASES if name in cases}
    results = {"made": made, "peers": [vars(peer) for peer in peers], "cases": kept}
    arguments.results.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    write(results, arguments.page)
    if failed:
        sys.exit(f"cases that failed: {', '.join(failed)}")


def parsed() -> argparse.Namespace:
    """The arguments."""
    parser = argparse.ArgumentParser(
        prog="python -m evidence.benches", description="Sevenbar beside its peers."
    )
    parser.add_argument("--only", nargs="+", choices=CASES, metavar="CASE", help=", ".join(CASES))
    parser.add_argument("--quick", action="store_true", help="a minute, to see that all of it runs")
    parser.add_argument("--install", action="store_true", help="install the peers first, one by one")
    parser.add_argument("--results", type=Path, default=RESULTS, help="the JSON file")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "benchmarks.md", help="the page")
    parser.add_argument("--child", choices=CASES, help=argparse.SUPPRESS)
    parser.add_argument("--to", type=Path, help=argparse.SUPPRESS)
    return parser.parse_args()


def in_a_process(name: str, peers: list[Peer], *, quick: bool) -> Outcome:
    """The outcome of a case; where its process failed, or a peer crashed it, what was said at the end."""
    module = case(name)
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "outcome.json"
        command = [sys.executable, "-m", "evidence.benches", "--child", name, "--to", str(target)]
        try:
            run = subprocess.run(
                [*command, "--quick"] if quick else command,
                input=to_text(peers),
                stderr=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                text=True,
                cwd=ROOT,
                env=os.environ | ALIKE,
                timeout=LONGEST_CASE,
            )
        except subprocess.TimeoutExpired:
            return Outcome(module.TITLE, module.ABOUT, failure=f"not done after {LONGEST_CASE:g} s")
        if run.returncode == 0:
            return Outcome.of_json(json.loads(target.read_text(encoding="utf-8")))
        sys.stderr.write(run.stderr)
        last = (run.stderr.strip().splitlines() or ["no word of why"])[-1]
        ended = f"ended by signal {-run.returncode}" if run.returncode < 0 else "failed"
        return Outcome(module.TITLE, module.ABOUT, failure=f"{ended}: {last}")


if __name__ == "__main__":
    main()
