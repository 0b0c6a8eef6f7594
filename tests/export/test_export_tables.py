"""The whole motion in tables of other programs: what pandas, NumPy, SciPy and Arrow read is what Sevenbar has."""

import csv
import json
import sys

import numpy as np
import pandas as pd
import pyarrow.parquet
import pytest
from openpyxl import load_workbook
from scipy.io import loadmat

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.description.table_writer import linkage_table
from sevenbar.errors import MissingExtraError, OutputError, RequestError
from sevenbar.export import export
from sevenbar.reporting.csv_tables import write_columns, write_csv
from sevenbar.text.csv_cells import NUMBER
from sevenbar.text.table import read_table


@pytest.fixture(scope="module")
def motion():
    # a slide in inches, dead centres of the input, a named point
    text = (
        'format = 1\nname = "slider in inches"\nlength_unit = "in"\n[drive]\njoint = "slider"\nspeed = "2 in/s"\n'
        '[[joint]]\nname = "crank"\nkind = "R"\nat = [0, 0, 5]\naxis = [0, 0, 1]\n'
        '[[joint]]\nname = "ball_a"\nkind = "S"\nat = [2, 0, 5]\n'
        '[[joint]]\nname = "ball_b"\nkind = "S"\nat = [4, 7, 0]\n'
        '[[joint]]\nname = "slider"\nkind = "P"\nat = [4, 7, 0]\naxis = [1, 0, 0]\n'
        '[[point]]\nname = "B"\nlink = 3\nat = [4, 7, 0]\n'
    )
    return sb.loads(text).motion(24)


def rows_of(motion, name):
    return np.concatenate([getattr(circuit, name) for circuit in motion])


