"""Which tests are slow: those that a run found to be so, not those that somebody took for slow.

`make slow-tests` runs all tests, counts the processor time of each, and writes the names of the slow ones into
`slow_tests.txt`: all but the cheapest that take `BUDGET` together. All cases of a test count together, with the
fixtures that it shares with other tests. A test that is not on the list is fast, until the next such run.
"""

import os
from collections import defaultdict

import pytest

from places import TESTS

#: The list, a name a line.
LIST = TESTS / "slow_tests.txt"

#: What the fast tests may take together [s of one processor].
BUDGET = 65.0


def listed():
    """The names of slow tests, as `test_x.py::test_y`."""
    return set(LIST.read_text("utf-8").splitlines()) if LIST.exists() else set()


def name_of(nodeid):
    """A test's name without its case and its folder."""
    return nodeid.partition("[")[0].rpartition("/")[2]


def spent():
    """Processor time [s] of this process and of those that it has waited for."""
    return sum(os.times()[:4])


class Recorder:
    """Counts what each test takes, in the workers; the process that hands them out writes the list."""

    def __init__(self, write):
        self.write = write
        self.fixtures = {}
        self.calls = defaultdict(float)
        self.uses = defaultdict(set)
        self.shared = defaultdict(float)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef):
        """Counts fixtures that several tests share."""
        begin = spent()
        value = yield
        if fixturedef.scope != "function":
            self.fixtures[self._key(fixturedef)] = spent() - begin
        return value

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item):
        """Counts the test itself."""
        begin = spent()
        try:
            return (yield)
        finally:
            item.user_properties.append(("spent", spent() - begin))

    def pytest_runtest_teardown(self, item):
        """Adds what the test shares with others, which is what it would take alone."""
        for name in item.fixturenames:
            # the last definition of a fixture overrides the others
            for fixture in item._fixtureinfo.name2fixturedefs.get(name, ())[-1:]:
                if (key := self._key(fixture)) in self.fixtures:
                    item.user_properties.append(("shared", (key, self.fixtures[key])))

    def pytest_runtest_logreport(self, report):
        """Collects what the workers counted."""
        if report.when != "teardown":
            return
        name = name_of(report.nodeid)
        for key, value in report.user_properties:
            if key == "spent":
                self.calls[name] += value
            elif key == "shared":
                # each worker sets it up anew
                fixture, took = value
                self.uses[name].add(fixture)
                self.shared[fixture] = max(self.shared[fixture], took)

    def pytest_sessionfinish(self, session):
        """Writes the list, and what was counted into the cache of pytest."""
        if not self.write or hasattr(session.config, "workerinput"):
            return
        took = {
            name: own + sum(self.shared[fixture] for fixture in self.uses[name])
            for name, own in self.calls.items()
        }
        cheapest = sorted(took, key=took.get)
        session.config.cache.set(
            "sevenbar/spent", {name: round(took[name], 2) for name in reversed(cheapest)}
        )
        total = 0.0
        while cheapest and total + took[cheapest[0]] <= BUDGET:
            total += took[cheapest.pop(0)]
        LIST.write_text("".join(f"{name}\n" for name in sorted(cheapest)), encoding="utf-8")

    @staticmethod
    def _key(fixture):
        return f"{fixture.baseid}::{fixture.argname}"
