"""The page on points: its example and its searches are those of today."""

import contextlib
import io
import re
import subprocess
import sys

import pytest

from places import ROOT

PAGE = (ROOT / "docs" / "points.md").read_text(encoding="utf-8")


def test_the_example_prints_what_its_comments_say():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    promised = re.findall(r"print\(.*\)  # (.*)", code)
    assert printed.getvalue().splitlines() == promised


def test_the_dense_search_of_the_page_is_that_of_today_and_never_beats_the_bound():
    run = subprocess.run(
        [sys.executable, "evidence/benches/least_acceleration.py"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    shown = re.findall(r"^    search +([\d.]+) over", PAGE, flags=re.MULTILINE)
    today = re.findall(r"^search +([\d.]+) over", run.stdout, flags=re.MULTILINE)
    assert len(today) == 6
    assert [float(x) for x in shown] == pytest.approx([float(x) for x in today], rel=1e-6)
    bound = float(re.search(r"lower bound +([\d.]+)", run.stdout)[1])
    assert min(float(x) for x in today) >= bound
    assert min(float(x) for x in today) == pytest.approx(bound, rel=1e-4)
