"""A sweep's parts made by the workers of a Dask cluster: files come back, so no disk need be shared."""

from __future__ import annotations

import logging
import time
import uuid
from asyncio import CancelledError
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from itertools import islice
from typing import Any, NoReturn

from sevenbar.errors import EngineError, RequestError, SevenbarError, of_extra, shown
from sevenbar.sweep.held_folder import Parted
from sevenbar.sweep.plan import maker

#: Time [s] in which a scheduler must answer.
ANSWER_TIME = 10.0

#: Time [s] without any worker after which a sweep is given up: one that died is started again within that.
WORKER_TIME = 60.0

#: Time [s] between two checks of the workers.
LOOK_TIME = 1.0

#: Parts in flight for each thread of the workers: one at work and one that waits.
IN_FLIGHT = 2


class Cluster:
    """The workers of a scheduler, for one plan; closed after use, whatever happened."""

    def __init__(self, address: str, plan: Parted, make: Callable[[Any, int], bytes]) -> None:
        """Calls the scheduler at an address, as in "tcp://host:8786"; `make(plan, part)` makes a part.

        Raises `MissingExtraError` without dask, `RequestError` for an address where none answers, and for
        measures that cannot be sent.
        """
        with of_extra("sweep", "a cluster needs dask"):
            distributed: Any = import_module("distributed")
            pickle: Any = import_module("distributed.protocol.pickle")
        try:
            pickle.dumps(plan)
        except Exception as error:
            raise RequestError(
                f"measure: a function cannot be sent to workers: {_reason(error)}; "
                "give functions of a module that the workers have, which hold nothing open"
            ) from None
        self._plan, self._make, self._address = plan, make, address
        how: dict[str, Any] = {"timeout": ANSWER_TIME, "set_as_default": False, "name": "sevenbar-sweep"}
        with ExitStack() as opened:
            opened.enter_context(_quiet())
            try:
                self._client: Any = distributed.Client(address, **how)
            except Exception:
                raise RequestError(
                    f"scheduler: no Dask scheduler answers at {shown(address)}; "
                    "start one with 'dask scheduler', and give its address, as in tcp://host:8786"
                ) from None
            self._opened = opened.pop_all()

    def __enter__(self) -> Cluster:
        return self

    def __exit__(self, *_: object) -> None:
        with self._opened, suppress(Exception):
            self._client.close()

    def makers(self) -> Sequence[Mapping[str, str]]:
        """What makes parts there, as of the workers that are there now; raises `EngineError` for none."""
        self._wait_for_workers()
        try:
            result = self._client.run(maker, on_error="return")
        except Exception as error:
            self._lost(error)
        makers: list[Mapping[str, str]] = []
        for worker, known in result.items():
            if not isinstance(known, dict):
                raise EngineError(
                    f"scheduler: worker {worker} cannot run Sevenbar: {known}; install the same version there"
                )
            if known not in makers:
                makers.append(known)
        return makers

    def made(self, parts: Iterable[int]) -> Generator[tuple[int, bytes, Mapping[str, str]], None, None]:
        """The parts as they are finished; raises `EngineError` where workers die of them, or all are gone."""
        rest = iter(parts)
        flying: dict[Any, int] = {}
        # keys of this run alone: a scheduler may still know those of another
        run = uuid.uuid4().hex
        try:
            while True:
                window = max(IN_FLIGHT, IN_FLIGHT * sum(self._threads().values()))
                for part in islice(rest, max(0, window - len(flying))):
                    future = self._client.submit(
                        _made_by, self._make, self._plan, part, key=f"sweep-{run}-{part}", pure=False
                    )
                    flying[future] = part
                if not flying:
                    return
                for future in self._finished(flying):
                    content, by = self._result(future, flying[future])
                    yield flying.pop(future), content, by
                    future.release()
        finally:
            with suppress(Exception):
                self._client.cancel(list(flying), force=True)

    def _threads(self) -> Mapping[str, int]:
        try:
            threads: Mapping[str, int] = self._client.nthreads()
        except Exception as error:
            self._lost(error)
        return threads

    def _wait_for_workers(self) -> None:
        begin = time.monotonic()
        while not self._threads():
            if time.monotonic() - begin > WORKER_TIME:
                raise EngineError(
                    f"scheduler: '{self._address}' has had no worker for {WORKER_TIME:g} s; "
                    "start some with 'dask worker', and go on with --resume"
                )
            time.sleep(LOOK_TIME)

    def _finished(self, flying: Mapping[Any, int]) -> Sequence[Any]:
        """Those that are finished, at least one."""
        distributed: Any = import_module("distributed")
        while True:
            try:
                # not for the whole process: a caller may have clients of another cluster
                with self._client.as_current():
                    known = distributed.wait(list(flying), LOOK_TIME, "FIRST_COMPLETED")
            except TimeoutError:
                self._wait_for_workers()
            except Exception as error:
                self._lost(error)
            else:
                return list(known.done)

    def _result(self, future: Any, part: int) -> tuple[bytes, Mapping[str, str]]:
        """What a worker made; it is made again where its worker left before this was fetched."""
        from distributed.scheduler import KilledWorker

        while True:
            try:
                content, by = future.result(timeout=ANSWER_TIME)
                return content, by
            except TimeoutError:
                self._wait_for_workers()
            except SevenbarError:
                raise
            except KilledWorker:
                first = self._plan.linkages(part)
                raise EngineError(
                    f"scheduler: part {part} (linkages {first.start} to {first.stop - 1}) ended every worker "
                    "that took it; check their memory and their logs, and go on with --resume"
                ) from None
            except (CancelledError, OSError) as error:
                self._lost(error)
            except Exception as error:
                raise EngineError(
                    f"scheduler: a worker cannot make part {part}: {_reason(error)}; "
                    "give workers the same modules and versions as here, and go on with --resume"
                ) from None

    def _lost(self, error: BaseException) -> NoReturn:
        raise EngineError(
            f"scheduler: '{self._address}' is lost ({_reason(error)}); "
            "start it again, and go on with --resume"
        ) from None


def _reason(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}".splitlines()[0]


def _made_by(make: Callable[[Any, int], bytes], plan: Parted, part: int) -> tuple[bytes, Mapping[str, str]]:
    """A part and what made it: run by a worker."""
    return make(plan, part), maker()


@contextmanager
def _quiet() -> Iterator[None]:
    """Without the log of distributed, which would appear between the lines that are meant to be read."""
    log = logging.getLogger("distributed")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        log.setLevel(level)