def read_csv(path):
    """Every digit as it is written, which pandas does of itself from 3 on."""
    asked = {} if int(pd.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
    return pd.read_csv(path, **asked)


@pytest.mark.parametrize(
    ("to", "read"), [("csv", read_csv), ("parquet", pd.read_parquet)], ids=["csv", "parquet"]
)
def test_pandas_reads_every_row_of_every_circuit(motion, tmp_path, to, read):
    assert export(motion, to, tmp_path / f"m.{to}") == [tmp_path / f"m.{to}"]
    table = read(tmp_path / f"m.{to}")
    assert len(table) == sum(len(c.time) for c in motion)
    assert "dead-centre" in set(table.status)
    np.testing.assert_array_equal(table.slider_in, rows_of(motion, "q")[:, -1])
    np.testing.assert_array_equal(
        np.radians(table.crank_deg), np.radians(np.degrees(rows_of(motion, "q")[:, 0]))
    )
    np.testing.assert_array_equal(table.crank_rad_s2, rows_of(motion, "ddq")[:, 0])
    np.testing.assert_array_equal(table.time_s, rows_of(motion, "time"))
    assert list(table.status) == list(rows_of(motion, "status"))
    b = np.concatenate([c.point(3, motion.linkage.points[0].at).velocity[:, 0] for c in motion])
    np.testing.assert_array_equal(table.B_vx_in_s, b)


@pytest.mark.parametrize(("to", "read"), [("csv", read_csv), ("parquet", pd.read_parquet)])
def test_si_takes_metres_and_radians(motion, tmp_path, to, read):
    export(motion, to, tmp_path / f"m.{to}", units="si")
    table = read(tmp_path / f"m.{to}")
    np.testing.assert_allclose(table.slider_m, 0.0254 * rows_of(motion, "q")[:, -1], rtol=1e-15)
    np.testing.assert_allclose(table.slider_m_s, 0.0254 * rows_of(motion, "dq")[:, -1], rtol=1e-15)
    np.testing.assert_array_equal(table.crank_rad, rows_of(motion, "q")[:, 0])
    assert not [name for name in table if name.endswith(("_in", "_in_s", "_deg"))]


def test_parquet_carries_the_note_on_names_and_units(motion, tmp_path):
    export(motion, None, tmp_path / "m.parquet")
    schema = pyarrow.parquet.read_schema(tmp_path / "m.parquet")
    note = json.loads(schema.metadata[b"sevenbar"])
    assert note["linkage"] == {"name": "slider in inches", "kind": "RSSP"}
    assert (note["input"], note["output"], note["speed"]) == ("slider", "crank", 2.0)
    assert note["units"]["length"] == "in"


@pytest.mark.parametrize(("units", "inch"), [("file", 1.0), ("si", 0.0254)])
def test_numpy_matlab_and_json_hold_the_same_arrays(motion, tmp_path, units, inch):
    for to in ("npz", "mat", "json"):
        export(motion, to, tmp_path / f"m.{to}", units=units)
    arrays = np.load(tmp_path / "m.npz", allow_pickle=False)
    matlab = loadmat(tmp_path / "m.mat", simplify_cells=True)
    whole = json.loads((tmp_path / "m.json").read_text())
    assert json.loads(str(arrays["note"])) == json.loads(matlab["note"])
    assert whole["units"]["length"] == {"file": "in", "si": "m"}[units]
    assert whole["units"]["angle"] == "rad"
    assert whole["speed"] == pytest.approx(2 * inch, rel=1e-15)
    assert list(arrays["columns"]) == list(matlab["columns"]) == list(motion.linkage.columns)
    scale = np.where(motion.linkage.turning, 1.0, inch)
    circuits = np.atleast_1d(matlab["circuits"])
    assert len(circuits) == len(whole["circuits"]) == len(motion.circuits) > 0
    for circuit, structure, plain in zip(motion, circuits, whole["circuits"], strict=True):
        own = arrays["circuit"] == circuit.index
        for name in ("q", "dq", "ddq", "dddq"):
            expected = getattr(circuit, name) * scale
            assert np.isnan(expected).any() == (name != "q")
            np.testing.assert_allclose(arrays[name][own], expected, rtol=1e-15)
            np.testing.assert_allclose(structure[name], expected, rtol=1e-15)
            np.testing.assert_allclose(np.array(plain[name], dtype=float), expected, rtol=1e-15)
        np.testing.assert_allclose(structure["input"], circuit.input * inch, rtol=1e-15)
        np.testing.assert_array_equal(structure["time"], circuit.time)
        assert list(structure["status"]) == plain["status"] == list(arrays["status"][own])
        b = circuit.point(3, motion.linkage.points[0].at)
        np.testing.assert_allclose(structure["point_B_acceleration"], b.acceleration * inch, rtol=1e-15)


def test_json_is_strict_and_has_null_beside_a_status(motion, tmp_path):
    export(motion, "json", tmp_path / "m.json")

    def refuse(word):
        raise AssertionError(word)

    whole = json.loads((tmp_path / "m.json").read_text(), parse_constant=refuse)
    circuit = whole["circuits"][0]
    dead = circuit["status"].index("dead-centre")
    assert circuit["dq"][dead] == [None] * len(motion.linkage.columns)
    assert circuit["rows"] == len(circuit["q"])


def test_a_file_is_replaced_by_force_only(motion, tmp_path):
    path = tmp_path / "m.csv"
    path.write_text("mine")
    with pytest.raises(OutputError, match=r"m\.csv: exists already; give another path, or --force"):
        export(motion, "csv", path)
    assert path.read_text() == "mine"
    export(motion, "csv", path, force=True)
    assert len(pd.read_csv(path)) > 10
    assert [p.name for p in tmp_path.iterdir()] == ["m.csv"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("docx", "m.csv", {}), "to: 'docx' is not a format; allowed: csv, xlsx, parquet, npz,"),
        (("jso", "m.csv", {}), "to: 'jso' is not a format; did you mean 'json'? allowed"),
        (("json", "m.csv", {}), "m.csv: its ending '.csv' is not that of json; give .json"),
        (("exel", "m.csv", {}), "to: 'exel' is not a format; did you mean 'excel'? allowed: csv, xlsx,"),
        ((None, "m.txt", {}), "m.txt: '.txt' is the ending of no format; give one of .csv, .xlsx, .parquet,"),
        (("step", "m", {}), "m: has no ending; give .step or .stp"),
        (("csv", "m.csv", {"circuit": 0}), "circuit: csv holds all rows of all circuits; leave it out"),
        (("csv", "m.csv", {"at": 0.1}), "at: csv holds all rows of all circuits; leave it out"),
        (("csv", "m.csv", {"units": "metric"}), "units: 'metric' is not offered; give file or si"),
        (("glb", "m.glb", {"units": "si"}), "units: the units of glb are fixed; leave it out"),
        (("glb", "m.glb", {"circuit": 9}), "circuit: 9 is not a circuit of this motion; give 0"),
        (("glb", "m.glb", {"branch": 2}), "branch: 2 is not a pass of circuit 0; give 0 to 1"),
        (("glb", "m.glb", {"at": float("nan")}), "at: nan is not a finite number"),
        (
            ("glb", "m.glb", {"at": 99.0}),
            "at: circuit 0 has no pose of definite joint values at slider = 99 in; give a value from ",
        ),
    ],
)
def test_each_mistake_has_its_message_and_writes_nothing(motion, tmp_path, arguments, message):
    to, name, choices = arguments
    with pytest.raises(RequestError) as caught:
        export(motion, to, tmp_path / name, **choices)
    assert str(caught.value).removeprefix(f"{tmp_path}/").startswith(message)
    assert not list(tmp_path.iterdir())


