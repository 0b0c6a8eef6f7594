"""Motions of very many rows: computed circuit by circuit, the same to the last bit, in little memory."""

import csv
import pickle
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.export import export
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.long_circuit import BY_ROW, LONG, LongCircuit
from sevenbar.kinematics.solvers import general
from sevenbar.reporting import csv_tables, report

#: Loops of each way to a row: round, to and fro, backwards, with balls, on slides, over dead centres.
CASES = [
    ("seven_r", {}),
    ("seven_r", {"speed": -2.0}),
    ("rscr", {}),
    ("rsur", {"input": "cross.2"}),
    ("rsur", {"speed": -1.0}),
    ("six_bar", {"input": "parallel_3"}),
    ("rssp", {"input": "slider"}),
    ("rssp", {}),
    ("bennett", {}),
    ("screw_drill", {}),
]


@pytest.fixture
def long(monkeypatch):
    """Every motion of a general loop is long."""
    monkeypatch.setattr(general, "LONG", 4)


def both(name, chosen, monkeypatch, samples=90):
    """The motion with rows that are kept, and with rows that are not."""
    kept = sb.load(name).motion(samples, **chosen)
    with monkeypatch.context() as patch:
        patch.setattr(general, "LONG", 4)
        return kept, sb.load(name).motion(samples, **chosen)


@pytest.mark.parametrize(("name", "chosen"), CASES)
def test_rows_that_are_computed_again_are_the_same_to_the_last_bit(name, chosen, monkeypatch):
    kept, long = both(name, chosen, monkeypatch)
    assert len(kept.circuits) == len(long.circuits) > 0
    for one, other in zip(kept, long, strict=True):
        assert type(one) is Circuit
        assert type(other) is LongCircuit
        tally = other.tally
        assert "q" not in vars(other)
        assert tally == one.tally
        for field in fields(Circuit):
            first, second = getattr(one, field.name), getattr(other, field.name)
            if isinstance(first, np.ndarray):
                np.testing.assert_array_equal(first, second)
            elif not field.name.startswith("_"):
                assert first == second or (first != first and second != second), field.name
        trace, again = (c.point(1, (3.0, -2.0, 5.0)) for c in (one, other))
        np.testing.assert_array_equal(trace.jerk, again.jerk)
        np.testing.assert_array_equal(trace.status, again.status)


@pytest.mark.parametrize(("name", "chosen"), CASES)
def test_reports_and_tables_are_the_same_to_the_last_digit(name, chosen, monkeypatch, tmp_path):
    kept, long = both(name, chosen, monkeypatch)
    assert report.as_json(kept) == report.as_json(long)
    assert report.markdown(kept) == report.markdown(long)
    # several pieces, the last of them shorter
    monkeypatch.setattr(csv_tables, "ROWS_AT_ONCE", 7)
    export(long, "csv", tmp_path / "long.csv")
    columns = kept.columns()
    head, *lines = csv.reader((tmp_path / "long.csv").read_text(encoding="utf-8").splitlines())
    assert head == list(columns)
    wanted = [
        ["" if cell != cell else str(cell) for cell in line]
        for line in zip(*(column.tolist() for column in columns.values()), strict=True)
    ]
    assert lines == wanted


@pytest.mark.usefixtures("long")
def test_a_table_that_goes_through_the_circuits_keeps_none_of_their_rows(tmp_path):
    motion = sb.load("seven_r").motion(24)
    export(motion, "csv", tmp_path / "rows.csv")
    export(motion, "parquet", tmp_path / "rows.parquet")
    report.as_json(motion)
    assert all(not BY_ROW & set(vars(circuit)) for circuit in motion)
    first = motion.circuits[0]
    assert first.fleeting() is not first
    assert first.q is first.q
    assert set(vars(first)) >= BY_ROW
    assert first.fleeting() is first


@pytest.mark.usefixtures("long")
def test_a_long_circuit_is_pickled_as_its_numbers_and_has_no_other_names():
    circuit = sb.load("rscr").motion(24).circuits[0]
    again = pickle.loads(pickle.dumps(circuit))
    np.testing.assert_array_equal(again.q, circuit.q)
    np.testing.assert_array_equal(again.point(1, (1, 2, 3)).velocity, circuit.point(1, (1, 2, 3)).velocity)
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        circuit.nothing  # noqa: B018


@pytest.mark.usefixtures("long")
def test_parquet_in_pieces_is_one_table_with_its_note(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    motion = sb.load("seven_r").motion(24)
    export(motion, "parquet", tmp_path / "rows.parquet")
    table = parquet.read_table(tmp_path / "rows.parquet")
    assert b"sevenbar" in table.schema.metadata
    for name, values in motion.columns().items():
        np.testing.assert_array_equal(table[name].to_numpy(), values)


PEAK = """
import sys
from sevenbar.commands.cli import main
sys.argv[:] = ["sevenbar", "analyze", "seven_r", "--samples", "2e5", *sys.argv[1:]]
try:
    main()
finally:
    # of this program alone: ru_maxrss has what the parent held when it forked
    peak = next(line for line in open("/proc/self/status") if line.startswith("VmHWM"))
    print(int(peak.split()[1]) // 1024, file=sys.stderr)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux's /proc")
def test_many_samples_of_many_circuits_take_the_memory_of_one():
    run = subprocess.run([sys.executable, "-c", PEAK, "--json"], capture_output=True, text=True, check=True)
    # kept, the rows of the eight circuits took 1,250 MB
    assert int(run.stderr.split()[-1]) < 400
    assert f'"rows": {200_000}' in run.stdout


def test_the_threshold_keeps_what_people_usually_do_with_its_rows():
    assert LONG > 3600
    assert all(type(circuit) is Circuit for circuit in sb.load("bennett").motion(360))
