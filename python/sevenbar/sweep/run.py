"""Runs a sweep: parts on the threads of this machine or on a cluster, as many in flight as keep them busy."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Collection, Generator, Iterable, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from functools import partial
from itertools import islice
from multiprocessing import active_children, get_context, parent_process
from pathlib import Path

from sevenbar._core import WorkStop
from sevenbar.arrays import whole_number
from sevenbar.description.draft import Draft
from sevenbar.errors import EngineError, RequestError
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.measures import Measure
from sevenbar.sweep.axes import Given
from sevenbar.sweep.held_folder import other_maker, refuse_unlike
from sevenbar.sweep.ordinary import seconds_of_one
from sevenbar.sweep.parts import PartsFolder
from sevenbar.sweep.plan import SweepPlan, maker
from sevenbar.sweep.result import Sweep
from sevenbar.sweep.rows import need_pyarrow, part_bytes, schema
from sevenbar.text.progress import Progress, silent

#: What is measured by default.
USUAL = ("motion_type", "limits")

#: Most linkages of a sweep that is kept in memory.
MOST_IN_MEMORY = 10**7

#: Most threads: beyond any machine.
MOST_THREADS = 4096

#: Parts in flight for each thread: one at work and one that waits, so that none is idle.
IN_FLIGHT = 2


#: A finished part: its number, its file, and what made it.
Made = tuple[int, bytes, Mapping[str, str]]

#: Makes parts and gives each when it is finished.
Making = Callable[[Iterable[int]], Generator[Made, None, None]]


def run(
    linkage: Linkage | Draft,
    axes: Mapping[str, Given],
    measures: Sequence[str | Measure | Callable[[Motion], float]] = USUAL,
    *,
    method: str | None = None,
    count: int | None = None,
    seed: int | None = None,
    samples: int = 90,
    input: str | None = None,
    output: str | None = None,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    mixed: bool = False,
    threads: int | None = None,
    scheduler: str | None = None,
    part_size: int | None = None,
    follow: Collection[str] = (),
    progress: Progress | None = None,
) -> Sweep:
    """Measures of many linkages: named dimensions over grids, lists and samples.

    `axes` names dimensions (`Draft.dimensions`) and what each takes: `grid(low, high, count)`, a list, or
    `span(low, high)` of which `count` samples are drawn by `method` random or sobol with `seed`.
    `measures` are names of `measures.MEASURES` or functions of the Motion, taken with `samples` a turn.
    With `out` the rows go to a folder of Parquet parts of `part_size` linkages; `resume` goes on with the
    parts that are there, `mixed` also with those of other versions or vector units. It runs on `threads`
    (all processors by default), or on the workers of a Dask `scheduler`; the rows are the same. A dimension
    that the file leaves out, L2 of an RSSR, is held at its value in the design; `follow=["L2"]` lets it
    follow from the others. `progress` is called with the number of linkages done, and of all.

    Raises `RequestError` for an argument that does not fit, `OutputError` for a folder that cannot be
    written or holds something else, `MissingExtraError` without the extra `[sweep]`.

        >>> import sevenbar as sb
        >>> from sevenbar.sweep import grid
        >>> found = run(sb.load("rssr"), {"L1": grid(200, 500, 4)}, ["motion_type"])
        >>> found.table()["motion_type"].to_pylist()
        ['crank-rocker', 'double-rocker', 'double-rocker', 'double-rocker']
    """
    plan = SweepPlan.of(
        linkage, axes, measures, method=method, count=count, seed=seed, samples=samples,
        input=input, output=output, part_size=part_size, follow=follow,
    )  # fmt: skip
    return carry_out(
        plan, out=out, resume=resume, mixed=mixed, threads=threads, scheduler=scheduler, progress=progress
    )


def carry_out(
    plan: SweepPlan,
    *,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    mixed: bool = False,
    threads: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
    ahead: Callable[[int, float], object] | None = None,
) -> Sweep:
    """The sweep of a plan; as `run` for the rest.

    `ahead` is called before the work of measures of forces with how many linkages are to be analysed and
    about how long that takes here [s].
    """
    need_pyarrow()
    if scheduler is not None and threads is not None:
        raise RequestError("threads: workers of a scheduler have their own; leave threads or scheduler out")
    number = thread_count(threads)
    # a column that would appear twice is reported before anything is computed
    schema(plan)
    if out is None and plan.space.count > MOST_IN_MEMORY:
        raise RequestError(
            f"out: missing; {plan.space.count} linkages are more than memory should hold; "
            f"give a folder, or at most {MOST_IN_MEMORY} linkages"
        )
    if scheduler is None:
        at_once = min(number, plan.parts)
        make = partial(part_bytes, plan, threads=number // at_once)
        on_threads = partial(made_on_threads, make, at_once)
        return _filled(
            plan, [maker()], on_threads, out, resume=resume, mixed=mixed, progress=progress, ahead=ahead
        )
    from sevenbar.sweep.cluster import Cluster

    with Cluster(scheduler, plan, part_bytes) as cluster:
        makers = cluster.makers()
        return _filled(plan, makers, cluster.made, out, resume=resume, mixed=mixed, progress=progress)


def thread_count(threads: object) -> int:
    """The threads that are asked for, or one for each processor."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return whole_number("threads", threads, 1, MOST_THREADS, "a count of threads")


