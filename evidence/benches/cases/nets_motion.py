"""Whole motions of nets, and what the command `analyze` does of one."""

from __future__ import annotations

from collections.abc import Callable

import sevenbar as sb
from evidence.benches.harness import Work, compare
from evidence.benches.outcome import Cell, Table, timed
from evidence.benches.setting import Setting

SAMPLES = 360


def motions(setting: Setting) -> Table:
    """All circuits of each net of the gallery."""
    names = sb.gallery.nets()
    circuits, words = {}, {}
    works = []
    for name in names:
        linkage = sb.load(name)
        motion = linkage.motion(SAMPLES)
        circuits[name], words[name] = len(motion), motion.completeness
        works.append(Work(name, lambda linkage=linkage: linkage.motion(SAMPLES)))  # type: ignore[misc]
    rows: list[list[Cell]] = []
    for timing in compare(works, rounds=setting.choose(7, 1)):
        count = circuits[timing.who]
        times = [1e3 * value for value in (timing.median, timing.low, timing.high)]
        rows.append([timing.who, words[timing.who], float(count), *times, times[0] / count, ""])
    columns = ["", "circuits are", "circuits", "ms", "from", "to", "ms a circuit", "note"]
    return Table(f"All circuits, {SAMPLES} inputs in a turn", columns, rows)


def analyses(setting: Setting) -> Table:
    """`sevenbar analyze` of a planar four-bar and of nets, in one process."""
    works = [Work(name, analysis(name)) for name in ("planar_4r", "watt", "jansen")]
    return timed("sevenbar analyze", "ms a linkage", compare(works, rounds=setting.choose(15, 3)))


def analysis(name: str) -> Callable[[], str]:
    """What the command does and prints."""
    from typer.testing import CliRunner

    from sevenbar.commands.cli import app

    runner = CliRunner()

    def call() -> str:
        result = runner.invoke(app, ["analyze", name])
        assert result.exit_code == 0, result.output
        return result.output

    return call