def test_an_input_beyond_one_circuit_may_be_within_another(tmp_path):
    rocking = sb.load("rssr").motion(24, input="rocker")
    with pytest.raises(RequestError, match=r"from 111\.854 deg to 187\.001 deg, or another circuit"):
        export(rocking, "urdf", tmp_path / "m.urdf", at=0.5)
    assert export(rocking, "urdf", tmp_path / "m.urdf", at=0.5, circuit=1)


def test_a_linkage_that_does_not_close_has_nothing_to_export(tmp_path):
    short = sb.rssr(M=700, N=700, L1=250, L3=550, D=0, L2=10)
    with pytest.raises(RequestError, match="motion: cannot-assemble, so there are no rows to export"):
        export(short, "csv", tmp_path / "m.csv")
    with pytest.raises(RequestError, match="motion: cannot-assemble"):
        export(short, "cmd", tmp_path / "m.cmd")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("to", "package", "extra"),
    [
        ("parquet", "pyarrow", "export"),
        ("mat", "scipy.io", "export"),
        ("glb", "trimesh", "export"),
        ("stl", "manifold3d", "export"),
        ("step", "build123d", "cad"),
    ],
)
def test_a_missing_library_is_named_with_its_extra(motion, tmp_path, monkeypatch, to, package, extra):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingExtraError, match=rf"need.*{package.split('.')[0]}.*'sevenbar\[{extra}\]'"):
        export(motion, to, tmp_path / f"m.{to}")
    assert not list(tmp_path.iterdir())


def test_the_command_says_what_it_wrote_and_ends_mistakes_with_2(tmp_path):
    def run(*arguments):
        return sevenbar("export", *arguments, cwd=tmp_path)

    done = run("rssr", "--to", "urdf", "--at", "30", "--samples", "24")
    assert (done.returncode, done.stderr) == (0, "")
    assert "rssr.urdf" in done.stdout
    assert "the joint that closes the loop is in the .loop.json file" in done.stdout
    pose = json.loads((tmp_path / "rssr.loop.json").read_text())["pose"]
    assert pose["q"]["crank"] == pytest.approx(np.pi / 6, rel=1e-15)
    assert run("rssp", "--out", "new/s.json", "--input", "slider", "--samples", "24").returncode == 0
    assert json.loads((tmp_path / "new" / "s.json").read_text())["input"] == "slider"
    for arguments, message in (
        (["rssr", "--to", "urdf"], "rssr.urdf: exists already; give another path, or --force to replace it"),
        (["rssr"], "--to: missing; give a format, csv, xlsx, parquet,"),
        (["rssr", "--out", "rssr.urdf/x.csv"], "rssr.urdf: cannot be written: it is a file; give a folder"),
        (["rssr", "--to", "doc"], "to: 'doc' is not a format; allowed: csv,"),
        (["rssp", "--to", "glb", "--at", "3mm"], "--at: '3mm' is no value of crank, which turns;"),
    ):
        failed = run(*arguments)
        assert (failed.returncode, failed.stdout) == (2, "")
        assert failed.stderr.startswith(f"sevenbar: {message}")
    assert not (tmp_path / "rssp.glb").exists()
    written, masses = run("rssr", "--to", "mjcf", "--samples", "24").stdout.splitlines()
    assert written == "written: rssr.xml"
    assert masses == "masses are assumed: 1 kg for every body; put in your own where forces matter"
    assert run("rssr", "--to", "urdf", "--force", "--samples", "24").returncode == 0


