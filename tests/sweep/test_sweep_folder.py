"""A folder of parts: whole parts only, of one sweep only, whatever happens to the run that fills it."""

from __future__ import annotations

import hashlib
import json
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import OutputError
from sevenbar.sweep import Sweep, run, span
from sevenbar.sweep import plan as plan_module
from sevenbar.sweep.parts import read_description, read_part

AXES = {"L1": span(100, 900), "L2": span(20, 1200)}
ASKED = {"measures": ["motion_type", "limits", "swing"], "count": 300, "part_size": 25}


def swept(folder: Path, *, threads: int = 2, **asked) -> Sweep:
    return run(sb.load("rssr"), AXES, out=folder, threads=threads, **(ASKED | asked))


def bits(folder: Path) -> dict[str, str]:
    """A mark of each file of a folder."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("sweep") / "whole"
    swept(folder, threads=1)
    return folder


def test_a_folder_holds_the_description_and_the_parts_and_nothing_else(whole: Path) -> None:
    assert sorted(bits(whole)) == [*(f"part-{part:06}.parquet" for part in range(12)), "sweep.json"]
    told = json.loads((whole / "sweep.json").read_text(encoding="utf-8"))
    assert sb.loads(told["toml"]).dimensions == sb.load("rssr").dimensions
    assert told["sampling"] == {"method": "sobol", "count": 300, "seed": 0}
    assert (told["measures"], told["samples"], told["part_size"]) == (ASKED["measures"], 90, 25)
    assert (told["length_unit"], told["made_by"][0]["sevenbar"]) == ("mm", sb.__version__)
    assert told["made_by"][0]["simd_level"] in ("avx512", "avx2", "neon", "baseline", "plain")
    linkages = [
        n
        for part in range(12)
        for n in pq.read_table(whole / f"part-{part:06}.parquet")["linkage"].to_pylist()
    ]
    assert sorted(set(linkages)) == list(range(300))
    assert linkages == sorted(linkages)


@pytest.mark.parametrize("threads", [2, 4])
def test_the_bits_do_not_depend_on_the_threads(whole: Path, tmp_path: Path, threads: int) -> None:
    swept(tmp_path / "again", threads=threads)
    assert bits(tmp_path / "again") == bits(whole)


def test_a_sweep_in_memory_has_the_rows_of_the_folder(whole: Path) -> None:
    in_memory = run(sb.load("rssr"), AXES, **ASKED)
    assert in_memory.table().equals(Sweep.of_folder(whole).table())


def test_a_resumed_sweep_makes_the_missing_parts_only(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / "half"
    swept(folder)
    for part in (0, 5, 11):
        (folder / f"part-{part:06}.parquet").unlink()
    (folder / ".part-000005.parquet.aside").write_bytes(b"half")
    times = {path.name: path.stat().st_mtime_ns for path in folder.glob("part*")}
    with pytest.raises(
        OutputError, match=r"half: 9 of 12 parts are there; give --resume to go on, or another"
    ):
        swept(folder)
    with pytest.raises(OutputError, match=r"half: 9 of 12 parts are there; finish it with --resume"):
        Sweep.of_folder(folder)
    told = []
    swept(folder, resume=True, progress=lambda done, total: told.append((done, total)))
    assert told[0] == (225, 300)
    assert told[-1] == (300, 300)
    assert bits(folder) == bits(whole)
    assert times.items() <= {path.name: path.stat().st_mtime_ns for path in folder.glob("part*")}.items()
    assert swept(folder).table().num_rows == Sweep.of_folder(whole).table().num_rows


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"seed": 5}, "sampling.seed is 0 there and 5 here"),
        (
            {"measures": ["motion_type"]},
            r"measures is \['motion_type', 'limits', 'swing'\] there and \['motion_",
        ),
        ({"count": 301}, "sampling.count is 300 there and 301 here"),
        ({"samples": 91}, "samples is 90 there and 91 here"),
        ({"part_size": 26}, "part_size is 25 there and 26 here"),
        ({"input": "rocker"}, "input is 'crank' there and 'rocker' here, and 1 more differ"),
    ],
)
def test_a_folder_of_another_sweep_is_refused_and_left(whole: Path, changed: dict, message: str) -> None:
    before = bits(whole)
    for resume in (False, True):
        with pytest.raises(
            OutputError, match=f"whole: holds another sweep: {message}.*; give another folder, or"
        ):
            swept(whole, resume=resume, **changed)
    assert bits(whole) == before


def test_another_linkage_or_another_range_is_another_sweep(whole: Path) -> None:
    with pytest.raises(OutputError, match=r"linkage.rssr.L3 is 550 there and 551 here"):
        run(Draft.of_linkage(sb.load("rssr")).with_values({"L3": 551.0}), AXES, out=whole, **ASKED)
    with pytest.raises(OutputError, match=r"dimensions\[2\].high is 1200.0 there and 1201.0 here"):
        run(sb.load("rssr"), AXES | {"L2": span(20, 1201)}, out=whole, **ASKED)


def test_a_part_that_is_none_of_this_sweep_is_not_mixed_in(whole: Path, tmp_path: Path) -> None:
    swept(tmp_path / "other", seed=9)
    swept(tmp_path / "mine")
    mine = tmp_path / "mine" / "part-000003.parquet"
    own = mine.read_bytes()
    for content, message in (
        ((tmp_path / "other" / mine.name).read_bytes(), "is no part of this sweep"),
        (mine.with_name("part-000004.parquet").read_bytes(), "is part 4 of this sweep, not part 3"),
        (own[:-100], "is damaged or was changed"),
        (own + b"0", "is damaged or was changed"),
        (b"", "is damaged or was changed"),
    ):
        mine.write_bytes(content)
        for read in (
            lambda: swept(tmp_path / "mine", resume=True),
            lambda: swept(tmp_path / "mine"),
            Sweep.of_folder(tmp_path / "mine").table,
            lambda: Sweep.of_folder(tmp_path / "mine").totals,
        ):
            with pytest.raises(OutputError, match=f"part-000003.parquet: {message}.*; move it away and give"):
                read()
    mine.unlink()
    swept(tmp_path / "mine", resume=True)
    assert bits(tmp_path / "mine") == bits(whole)


def test_each_of_200_flipped_bits_of_a_part_is_noticed(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(whole, folder)
    path, chance = folder / "part-000007.parquet", random.Random(7)
    own = path.read_bytes()
    kept = Sweep.of_folder(folder)
    for place in (0, 8 * len(own) - 1, *(chance.randrange(8 * len(own)) for _ in range(198))):
        flipped = bytearray(own)
        flipped[place // 8] ^= 1 << place % 8
        path.write_bytes(flipped)
        with pytest.raises(
            OutputError, match=r"part-000007.parquet: is damaged or was changed: its checksum"
        ):
            read_part(folder, 7, kept.description)
    path.write_bytes(own)
    assert kept.table().equals(Sweep.of_folder(whole).table())


def test_each_flipped_bit_of_the_description_is_noticed(whole: Path, tmp_path: Path) -> None:
    path, chance = tmp_path / "sweep.json", random.Random(8)
    own = (whole / path.name).read_bytes()
    noticed = 0
    for place in [chance.randrange(8 * len(own)) for _ in range(200)]:
        flipped = bytearray(own)
        flipped[place // 8] ^= 1 << place % 8
        path.write_bytes(flipped)
        try:
            found = read_description(tmp_path)
        except OutputError:
            noticed += 1
        else:  # space for a tab, between values
            assert found == json.loads(own)
    assert noticed > 150


def test_a_sweep_without_checksums_is_refused_in_one_line(whole: Path, tmp_path: Path) -> None:
    told = json.loads((whole / "sweep.json").read_text(encoding="utf-8"))
    for content, message in (
        (told | {"format": 1}, "is a sweep of format 1, whose parts carry no checksums; sweep into another"),
        ({"format": 1, "made_by": []}, "is a sweep of format 1, whose parts"),
        ({"format": 2, "made_by": []}, "is damaged or was changed"),
        (told | {"linkages": 299}, "is damaged or was changed: its checksum is that of other values; give"),
    ):
        (tmp_path / "sweep.json").write_text(json.dumps(content), encoding="utf-8")
        with pytest.raises(OutputError, match=f"sweep.json: {message}"):
            Sweep.of_folder(tmp_path)
    (tmp_path / "sweep.json").write_text("[" * 100_000, encoding="utf-8")
    with pytest.raises(OutputError, match=r"sweep.json: is no description of a sweep of format 2; give"):
        Sweep.of_folder(tmp_path)


def test_parts_of_another_vector_unit_are_mixed_only_where_that_is_asked_for(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "moved"
    swept(folder)
    (folder / "part-000002.parquet").unlink()
    here = plan_module.simd_level()
    monkeypatch.setattr(plan_module, "simd_level", lambda: "elsewhere")
    with pytest.raises(OutputError) as caught:
        swept(folder, resume=True)
    assert str(caught.value) == (
        f"{folder}: its parts were made by simd_level {here} and elsewhere, whose last bits may differ; "
        "go on where they were made, or give --mixed to have both"
    )
    assert not (folder / "part-000002.parquet").exists()
    found = swept(folder, resume=True, mixed=True)
    assert [maker["simd_level"] for maker in found.description["made_by"]] == [here, "elsewhere"]
    assert found.table().equals(Sweep.of_folder(whole).table())


def test_a_folder_of_other_things_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(
        OutputError, match=r"holds 'notes.txt' and no sweep.json; give an empty folder or a new"
    ):
        swept(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    with pytest.raises(OutputError, match=r"notes.txt: cannot be written: file exists; "):
        swept(tmp_path / "notes.txt")
    (tmp_path / "torn").mkdir()
    (tmp_path / "torn" / "sweep.json").write_text('{"format": 1')
    with pytest.raises(OutputError, match=r"torn/sweep.json: is no description of a sweep of format 2"):
        swept(tmp_path / "torn", resume=True)
    with pytest.raises(OutputError, match=r"none/sweep.json: cannot be read: no such file or directory"):
        Sweep.of_folder(tmp_path / "none")


def test_a_hidden_file_of_another_program_is_neither_taken_for_a_part_nor_deleted(tmp_path: Path) -> None:
    own, part = tmp_path / ".notes.aside", tmp_path / ".part-000001.parquet.aside"
    own.write_text("mine")
    part.write_bytes(b"half")
    with pytest.raises(OutputError, match=r"holds '.notes.aside' and no sweep.json"):
        swept(tmp_path)
    own.unlink()
    swept(tmp_path)
    own.write_text("mine")
    part.write_bytes(b"half")
    swept(tmp_path, resume=True)
    assert own.read_text() == "mine"
    assert not part.exists()


def test_two_runs_do_not_fill_one_folder(tmp_path: Path) -> None:
    def second(done: int, _total: int) -> None:
        if done == 0:
            with pytest.raises(
                OutputError, match=r"another run fills this folder; wait for it, end it, or give"
            ):
                swept(tmp_path / "one", resume=True)

    assert swept(tmp_path / "one", progress=second).totals.linkages == 300


def test_what_fails_midway_keeps_the_finished_parts(whole: Path, tmp_path: Path) -> None:
    def stopped(done: int, _total: int) -> None:
        if done >= 100:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        swept(tmp_path / "one", progress=stopped)
    kept = bits(tmp_path / "one")
    assert len(kept) == 5
    assert kept.items() <= bits(whole).items()


#: A call of `sevenbar sweep` in which no file may grow beyond a size, as on a disk that is full.
FULL = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv.pop(1)),) * 2)
from sevenbar.commands.cli import main
main()
"""


