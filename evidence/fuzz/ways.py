"""The ways in which cases are made and judged, each in jobs of consecutive numbers.

A case follows from the seed, the way and its number. A job names the case at hand before each call, so that
a call that never comes back, or takes the process with it, is known.
"""

from __future__ import annotations

import tempfile
import time
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

import sevenbar as sb
from evidence.fuzz import batches, edges, files, loops, rssrs, tables
from evidence.fuzz.checks import Broken, judged
from evidence.fuzz.messages import family, look_at
from evidence.fuzz.tally import Finding, Tally
from evidence.fuzz.toml import written
from sevenbar.description.forms import from_description
from sevenbar.errors import AngleUnitWarning, SevenbarError

#: States which case is at hand: its number, -1 for a whole batch, `None` between two.
Mark = Callable[[int | None], None]


class Job(NamedTuple):
    """Cases `first` to `last` (left out) of a way."""

    way: str
    seed: int
    first: int
    last: int


@dataclass(frozen=True)
class Way:
    """How cases of a kind are made and judged.

    `number` is part of each case's seed; `size` cases make a job; one call may take `limit` [s].
    """

    number: int
    size: int
    limit: float
    run: Callable[[Job, Tally, Mark], None]
    content: Callable[[int, int], str | bytes]
    judge: Callable[[str | bytes, int, Tally], None]


def run(job: Job, mark: Mark) -> Tally:
    """Judges the cases of a job."""
    tally = Tally()
    WAYS[job.way].run(job, tally, mark)
    return tally


def _rng(way: str, seed: int, index: int) -> np.random.Generator:
    return np.random.default_rng([seed, WAYS[way].number, index])


def _guarded(job: Job, index: int, content: str | bytes, call: Callable[[], None], tally: Tally) -> None:
    """Calls, and keeps as a finding what must not be raised; a warning counts, as a terminal shows it."""
    start = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            # a doubt about the unit of angles, which random twists give now and then
            warnings.simplefilter("ignore", AngleUnitWarning)
            call()
    except Broken as broken:
        tally.add(Finding(job.way, index, str(broken), "", _text(content)))
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic of the core is no Exception
        what = f"{type(error).__name__}: {error}".splitlines()[0]
        tally.add(Finding(job.way, index, what, traceback.format_exc(limit=-6), _text(content)))
    tally.timed(time.process_time() - start, index)


def _text(content: str | bytes) -> str:
    """Bytes as the characters of their values, so that JSON can hold them."""
    return content if isinstance(content, str) else "bytes:" + content.decode("latin-1")


def _bytes_or_text(content: str) -> str | bytes:
    return content.removeprefix("bytes:").encode("latin-1") if content.startswith("bytes:") else content


def again(finding: Finding) -> Tally:
    """Judges the case of a finding once more."""
    tally = Tally()
    job = Job(finding.way, 0, finding.index, finding.index + 1)
    content = _bytes_or_text(finding.content)
    _guarded(
        job, finding.index, content, lambda: WAYS[finding.way].judge(content, finding.index, tally), tally
    )
    tally.cases = 1
    return tally


# One by one


def _one_by_one(job: Job, tally: Tally, mark: Mark) -> None:
    way = WAYS[job.way]
    for index in range(job.first, job.last):
        mark(index)
        content = way.content(job.seed, index)
        _guarded(job, index, content, lambda c=content, i=index: way.judge(c, i, tally), tally)
        tally.cases += 1
    mark(None)


def _analysed(content: str | bytes, index: int, tally: Tally) -> None:
    """A linkage's text through the whole analysis."""
    assert isinstance(content, str)
    try:
        linkage = sb.loads(content, files.SOURCE)
        tally.seen[f"type {judged(linkage, np.random.default_rng(index), tally.seen)}"] += 1
        tally.seen[f"kind {linkage.kind}"] += 1
    except SevenbarError as error:
        source = files.SOURCE if str(error).startswith(files.SOURCE) else ""
        look_at(error, source)
        tally.seen[f"refused {family(error, source)}"] += 1


def _rssr_text(seed: int, index: int) -> str:
    rng = _rng("rssr", seed, index)
    draw = list(rssrs.FAMILIES.values())[index % len(rssrs.FAMILIES)]
    return written(rssrs.description(draw(rng, 1)[:, 0]))


def _loop_text(seed: int, index: int) -> str:
    rng = _rng("loop", seed, index)
    draw = list(loops.FAMILIES.values())[index % len(loops.FAMILIES)]
    return written(draw(rng))


def _edge_text(seed: int, index: int) -> str:
    draw = list(edges.FAMILIES.values())[index % len(edges.FAMILIES)]
    return written(draw(_rng("edge", seed, index)))


def _screw_text(seed: int, index: int) -> str:
    return written(loops.SCREWS["screws"](_rng("screw", seed, index)))


def _file(content: str | bytes, index: int, tally: Tally) -> None:
    files.judge(content, index, tally.seen)


def _table(content: str | bytes, index: int, tally: Tally) -> None:
    assert isinstance(content, bytes)
    with tempfile.TemporaryDirectory() as folder:
        tables.judge(content, index, tally.seen, Path(folder))


# In batches


def _rssr_block(seed: int, index: int) -> tuple[str, rssrs.Floats]:
    """The family of the block that a case is in, and its dimensions (6, size)."""
    size = WAYS["rssr batch"].size
    block = index // size
    name = list(rssrs.FAMILIES)[block % len(rssrs.FAMILIES)]
    return name, rssrs.FAMILIES[name](_rng("rssr batch", seed, block), size)