def _filled(
    plan: SweepPlan,
    makers: Sequence[Mapping[str, str]],
    made: Making,
    out: str | os.PathLike[str] | None,
    *,
    resume: bool,
    mixed: bool,
    progress: Progress | None,
    ahead: Callable[[int, float], object] | None = None,
) -> Sweep:
    """The sweep with all its parts, the missing ones made."""
    refuse_unlike(makers, mixed=mixed)
    folder = None if out is None else PartsFolder(Path(out), plan, makers, resume=resume, mixed=mixed)
    contents: dict[int, bytes] = {}
    try:
        done = frozenset[int]() if folder is None else folder.done
        linkages = sum(len(plan.linkages(part)) for part in done)
        report = progress or silent
        report(linkages, plan.space.count)
        if ahead is not None and plan.of_forces:
            left = plan.space.count - linkages
            ahead(left, left * seconds_of_one(plan))
        known = list(makers)
        missing = (part for part in range(plan.parts) if part not in done)
        with closing(made(missing)) as finished:
            for part, content, by in finished:
                if by not in known:
                    if not mixed:
                        raise RequestError(f"scheduler: {other_maker(known[0], by)}")
                    known.append(by)
                    if folder is not None:
                        folder.also_made_by(by)
                if folder is None:
                    contents[part] = content
                else:
                    folder.keep(part, content)
                linkages += len(plan.linkages(part))
                report(linkages, plan.space.count)
    finally:
        if folder is not None:
            folder.close()
    if folder is not None:
        return Sweep.of_folder(folder.path)
    return Sweep(plan.description(known), None, [contents[part] for part in range(plan.parts)])


def made_on_threads(
    make: Callable[[int], bytes], at_once: int, parts: Iterable[int]
) -> Generator[Made, None, None]:
    """What `make` makes of each part as it is finished, on so many threads of this process.

    Parts under way are given up where the caller stops.
    """
    stop = WorkStop()

    def stoppable(part: int) -> bytes:
        with stop:
            return make(part)

    with ThreadPoolExecutor(at_once, thread_name_prefix="sweep") as pool:
        try:
            yield from _made(pool, stoppable, at_once, parts)
        except BaseException:
            stop.stop()
            raise


def made_by_processes(
    make: Callable[[int], bytes], at_once: int, parts: Iterable[int]
) -> Generator[Made, None, None]:
    """The same by so many processes of this machine, for parts that Python makes; they end with this one.

    They end at once where the caller stops.

    Raises `EngineError` where one ends before its part is made.
    """
    others = set(active_children())
    with ProcessPoolExecutor(at_once, get_context("spawn"), initializer=_begin_process) as pool:
        try:
            yield from _made(pool, make, at_once, parts)
        except (GeneratorExit, KeyboardInterrupt):
            for process in set(active_children()) - others:
                process.terminate()
            raise
        except BrokenProcessPool:
            raise EngineError(
                "threads: a process ended before its part was made; check the memory; a script of your own "
                "begins its work below `if __name__ == '__main__':`; or give 1 thread"
            ) from None


def _begin_process() -> None:
    """Leaves Ctrl+C to the process that asked, and ends when that one was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    asker = parent_process()
    assert asker is not None

    def wait_for_end() -> None:
        asker.join()
        os._exit(1)

    threading.Thread(target=wait_for_end, daemon=True).start()


def _made(
    pool: Executor, make: Callable[[int], bytes], at_once: int, parts: Iterable[int]
) -> Generator[Made, None, None]:
    here = maker()
    rest = iter(parts)
    flying: dict[Future[bytes], int] = {}
    try:
        while True:
            for part in islice(rest, IN_FLIGHT * at_once - len(flying)):
                flying[pool.submit(make, part)] = part
            if not flying:
                return
            finished, _ = wait(flying, return_when=FIRST_COMPLETED)
            for future in finished:
                yield flying.pop(future), future.result(), here
    finally:
        for future in flying:
            future.cancel()
