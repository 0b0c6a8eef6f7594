"""Several callers at once: the same bits, the interpreter free meanwhile, and no thread lost in a fork.

Source: the same calls one after the other.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import sevenbar as sb
from evidence.fuzz.random_linkages import assembled_square
from evidence.fuzz.random_loops import general
from places import ROOT, TESTS
from sevenbar import _core
from sevenbar.kinematics.measures import MEASURES
from sevenbar.kinematics.solvers.batches import loop_motions

#: Where a process of its own finds what the tests share.
SHARED = os.environ | {
    "PYTHONPATH": os.pathsep.join(
        [str(Path(__file__).parent), str(TESTS), str(ROOT), os.environ.get("PYTHONPATH", "")]
    )
}

#: Threads that call at once, and how often each asks for everything.
CALLERS, ROUNDS = 6, 3

#: A call this long [s] tells whether others run beside it.
LONG = 0.4


def seven_r(count: int) -> list[sb.Linkage]:
    return [general(np.random.default_rng([41, k])).linkage() for k in range(count)]


def measured(motions) -> list[np.ndarray]:
    """The measures of circuits that batches have."""
    return [m.batch(motions) for m in MEASURES.values() if m.batch and m.per == "circuit"]


def everything(linkages: list[sb.Linkage]) -> bytes:
    """Bits of all that can be asked of linkages, made anew so that nothing is known before."""
    parts: list[np.ndarray] = []
    for linkage in linkages:
        motion = linkage.motion(36)
        parts += [motion.limits, *(circuit.dddq for circuit in motion)]
        parts += [circuit.point(2, (1.0, 2.0, 3.0)).jerk for circuit in motion]
        parts.append(linkage.assembly_modes(0.3).q)
        if linkage.kind == "RSSR":
            parts.append(linkage.output(np.linspace(0, 6, 999), order=3).jerk)
        else:
            parts.append(np.array([linkage.mobility().finite]))
    loops = [linkage for linkage in linkages if linkage.kind != "RSSR"]
    found = loop_motions(loops, 0, 6, 36, 2)
    parts += [found.limits, found.circuits, *(column for column in measured(found) if column.dtype != object)]
    return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)


def drawn() -> list[sb.Linkage]:
    rng = np.random.default_rng(42)
    return [*seven_r(3), *(assembled_square(rng).linkage() for _ in range(3))]


def test_threads_that_ask_at_once_get_the_bits_of_one_that_asks_alone() -> None:
    alone = everything(drawn())
    # the same objects for all threads: what a linkage keeps is made while others ask for it
    shared = [drawn() for _ in range(ROUNDS)]
    gate = threading.Barrier(CALLERS)

    def call(_: int) -> list[bytes]:
        gate.wait()
        return [everything(linkages) for linkages in shared]

    with ThreadPoolExecutor(CALLERS) as pool:
        for found in pool.map(call, range(CALLERS)):
            assert found == [alone] * ROUNDS


def long_calls() -> dict[str, Callable[[int], object]]:
    """Calls of the core whose work grows with a number."""
    loops, rssr = seven_r(1), sb.load("rssr")
    bennett = sb.load("bennett")
    dimensions = np.repeat([[0.7], [0.7], [0.25], [0.9], [0.55], [0.1]], 1, axis=1)
    law = np.linspace(0, 6, 10_000)
    return {
        "classify_rssr": lambda n: _core.classify_rssr(np.tile(dimensions, 4000 * n), "crank", 1),
        "measure_rssr": lambda n: _core.measure_rssr(
            np.tile(dimensions, 40 * n), "crank", np.ones(40 * n), 1
        ),
        "outputs": lambda n: rssr.output(np.tile(law, 20 * n), order=3),
        "rssr motion": lambda n: rssr.motion(2000 * n),
        # of more rows than the core makes at once it makes none before they are asked for
        "loop motion": lambda n: [bennett.motion(2000) for _ in range(n)],
        "measure_loops": lambda n: loop_motions(loops * (4 * n), 0, 6, 36, 1),
    }


@pytest.mark.parametrize("name", list(long_calls()))
def test_a_long_call_leaves_the_interpreter_to_other_threads(name: str) -> None:
    call = long_calls()[name]
    size = 1
    call(size)
    while True:
        start = time.perf_counter()
        call(size)
        if time.perf_counter() - start > LONG:
            break
        size *= 2
    ticks: list[float] = []
    done = threading.Event()

    def count() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    try:
        start = time.perf_counter()
        call(size)
        end = time.perf_counter()
    finally:
        done.set()
        counter.join()
    # with the lock held there is none but those beside arrays that are made from Python's side before and after
    assert sum(start < tick < end for tick in ticks) > 20, name


FORKED = """
import multiprocessing, sys
from concurrent.futures import ProcessPoolExecutor
import test_threads as t

before = t.everything(t.drawn())  # threads of the core have run before the fork
with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("fork")) as pool:
    after = list(pool.map(t.everything, [t.drawn()] * 4))
sys.exit(after != [before] * 4)
"""


def test_processes_forked_after_threads_have_run_get_the_same_bits() -> None:
    # a newer Python warns of any fork beside threads
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", FORKED]
    subprocess.run(command, env=SHARED, check=True, timeout=600)


INTERRUPTED = """
import signal, sys, time
import test_threads as t

# a shell that starts its jobs in the background has them ignore it
signal.signal(signal.SIGINT, signal.default_int_handler)

loops = t.seven_r(1) * 80
t.loop_motions(loops[:4], 0, 6, 36, 1)
print("begun", flush=True)
start = time.perf_counter()
try:
    t.loop_motions(loops, 0, 6, 36, 1)
    time.sleep(60)
except KeyboardInterrupt:
    sys.exit(7)
"""


def test_an_interrupt_during_a_batch_is_raised_when_the_batch_is_done() -> None:
    command = [sys.executable, "-c", INTERRUPTED]
    with subprocess.Popen(command, env=SHARED, stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == b"begun\n"
        time.sleep(0.2)
        child.send_signal(signal.SIGINT)
        assert child.wait(timeout=600) == 7
