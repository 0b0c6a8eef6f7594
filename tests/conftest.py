"""What tests are given: a Chinese font, or none but matplotlib's; Chromium, its pages, the studio; a cluster."""

import logging
from contextlib import ExitStack
from itertools import count
from pathlib import Path

import pytest
from matplotlib import get_data_path
from matplotlib.font_manager import fontManager

import browser
import slow_tests
from served import Studio
from sevenbar.drawing import fonts, style


def pytest_addoption(parser):
    parser.addoption("--write-slow-tests", action="store_true", help="write tests/slow_tests.txt anew")


def pytest_configure(config):
    # in workers, too, which have the options of the process that hands tests out
    if config.getoption("--write-slow-tests"):
        write = not hasattr(config, "workerinput")
        config.pluginmanager.register(slow_tests.Recorder(write=write))


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Slow are the tests on the list, and all that need a browser."""
    slow = slow_tests.listed()
    for item in items:
        if "chromium" in item.fixturenames:
            item.add_marker("browser")
        if "chromium" in item.fixturenames or slow_tests.name_of(item.nodeid) in slow:
            item.add_marker("slow")


@pytest.fixture(scope="session")
def chinese_font():
    """A font in which figures can have Chinese labels; without one the test is skipped."""
    if fonts._installed() is None:
        pytest.skip("no font with Chinese characters is installed")


@pytest.fixture
def fonts_of_matplotlib(monkeypatch):
    """Figures have the fonts that come with matplotlib, the widest letters a machine may have: no Arial, no Times."""
    own = {font.name for font in fontManager.ttflist if Path(font.fname).is_relative_to(get_data_path())}
    monkeypatch.setattr(style, "get_font_names", lambda: sorted(own))


@pytest.fixture(scope="session")
def chromium():
    """A headless browser, for all tests of one worker."""
    with browser.launched() as found:
        yield found


@pytest.fixture
def studio(tmp_path):
    """Start a studio with arguments of its command line; what is still running is ended after the test."""
    numbers = count()
    with ExitStack() as ends:

        def start(*arguments):
            one = Studio(*arguments, folder=tmp_path / f"studio-{next(numbers)}")
            ends.callback(lambda: one.stopped or one.stop())
            return one

        yield start


@pytest.fixture
def pages(chromium, studio):  # noqa: ARG001  # made after the studio, so that pages close before it ends
    """Open pages at addresses; nothing may go wrong on them."""
    opened = browser.Pages(chromium)
    yield opened
    opened.close()
    assert not opened.wrong


@pytest.fixture
def workers(tmp_path, monkeypatch):
    """Start a cluster of processes on this machine; it leaves no file but in its own folder."""
    import dask
    from distributed import LocalCluster

    started = []

    def start(count: int, **settings):
        with dask.config.set({"temporary-directory": str(tmp_path / "dask"), **settings}):
            one = LocalCluster(
                n_workers=count, threads_per_worker=1, processes=True, silence_logs=logging.CRITICAL,
                dashboard_address=":0",  # a free port: other tests have clusters at the same time
            )  # fmt: skip
        started.append(one)
        return one

    monkeypatch.setenv("DASK_LOGGING__DISTRIBUTED", "critical")
    yield start
    for one in started:
        one.close()