def test_a_full_disk_leaves_whole_parts_and_says_how_to_go_on(tmp_path: Path) -> None:
    # couplers that reach nothing come first: their parts are small
    sweep = [
        "sweep", "rssr", "--over", "L2=1:1200:16", "--over", "L1=100:900:16", "--part-size", "32",
        "--threads", "1", "--out", "one", "--resume",
    ]  # fmt: skip
    command = [sys.executable, "-c"]
    run_whole = subprocess.run(
        [*command, FULL, str(2**30), *sweep[:-2], "all"], cwd=tmp_path, check=True, capture_output=True
    )
    assert run_whole.returncode == 0
    sizes = {path.name: path.stat().st_size for path in (tmp_path / "all").glob("part*")}
    room = (min(sizes.values()) + max(sizes.values())) // 2
    first = min(name for name, size in sizes.items() if size > room)
    count = int(first[5:11])
    assert count > 0
    full = subprocess.run(
        [*command, FULL, str(room), *sweep], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert full.returncode == 2
    (message,) = [line for line in full.stderr.splitlines() if line.startswith("sevenbar:")]
    assert message == (
        "sevenbar: one: cannot be written: file too large; make room or give a folder that can be written; "
        f"{count} of 8 parts are kept, --resume goes on with them"
    )
    assert sorted(bits(tmp_path / "one")) == [
        *(f"part-{part:06}.parquet" for part in range(count)),
        "sweep.json",
    ]
    subprocess.run([*command, FULL, str(2**30), *sweep], cwd=tmp_path, check=True, capture_output=True)
    assert bits(tmp_path / "one") == bits(tmp_path / "all")


@pytest.mark.parametrize(("kills", "count"), [(3, 80), pytest.param(20, 400, marks=pytest.mark.proof)])
def test_a_sweep_killed_at_random_moments_loses_no_finished_part(
    kills: int, count: int, tmp_path: Path
) -> None:
    sweep = [
        sys.executable, "-m", "sevenbar.commands.cli", "sweep", "seven_r", "--over", "twist_1=30..90", "--over",
        "length_2=80..120", "--count", str(count), "--seed", "3", "--measure", "motion_type,circuits,swing",
        "--samples", "24", "--part-size", "2",
    ]  # fmt: skip
    chance = random.Random(20)
    folder = tmp_path / "killed"
    kept: dict[str, tuple[str, int]] = {}
    for _ in range(kills):
        process = subprocess.Popen(
            [*sweep, "--out", folder, "--resume"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        wanted = len(kept) + chance.randrange(6)
        while process.poll() is None and len(list(folder.glob("part*"))) < wanted:
            time.sleep(0.001)
        time.sleep(chance.uniform(0.0, 0.06))
        process.kill()
        assert process.wait() == -9
        marks = bits(folder) if folder.exists() else {}
        now = {
            name: (mark, (folder / name).stat().st_mtime_ns)
            for name, mark in marks.items()
            if name.startswith("part")
        }
        assert kept.items() <= now.items()
        kept = now
    assert 0 < len(kept) < count / 2
    subprocess.run([*sweep, "--out", folder, "--resume"], check=True, capture_output=True)
    subprocess.run([*sweep, "--out", tmp_path / "whole", "--threads", "1"], check=True, capture_output=True)
    assert bits(folder) == bits(tmp_path / "whole")


def test_memory_stays_flat_through_two_million_linkages(tmp_path: Path) -> None:
    code = (
        "import re, sys, sevenbar as sb\n"
        "from pathlib import Path\n"
        "from sevenbar.sweep import run, span\n"
        "axes = {'M': span(300, 900), 'L1': span(100, 900), 'L2': span(100, 1200), 'D': span(-90, 90)}\n"
        "found = run(sb.load('rssr'), axes, threads=2, count=int(sys.argv[1]), out=sys.argv[2])\n"
        "assert found.totals.rows == int(sys.argv[1])\n"
        # not getrusage, whose peak begins with that of the process it was forked from
        "print(re.search(r'VmHWM:\\s+(\\d+) kB', Path('/proc/self/status').read_text())[1])"
    )
    peaks = []
    for count in (200_000, 2_000_000):
        command = [sys.executable, "-c", code, str(count), str(tmp_path / str(count))]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        peaks.append(int(done.stdout))
    # kilobytes: below 1 GiB, and ten times the linkages cost what the allocator keeps, not ten times
    assert peaks[1] < 2**20
    assert peaks[1] < peaks[0] + 100_000