def _side(index: int) -> str:
    return ("crank", "rocker")[index // WAYS["rssr batch"].size // len(rssrs.FAMILIES) % 2]


def _rssr_column(seed: int, index: int) -> str:
    _, block = _rssr_block(seed, index)
    return f"# {_side(index)}\n{written(rssrs.description(block[:, index % block.shape[1]]))}"


def _rssr_batch(job: Job, tally: Tally, mark: Mark) -> None:
    mark(-1)
    name, block = _rssr_block(job.seed, job.first)
    start = job.first - job.first % block.shape[1]
    part = np.ascontiguousarray(block[:, job.first - start : job.last - start])
    side = _side(job.first)
    words: list[str] = []
    _guarded(job, job.first, "", lambda: words.extend(batches.of_rssrs(part, side)), tally)
    if tally.found and job.last - job.first > 1:
        tally.findings.clear()
        tally.found.clear()
        for index in range(job.first, job.last):
            content = _rssr_column(job.seed, index)
            _guarded(job, index, content, lambda c=content, i=index: _rssr_alone(c, i, tally), tally)
    tally.seen.update(f"type {word}" for word in words)
    tally.seen[f"family {name}"] += job.last - job.first
    for index in range(job.first, job.last, batches.RSSRS_CROSSED):
        mark(index)
        column = part[:, index - job.first]
        _guarded(
            job, index, _rssr_column(job.seed, index), lambda c=column: batches.rssr_crossed(c, side), tally
        )
        tally.seen["held against its own motion"] += 1
    tally.cases += job.last - job.first
    mark(None)


def _rssr_alone(content: str | bytes, _index: int, _tally: Tally) -> None:
    assert isinstance(content, str)
    linkage = sb.loads(content.partition("\n")[2])
    side = content.partition("\n")[0].removeprefix("# ")
    column = np.array([[linkage.dimensions[key]] for key in ("M", "N", "L1", "L2", "L3", "D")])
    batches.of_rssrs(column, side)
    batches.rssr_crossed(column[:, 0], side)


def _pattern(index: int) -> str:
    return loops.PATTERNS[index // WAYS["loop batch"].size % len(loops.PATTERNS)]


def _pattern_text(seed: int, index: int) -> str:
    return written(loops.of_pattern(_rng("loop batch", seed, index), _pattern(index)))


def _loop_batch(job: Job, tally: Tally, mark: Mark) -> None:
    mark(-1)
    kept: list[tuple[int, sb.Linkage]] = []
    for index in range(job.first, job.last):
        try:
            kept.append(
                (index, from_description(loops.of_pattern(_rng(job.way, job.seed, index), _pattern(index))))
            )
        except SevenbarError as error:
            tally.seen[f"refused {family(error, '')}"] += 1
    tally.cases += job.last - job.first
    if not kept:
        mark(None)
        return
    found: list[batches.Motions] = []
    _guarded(job, job.first, "", lambda: found.append(batches.of_loops([loop for _, loop in kept])), tally)
    if not found:
        tally.findings.clear()
        tally.found.clear()
        for index, _ in kept:
            content = _pattern_text(job.seed, index)
            _guarded(job, index, content, lambda c=content, i=index: _loop_alone(c, i, tally), tally)
        mark(None)
        return
    tally.seen.update(
        f"type {word}" if clear else "not clear"
        for word, clear in zip(found[0].types, found[0].clear, strict=True)
    )
    tally.seen[f"kind {_pattern(job.first)}"] += len(kept)
    for place in range(0, len(kept), batches.LOOPS_CROSSED):
        index, linkage = kept[place]
        mark(index)
        content = _pattern_text(job.seed, index)
        _guarded(job, index, content, lambda x=linkage, p=place: _loop_crossed(x, found[0], p), tally)
        tally.seen["held against its own motion"] += 1
    mark(None)


def _loop_crossed(linkage: sb.Linkage, motions: batches.Motions, place: int) -> None:
    try:
        batches.loop_crossed(linkage, motions, place)
    except SevenbarError as error:
        look_at(error, "")
        if motions.clear[place]:
            raise Broken(f"refused alone and clear in the batch: {error}") from None


def _loop_alone(content: str | bytes, _index: int, _tally: Tally) -> None:
    assert isinstance(content, str)
    linkage = sb.loads(content)
    _loop_crossed(linkage, batches.of_loops([linkage]), 0)


#: All ways. The limits are some hundred times what a slow call takes.
WAYS: dict[str, Way] = {
    "rssr batch": Way(1, 2048, 120, _rssr_batch, _rssr_column, _rssr_alone),
    "loop batch": Way(2, 64, 120, _loop_batch, _pattern_text, _loop_alone),
    "rssr": Way(3, 200, 30, _one_by_one, _rssr_text, _analysed),
    "loop": Way(4, 100, 60, _one_by_one, _loop_text, _analysed),
    "screw": Way(5, 5, 120, _one_by_one, _screw_text, _analysed),
    "edge": Way(8, 50, 60, _one_by_one, _edge_text, _analysed),
    "file": Way(6, 4000, 20, _one_by_one, files.drawn, _file),
    "table": Way(7, 1000, 20, _one_by_one, tables.drawn, _table),
}
