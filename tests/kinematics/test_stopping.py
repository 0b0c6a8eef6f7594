"""Long work ends when it is asked to: by Ctrl+C, by a signal, by another thread; and wild loops are bounded."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from pathlib import Path

import pytest

import sevenbar as sb
from command_runs import sevenbar
from sevenbar._core import WorkStop
from sevenbar.reporting.folder import fill_folder
from sevenbar.studio.worker import Worker
from sevenbar.sweep import run, span
from sevenbar.text.aside import ASIDE, aside_prefix, clear_left

#: The longest [s] that anything here may take: a guard against hanging.
PATIENCE = 600.0


def test_work_that_is_no_longer_wanted_is_a_keyboard_interrupt_and_leaves_nothing_behind():
    linkage, stop = sb.load("seven_r"), WorkStop()
    whole = linkage.motion(36)
    stop.stop()
    with pytest.raises(KeyboardInterrupt), stop:
        linkage.motion(36)
    again = linkage.motion(36)
    assert [c.q.tolist() for c in again] == [c.q.tolist() for c in whole]


@pytest.mark.parametrize("name", ["seven_r", "bennett", "rssr", "planar_4r"])
def test_each_call_of_the_core_can_be_stopped(name):
    linkage = sb.load(name)
    stop = WorkStop()
    stop.stop()
    with stop:
        with pytest.raises(KeyboardInterrupt):
            linkage.motion()
        # the thread that asked is stopped, no other
        found: list[str] = []
        other = threading.Thread(target=lambda: found.append(linkage.motion().motion_type))
        other.start()
        other.join(PATIENCE)
    assert found == [linkage.motion().motion_type]


def test_a_stop_within_another_ends_with_its_own_block():
    outer, inner = WorkStop(), WorkStop()
    linkage = sb.load("seven_r")
    with outer:
        with inner:
            pass
        inner.stop()
        assert linkage.motion(36).circuits
        outer.stop()
        with pytest.raises(KeyboardInterrupt):
            linkage.motion(36)
    assert (outer.stopped, inner.stopped) == (True, True)


class AlarmError(Exception):
    """What a handler raises."""


def moved_without_end(linkage: sb.Linkage) -> None:
    while True:
        linkage.motion(360)


def test_what_a_handler_of_a_signal_raises_reaches_the_caller():
    def ring(*_: object) -> None:
        raise AlarmError

    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        linkage = sb.load("seven_r")
        with pytest.raises(AlarmError):
            moved_without_end(linkage)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_a_tab_that_is_closed_gives_up_its_work():
    begun, linkage = threading.Event(), sb.load("seven_r")

    def work() -> None:
        begun.set()
        while True:
            linkage.motion(36)

    worker = Worker(lambda _: None, lambda: None, lambda: None)
    worker.ask("work", work)
    worker.start()
    assert begun.wait(PATIENCE)
    worker.end()
    worker.join(PATIENCE)
    assert not worker.is_alive()


def test_a_sweep_that_is_stopped_gives_up_its_parts():
    def stopped(done: float, _total: int, _best: str = "") -> None:
        if done:
            raise KeyboardInterrupt

    axes = {"L1": span(100, 900), "L2": span(20, 1200)}
    with pytest.raises(KeyboardInterrupt):
        run(sb.load("rssr"), axes, count=3000, part_size=25, threads=2, progress=stopped)


WILD = [
    ("R", [5460.16758983135, 0.6116955851235986, 1e-12], [-98362450943781.28, -3.6241844888335217, -6.058157537864215]),
    ("C", [180, 0.08754664965078546, 90], [-0.00046781203278212143, 0.4150635632653774, 2.584497669550549]),
    ("R", [1.5054381647469748e-17, -2929242.492181285, 1e-09], [5.098882860049856e-07, 8526298227255.441, 8.915403150212708]),
    ("C", [-3.210523696882344, -3.2873487233778986e-12, -9.59939329434681], [-8.5908674641307, 360, 659.6946324506249]),
    ("R", [-3.637897277694937, 6.226174296929801e-10, -5.679774800508102], [5e-324, 9.905367377355262, -1]),
]  # fmt: skip


def test_of_a_loop_whose_curves_have_no_end_two_are_followed_at_most_and_the_other_modes_counted():
    # lengths of 1e-12 beside such of 1e6, axes of 1e14 beside such of 5e-324
    joints = "\n".join(f'[[joint]]\nkind = "{kind}"\nat = {at}\naxis = {axis}' for kind, at, axis in WILD)
    motion = sb.loads(f"format = 1\n{joints}\n").motion(36)
    assert [circuit.closed for circuit in motion] in ([False], [False, False])
    assert motion.search.unfollowed > 100


STOP = """
import os, signal
# a shell starts what runs in the background with signals ignored, and so they stay
signal.signal(signal.{how}, signal.SIG_DFL)
import sevenbar.kinematics.linkage as linkage
def motion(*_, **__):
    os.kill(os.getpid(), signal.{how})
    while True:
        pass
linkage.Linkage.motion = motion
"""


@pytest.mark.parametrize(("how", "code"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_a_signal_ends_a_command_with_one_line_and_its_number(how, code, tmp_path):
    done = sevenbar("analyze", "rssr", "--out", "out", cwd=tmp_path, before=STOP.format(how=how))
    assert (done.returncode, done.stderr) == (code, "sevenbar: stopped; nothing is written\n")
    assert not list(tmp_path.iterdir())


def ended() -> int:
    """The number of a process that has ended."""
    with subprocess.Popen(["true"]) as process:
        process.wait()
    return process.pid


def test_what_a_killed_run_left_the_next_one_clears(tmp_path):
    own = aside_prefix()
    machine, _, started = own.removeprefix(ASIDE).split("-")[:3]
    left = [f"{ASIDE}{machine}-{ended()}-{started}-a", f"{ASIDE}{machine}-{os.getpid()}-{int(started) + 1}-b"]
    stays = [f"{own}c", f"{ASIDE}00000000-{ended()}-1-of_another_machine", f"{ASIDE}mine", "motion.csv"]
    for name in left + stays:
        (tmp_path / name).mkdir()
        (tmp_path / name / "half.csv").touch()
    (tmp_path / f"{left[0]}.png").touch()
    clear_left(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(stays)


def test_files_are_written_beside_what_others_write_aside(tmp_path):
    other = tmp_path / f"{aside_prefix()}other"
    other.mkdir()

    def fill(folder: Path) -> None:
        (folder / "a.csv").touch()

    fill_folder(tmp_path, fill)
    assert sorted(tmp_path.iterdir()) == sorted([other, tmp_path / "a.csv"])
