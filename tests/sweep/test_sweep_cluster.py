"""A cluster makes the very bits of one thread, and what dies there loses nothing that was finished."""

from __future__ import annotations

import hashlib
import os
import signal
import warnings
from pathlib import Path
from threading import Lock

import pytest

import sevenbar as sb
from sevenbar.errors import EngineError, RequestError
from sevenbar.sweep import cluster as cluster_module
from sevenbar.sweep import run, span

AXES = {"L1": span(100, 900), "L2": span(20, 1200)}
MEASURES = ["motion_type", "limits", "swing", "jerk_highest"]


def swept(**asked):
    measures = asked.pop("measures", MEASURES)
    return run(sb.load("rssr"), AXES, measures, count=600, part_size=25, **asked)


def bits(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


@pytest.mark.parametrize("count", [1, 2, 4])
def test_any_number_of_workers_makes_the_bits_of_one_thread(workers, tmp_path: Path, count: int) -> None:
    swept(out=tmp_path / "alone", threads=1)
    swept(out=tmp_path / "cluster", scheduler=workers(count).scheduler_address)
    assert bits(tmp_path / "cluster") == bits(tmp_path / "alone")


def test_a_worker_that_is_killed_costs_nothing_but_time(workers, tmp_path: Path) -> None:
    cluster = workers(2)
    killed = []

    def progress(done: int, _total: int) -> None:
        if done >= 100 and not killed:
            killed.append(next(iter(cluster.workers.values())).pid)
            os.kill(killed[0], signal.SIGKILL)

    swept(out=tmp_path / "killed", scheduler=cluster.scheduler_address, progress=progress)
    assert killed
    swept(out=tmp_path / "alone", threads=1)
    assert bits(tmp_path / "killed") == bits(tmp_path / "alone")


def ends_its_process(motion: sb.Motion) -> float | None:
    """Ends the process that measures a crank of more than 800."""
    if motion.linkage.dimensions["L1"] > 800:
        os._exit(1)
    return None


def test_a_part_that_ends_every_worker_is_told_and_the_others_are_kept(workers, tmp_path: Path) -> None:
    cluster = workers(2, **{"distributed.scheduler.allowed-failures": 1})
    with pytest.raises(EngineError) as caught:
        swept(
            out=tmp_path / "one", scheduler=cluster.scheduler_address, measures=["limits", ends_its_process]
        )
    message = str(caught.value)
    assert message.startswith("scheduler: part ")
    assert message.endswith(
        "ended every worker that took it; check their memory and their logs, and go on with --resume"
    )
    assert {path.suffix for path in (tmp_path / "one").iterdir()} <= {".json", ".parquet"}


def test_without_workers_it_is_told_and_goes_on_without_the_cluster(
    workers, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "WORKER_TIME", 2.0)
    cluster = workers(1)
    gone = []

    def progress(done: int, _total: int) -> None:
        if done >= 50 and not gone:
            gone.append(done)
            cluster.scale(0)

    address = cluster.scheduler_address
    with pytest.raises(
        EngineError, match=r"has had no worker for 2 s; start some with 'dask worker', and go on"
    ):
        swept(out=tmp_path / "one", scheduler=address, progress=progress)
    kept = bits(tmp_path / "one")
    assert len(kept) >= 3
    swept(out=tmp_path / "one", resume=True)
    swept(out=tmp_path / "alone", threads=1)
    assert bits(tmp_path / "one") == bits(tmp_path / "alone")
    assert kept.items() <= bits(tmp_path / "one").items()


def test_a_cluster_that_ends_is_told_and_its_parts_are_kept(workers, tmp_path: Path) -> None:
    cluster = workers(1)
    ended = []

    def progress(done: int, _total: int) -> None:
        if done >= 50 and not ended:
            ended.append(done)
            cluster.close()

    with pytest.raises(
        EngineError, match=r"scheduler: 'tcp://.*' is lost \(.*\); start it again, and go on with"
    ):
        swept(out=tmp_path / "one", scheduler=cluster.scheduler_address, progress=progress)
    assert len(bits(tmp_path / "one")) >= 3


def test_an_address_without_a_scheduler_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_module, "ANSWER_TIME", 0.5)
    for address in ("tcp://127.0.0.1:1", "nowhere"):
        with warnings.catch_warnings(), pytest.raises(RequestError) as caught:
            swept(scheduler=address)
        assert str(caught.value) == (
            f"scheduler: no Dask scheduler answers at '{address}'; "
            "start one with 'dask scheduler', and give its address, as in tcp://host:8786"
        )


def test_a_function_that_cannot_be_sent_is_told() -> None:
    lock = Lock()

    def held(_motion: sb.Motion) -> float:
        with lock:
            return 1.0

    with pytest.raises(RequestError) as caught:
        swept(scheduler="tcp://127.0.0.1:1", measures=[held])
    assert str(caught.value).startswith(
        "measure: a function cannot be sent to workers: TypeError: cannot pickle"
    )
    assert str(caught.value).endswith(
        "give functions of a module that the workers have, which hold nothing open"
    )