def drawn(*names, points=()):
    """A slider-crank whose joints have these names, and points on its rod."""
    kinds, places, axes = (
        "RRRP",
        ((0, 0, 0), (40, 0, 0), (180, 0, 0), (180, 0, 0)),
        ((0, 0, 1),) * 3 + ((1, 0, 0),),
    )
    joints = [
        {"name": name, "kind": kind, "at": at, "axis": axis}
        for name, kind, at, axis in zip(names, kinds, places, axes, strict=True)
    ]
    at = [{"name": name, "link": 3, "at": (50 + i, 10, 0)} for i, name in enumerate(points)]
    return sb.from_axes(joints, points=at, name="=1+1")


LONG = ("tool centre point", "x" * 60, "x" * 60 + "y", "spitze_ä", "spitze_ö", "P")


def test_points_with_long_and_foreign_names_are_fields_of_their_own_in_matlab(tmp_path):
    motion = drawn("crank", "pin", "wrist", "slider", points=LONG).motion(24)
    export(motion, "mat", tmp_path / "m.mat")
    matlab = loadmat(tmp_path / "m.mat", simplify_cells=True)
    short = json.loads(matlab["note"])["fields"]
    circuit = motion.circuits[0]
    structure = np.atleast_1d(matlab["circuits"])[0]
    assert all(len(name) <= 63 and name.isascii() for name in structure)
    assert len(set(short.values())) == len(short) == 3 * 4
    for point in motion.linkage.points:
        for quantity in ("position", "velocity", "acceleration"):
            name = f"point_{point.name}_{quantity}"
            own = getattr(circuit.point(point.link, point.at), quantity)
            np.testing.assert_allclose(structure[short.get(name, name)], own, rtol=1e-15)
    assert "point_tool centre point_position" in structure
    assert short["point_spitze_ä_position"] == "point_spitze___position"
    assert short["point_spitze_ö_position"] == "point_spitze___1_position"


RUN = ("=cmd|'/C calc'!A0", "+1+cmd", "-2+3", "@SUM(1)")
SIGNS = ("=", "+", "-", "@", "＝")


def test_no_cell_of_a_csv_file_is_run_and_names_are_read_as_they_were(tmp_path):
    linkage = drawn(*RUN, points=("a;=b", "'=c"))
    motion = linkage.motion(24)
    export(motion, "csv", tmp_path / "m.csv")
    for mark in (",", ";"):
        for line in csv.reader((tmp_path / "m.csv").read_text().splitlines(), delimiter=mark):
            assert not [cell for cell in line if cell.startswith(SIGNS) and not NUMBER.fullmatch(cell)]
    names = read_table(tmp_path / "m.csv", "rows").names
    assert list(names) == list(motion.columns())
    columns = motion.columns()
    write_columns(tmp_path / "law.csv", {name: columns[name][:20] for name in ("time_s", f"{RUN[0]}_deg")})
    law = sb.load_law(tmp_path / "law.csv", linkage)
    np.testing.assert_allclose(law.q, motion.circuits[0].q[:20, 0], rtol=1e-14)
    found = sevenbar("analyze", "rssr", "--out", tmp_path / "rssr")
    assert found.returncode == 0
    assert "'" not in (tmp_path / "rssr" / "motion.csv").read_text()


def test_a_linkage_table_with_names_like_formulas_is_written_harmless_and_read_alike(tmp_path):
    linkage = drawn(*RUN)
    head, rows = linkage_table(linkage)
    write_csv(tmp_path / "loop.csv", head, rows)
    assert sb.load(tmp_path / "loop.csv").columns == linkage.columns
    export(linkage.motion(24), "xlsx", tmp_path / "m.xlsx")
    book = load_workbook(tmp_path / "m.xlsx")
    assert {cell.data_type for sheet in book for row in sheet for cell in row} <= {"s", "n"}
    assert sb.load(tmp_path / "m.xlsx").columns == linkage.columns
