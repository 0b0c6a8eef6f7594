"""Linkages in tables: what spreadsheets and people write, the place of each mistake, and the way there and back."""

import csv
import io
import math
import re
import sys

import numpy as np
import openpyxl
import pandas as pd
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.description import gallery
from sevenbar.description.draft import Draft
from sevenbar.description.files import note_of, toml_text
from sevenbar.description.table_columns import SPELLINGS, key_of
from sevenbar.description.table_writer import linkage_table, points_table
from sevenbar.errors import DescriptionError, MissingExtraError, RequestError, TableError
from sevenbar.export import export

#: The 7R paper's rows, as they are in `seven_r`.
ROWS = [(45, 80, 70), (15, -95, 10), (100, 0, 10), (-115, 0, 10), (10, -75, 10), (35, 80, 10), (35, 150, -60)]


def written(rows, head, delimiter=",", decimal="."):
    lines = [head] + [[str(cell).replace(".", decimal) for cell in row] for row in rows]
    return "".join(delimiter.join(map(str, line)) + "\n" for line in lines)


def saved(path, rows, sheet="Sheet1"):
    book = openpyxl.Workbook()
    book.active.title = sheet
    for row in rows:
        book.active.append(list(row))
    book.save(path)
    return path


def is_seven_r(linkage):
    return np.array_equal(linkage.transforms, sb.load("seven_r").transforms)


DH = ("a [mm]", "alpha [deg]", "d [mm]")


@pytest.mark.parametrize(
    "content",
    [
        written(ROWS, DH),
        written(ROWS, ("length_mm", "twist_deg", "offset_mm")),
        written(ROWS, ("a_i (mm)", "α_i (°)", "d_i (mm)")),
        written(ROWS, ("Link length [mm]", "Link twist [degrees]", "Joint offset [mm]")),
        written(ROWS, ("a", "alpha", "d"))[:-1].replace("\n", "\nmm,deg,mm\n", 1),
        written([(i, *row, f"theta_{i}") for i, row in enumerate(ROWS, 1)], ("joint", *DH, "theta [deg]")),
        written([("R", *row, "") for row in ROWS], ("joint", *DH, "theta")),
        written([("revolute", *row, "*") for row in ROWS], ("type", *DH, "θ")),
        written([(f"J{i}", "R", *row) for i, row in enumerate(ROWS, 1)], ("joint", "type", *DH)),
        written(ROWS, DH, "\t"),
        written([(f"{a}.0", b, c) for a, b, c in ROWS], DH, ";", ","),
        "\ufeff" + written(ROWS, DH).replace("\n", "\r\n"),
        "# the paper's loop\n\n7R\n" + written(ROWS, DH) + ",,\n",
        written([(a, f"{b}*pi/180", c) for a, b, c in ROWS], ("a [mm]", "alpha", "d [mm]")),
        written([(f"{a}mm", f"{b}deg", f"{c / 10} cm") for a, b, c in ROWS], ("a", "alpha", "d")),
        " a[mm]  alpha[deg]  d[mm]\n" + "".join(f"  {a}  {b}   {c}\n" for a, b, c in ROWS),
    ],
)
def test_denavit_hartenberg_rows_are_read_as_people_write_them(tmp_path, content):
    path = tmp_path / "dh.csv"
    path.write_text(content, encoding="utf-8")
    linkage = sb.load(path)
    np.testing.assert_allclose(linkage.transforms, sb.load("seven_r").transforms, rtol=0, atol=1e-13)
    assert linkage.kind == "RRRRRRR"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252"])
def test_a_table_is_read_in_the_encodings_of_spreadsheets(tmp_path, encoding):
    path = tmp_path / "dh.csv"
    path.write_text("Prüfstand\n" + written(ROWS, DH), encoding=encoding)
    assert is_seven_r(sb.load(path))
    assert sb.load(path).name == "Prüfstand"


def test_every_spelling_has_one_meaning():
    for key, spellings in SPELLINGS.items():
        assert {key_of(word) for word in spellings} == {key}
    assert [key_of(word) for word in ("axis_x", "ux", "Point_X", "x", "at y", "axis2 z")] == [
        "axis x",
        "axis x",
        "x",
        "x",
        "y",
        "axis 2 z",
    ]


def test_lengths_and_angles_of_several_units_are_brought_to_the_first(tmp_path):
    path = tmp_path / "dh.csv"
    rows = [(a / 10, math.radians(b), c / 25.4) for a, b, c in ROWS]
    path.write_text(written(rows, ("a [cm]", "alpha [rad]", "d [in]")))
    linkage = sb.load(path)
    assert (linkage.length_unit, linkage.description["angle_unit"]) == ("cm", "rad")
    scaled = sb.load("seven_r").transforms.copy()
    scaled[:, :3, 3] /= 10
    np.testing.assert_allclose(linkage.transforms, scaled, rtol=0, atol=1e-13)


def test_sliding_and_screw_joints_leave_what_moves_open(tmp_path):
    path = tmp_path / "dh.csv"
    path.write_text(
        "joint,a [mm],alpha [deg],d [mm],theta [deg],pitch [mm/turn],input\nR,1,90,2,theta1,,\nP,3,90,d2,30,,x\nH,4,90,5,q,8,\nR,1,0,0,0,0,\n"
    )
    linkage = sb.load(path)
    assert linkage.kind == "RPHR"
    assert linkage.drive.joint == "theta_2"
    assert dict(linkage.dimensions) == dict(
        sb.from_dh("RPHR", length=[1, 3, 4, 1], twist=[math.pi / 2] * 3 + [0], offset=[2, None, 5, 0], angle=[None, math.pi / 6, None, None],
                   pitch=[None, None, 8, None]).dimensions
    )  # fmt: skip


JOINTS = """name,kind,x [mm],y [mm],z [mm],axis x,axis y,axis z,link,input,remark
crank,revolute,0,0,700,0,0,1,,10 rad/s,bought
ball_a,ball,250,0,700,,,,,,
ball_b,S,700,550,0,,,,,,
rocker,R,700,0,0,1,0,0,,,
P,point,700,300,0,,,,3,,
"""


def test_joints_as_drawn_are_read_with_points_and_input(tmp_path):
    path = tmp_path / "joints.csv"
    path.write_text(JOINTS)
    linkage = sb.load(path)
    assert (linkage.kind, linkage.drive.joint, linkage.drive.speed) == ("RSSR", "crank", 10)
    assert linkage.points[-1] == sb.Point("P", 3, (700, 300, 0))
    np.testing.assert_allclose(linkage.motion().limits, sb.load("rssr").motion().limits)
    assert linkage.lengths == pytest.approx(sb.load("rssr").lengths)
    assert note_of(path) == "read as 4 joints as drawn, in loop order, lengths in mm; not read: remark"


def test_rows_are_put_in_the_order_given_and_others_left_out(tmp_path):
    path = tmp_path / "joints.csv"
    order = {"crank": 1, "ball_a": 2, "ball_b": 3, "rocker": 4}
    lines = JOINTS.splitlines()
    mixed = [f"order,{lines[0]}"] + [
        f"{order.get(line.split(',')[0], '')},{line}" for line in reversed(lines[1:])
    ]
    path.write_text("\n".join([*mixed, ",axis_9,,1,2,3,0,0,1,,,\n"]))
    assert sb.load(path).columns == sb.load("rssr").columns
    assert "1 row without a kind left out" in note_of(path)


def test_the_dimensions_of_an_rssr_are_a_row(tmp_path):
    path = tmp_path / "rssr.csv"
    path.write_text("M [mm],N [mm],L1 [mm],L3 [mm],D [mm]\n700,700,250,550,0\n")
    assert sb.load(path).dimensions == sb.load("rssr").dimensions


@pytest.mark.parametrize(
    ("content", "messages"),
    [
        ("joint,a [mm],alpha [deg]\nR,1,2\nR,ninety,3\nR,1,5 mm\n",
         ["line 3, column 'a [mm]': 'ninety': no 'ninety' is known; give a length, as in 250, '25 cm' or '50*sin(30deg)'",
          "line 4, column 'alpha [deg]': '5 mm': is a length where an angle belongs; give an angle, as in 30, '30deg' or 'pi/6'"]),
        ("a [mm],alpha\n1,20\n1,0\n1,0\n",
         ["line 2, column 'alpha': 20 has no unit; write it in the header, as in 'alpha [deg]' or 'alpha [rad]'"]),
        ("a [mm],alpha [mm]\n1,20\n1,0\n", ["column 'alpha [mm]': 'mm' is not a unit of angles; give one like deg"]),
        ("a [mm],alpha [deg],theta [deg]\n1,20,30\n1,0,\n1,2,\n",
         ["line 2, column 'theta [deg]': is what moves in a joint of kind R; leave it out"]),
        ("joint,a [mm],d [mm]\nR,1,2\nX,1,3\nR,1,5\n",
         ["line 3, column 'joint': 'X' is not a joint kind; allowed: R, P, H"]),
        ("type,a [mm],d [mm]\nR,1,2\nuniversal,1,3\nR,1,5\n",
         ["line 3, column 'type': 'U' takes more than one row; write R and R, or draw the loop as [[joint]]"]),
        ("a [mm],alhpa [deg],d [mm]\n1,2,3\n", ["column 'alhpa [deg]': is not known here; did you mean 'alpha'?"]),
        ("a_i-1 [mm],alpha_i-1 [deg],d [mm]\n1,2,3\n",
         [f"column '{name}': is of modified (Craig's) Denavit-Hartenberg rows; give classic ones, A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha): "
          "length and twist of the link after joint i" for name in ("a_i-1 [mm]", "alpha_i-1 [deg]")]),
        ("a [mm],length [mm],d [mm]\n1,2,3\n", ["column 'length [mm]': is length, as is 'a [mm]'; leave one out"]),
        ("i,a [mm],d [mm]\n1,1,2\n3,1,2\n2,1,2\n", ["column 'i': its numbers are not in order; give the rows in loop order"]),
        ("a [mm],d [mm],input\n1,2,x\n3,4,x\n1,2,\n", ["line 3, column 'input': is a second input; mark one row"]),
        ("a [mm],d [mm],input\n1,2,first\n3,4,\n1,2,\n",
         ["line 2, column 'input': 'first' marks nothing; write x, or a speed as in '60 rpm'"]),
        ("a [mm],d [mm],input\n1,2,10 mm/s\n3,4,\n1,2,\n",
         ["line 2, column 'input': '10 mm/s' is a sliding speed, and the input turns; give a number and a unit, as in '10 rad/s' or '60 rpm'"]),
        ("a [mm],d [mm]\n", ["has a header but no rows; give one for each joint"]),
        ("a [mm],d [mm]\n1,2\n", ["a loop of 1 joint is not taken; give 2 to 12"]),
        ("kind,x [mm],y [mm],z [mm],axis x,axis y,axis z\nR,0,0,0,0,0,0\nR,1,,0,0,0,1\n,5,0,0,0,0,1\nR,1,2,3,0,0,1\n",
         ["line 3, column 'y [mm]': is empty; give a number, 0 where it is none",
          "line 4, column 'kind': no kind of joint; give one of R, P, H, C, U, S, E, K, L",
          "line 2, columns 'axis x', 'axis y', 'axis z': [0.0, 0.0, 0.0] has no direction; give three numbers, not all 0"]),
        ("kind,x [mm],y [mm]\nR,0,0\nS,1,0\nS,1,1\nP,0,1\n",
         [f"line {line}: no axis; a joint of kind {kind} needs one, in columns axis x, axis y, axis z" for line, kind in ((2, "R"), (5, "P"))]),
        ("kind,x [mm],y [mm],alpha [deg]\nR,0,0,0\n",
         ["'alpha [deg]': of Denavit-Hartenberg rows, x, y, z of joints as drawn; leave one out"]),
        (" \n", ["is empty; give a table with a header and a row for each joint"]),
        ("what,is,this\n1,2,3\n",
         ["no header of a linkage's table; name the columns as in 'joint, a [mm], alpha [deg], d [mm]' for Denavit-Hartenberg rows, "
          "'name, kind, x [mm], y [mm], z [mm], axis x, axis y, axis z' for joints as drawn, or 'name, x [mm], y [mm], links' for pins"]),
    ],
)  # fmt: skip
def test_each_mistake_of_a_table_has_its_line_and_column(tmp_path, content, messages):
    path = tmp_path / "t.csv"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(DescriptionError) as refused:
        sb.load(path)
    assert [line.removeprefix(f"{path}: ") for line in str(refused.value).splitlines()] == messages


def test_a_workbook_names_its_cells(tmp_path):
    path = saved(tmp_path / "dh.xlsx", [("a [mm]", "alpha [deg]"), (1, 2), (3, "x"), (4, 5)])
    with pytest.raises(
        DescriptionError, match=r"row 3, column 'alpha \[deg\]' \(cell B3\): 'x': no 'x' is known"
    ):
        sb.load(path)


def test_a_workbook_is_read_with_its_title_and_points(tmp_path):
    path = saved(tmp_path / "dh.xlsx", [("Our loop",), (), DH, *ROWS])
    book = openpyxl.load_workbook(path)
    points = book.create_sheet("Points")
    for row in [("name", "link", "u [mm]", "v [mm]", "w [cm]"), ("P", 4, -100, -90, -8)]:
        points.append(row)
    book.save(path)
    linkage = sb.load(path)
    assert is_seven_r(linkage)
    assert linkage.name == "Our loop"
    assert linkage.points == sb.load("seven_r").points


def test_a_formula_without_its_value_is_refused_with_its_cell(tmp_path):
    path = saved(tmp_path / "dh.xlsx", [("a [mm]", "alpha [deg]"), (1, "=10*2"), (1, 2)])
    with pytest.raises(
        TableError,
        match=r"sheet 'Sheet1', cell B2: '=10\*2' is a formula whose value the file does not hold; open",
    ):
        sb.load(path)


def test_without_openpyxl_one_message_says_what_to_install(tmp_path, monkeypatch):
    path = saved(tmp_path / "dh.xlsx", [DH, *ROWS])
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(
        MissingExtraError,
        match=r"an Excel workbook needs openpyxl; install it with: pip install 'sevenbar\[excel\]', or export",
    ):
        sb.load(path)
    with pytest.raises(MissingExtraError, match=r"xlsx needs openpyxl"):
        export(sb.load("rssr"), "xlsx", tmp_path / "m.xlsx")


@pytest.mark.parametrize("content", [b"PK\x03\x04 cut", b"PK\x03\x04"])
def test_a_damaged_workbook_is_refused(tmp_path, content):
    path = tmp_path / "dh.xlsx"
    path.write_bytes(content)
    with pytest.raises(TableError, match="is no Excel workbook that can be read; save it again"):
        sb.load(path)


@pytest.mark.parametrize("name", gallery.loops())
def test_the_gallery_goes_to_tables_and_back(tmp_path, name):
    linkage = sb.load(name)
    head, rows = linkage_table(linkage)
    path = tmp_path / "t.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([[linkage.name], head, *rows])
    book = saved(tmp_path / "t.xlsx", [[linkage.name], head, *rows], "linkage")
    added = openpyxl.load_workbook(book)
    sheet = added.create_sheet("points")
    for row in [points_table(linkage)[0], *points_table(linkage)[1]]:
        sheet.append(row)
    added.save(book)
    for back in (sb.load(path), sb.load(book), sb.loads(toml_text(path))):
        np.testing.assert_allclose(back.transforms, linkage.transforms, rtol=3e-16, atol=1e-16)
        assert (back.drive, back.name, back.columns) == (linkage.drive, linkage.name, linkage.columns)
    assert sb.load(book).points == linkage.points
    # openpyxl writes 16 digits, a text file all of them
    np.testing.assert_array_equal(sb.load(path).transforms, linkage.transforms)


def test_a_table_opens_as_a_draft_and_is_written_as_toml(tmp_path):
    path = tmp_path / "dh.csv"
    path.write_text(written(ROWS, DH))
    draft = Draft.of(toml_text(path), str(path)).with_values({"length_1": 46.0})
    assert sb.loads(draft.toml()).dimensions["length_1"] == 46
    assert draft.toml().startswith("# Read as 7 classic Denavit-Hartenberg rows")


# Python


def test_data_frames_and_their_columns_are_taken_where_lists_are():
    frame = pd.DataFrame(ROWS, columns=DH)
    for linkage in (
        sb.from_table(frame),
        sb.from_dh(frame),
        sb.from_dh("R" * 7, length=frame["a [mm]"], twist=frame["alpha [deg]"], offset=frame["d [mm]"]),
        sb.from_dh(
            "R" * 7,
            length=frame["a [mm]"].to_numpy(),
            twist=[f"{row[1]} deg" for row in ROWS],
            offset=tuple(row[2] for row in ROWS),
        ),
        sb.from_table({name: [row[k] for row in ROWS] for k, name in enumerate(DH)}),
    ):
        np.testing.assert_allclose(linkage.transforms, sb.load("seven_r").transforms, rtol=0, atol=1e-13)
    assert sb.from_table(frame, name="ours", speed="60 rpm").drive.speed == pytest.approx(2 * math.pi)


def test_a_column_is_in_the_unit_of_its_name():
    frame = pd.DataFrame({"a [in]": [1, 2, 1, 2], "alpha [deg]": [30, 60, 30, 60]})
    linkage = sb.from_dh("RRRR", length=frame["a [in]"], twist=frame["alpha [deg]"])
    assert linkage.dimensions["length_2"] == pytest.approx(50.8)
    assert linkage.dimensions["twist_1_deg"] == pytest.approx(30)


def test_offsets_and_twists_may_be_left_out_in_python_too():
    assert sb.from_dh("RRRR", length=[40, 100, 80, 90]).motion(12).motion_type == "crank-rocker"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sb.from_dh("RRRR", a=[1, 2, 1, 2]),
         "a: is called length here (a is length, alpha twist, d offset, theta angle); give length="),
        (lambda: sb.from_dh("RRRR", twist=["30", "1 deg", "pi/2", "0.1 rad"]),
         "twist[0]: '30' has no unit; give one as in '30 deg', or a number in radians"),
        (lambda: sb.from_dh("RRRR", alpha=[1, 2, 1, 2]), "alpha: is called twist here"),
        (lambda: sb.from_dh("RRRR", lenght=[1, 2, 1, 2]), "lenght: is no argument; did you mean 'length'?"),
        (lambda: sb.from_dh(pd.DataFrame(ROWS, columns=DH), length=[1]), "length: is given in addition to a data frame; leave one out"),
        (lambda: sb.from_dh("RR", length=pd.Series([1, 2], name="alpha [deg]")), "length: the unit of column 'alpha [deg]' is not one of lengths"),
        (lambda: sb.from_table(3), "table: 3 is not a table; give the path of a CSV or Excel file, or a data frame"),
        (lambda: sb.from_table(pd.DataFrame({"a [mm]": [1, "w"], "d [mm]": [1, 2]})), "table: data row 2, column 'a [mm]': 'w': no 'w'"),
        (lambda: sb.rssr(M=700, N=700, L1=250, L3=550), "rssr.D: is missing; needed here: M, N, L1, L3, D"),
    ],
)  # fmt: skip
def test_each_mistake_in_python_has_its_message(call, message):
    with pytest.raises((RequestError, DescriptionError)) as refused:
        call()
    assert str(refused.value).startswith(message)


# Commands


def test_every_command_takes_a_table_and_says_how_it_was_read(tmp_path):
    (tmp_path / "dh.csv").write_text(written(ROWS, DH))
    run = sevenbar("analyze", "dh.csv", "--json", "--samples", "24", cwd=tmp_path)
    assert run.returncode == 0
    assert run.stdout.startswith("{")
    assert run.stderr == (
        "dh.csv: read as 7 classic Denavit-Hartenberg rows (Rz Tz Tx Rx, the last link is the ground), "
        "lengths in mm, angles in deg\n"
    )
    assert mistake("dh.csv", cwd=tmp_path) == (
        "dh.csv: is a linkage, where a command should stand; give: sevenbar analyze dh.csv"
    )
    (tmp_path / "wrong.csv").write_text("a [mm],alpha [deg]\n1,w\n1,2\n")
    assert mistake("analyze", "wrong.csv", cwd=tmp_path).startswith("wrong.csv: line 2, column 'alpha [deg]'")
    assert "did you mean 'dh.csv'" in mistake("analyze", "dh.cvs", cwd=tmp_path)


def test_export_to_excel_holds_each_circuit_the_linkage_and_its_points(tmp_path):
    run = sevenbar("export", "seven_r", "--to", "excel", "--samples", "12", cwd=tmp_path)
    assert (run.returncode, run.stdout.split()[-1]) == (0, "seven_r.xlsx")
    motion = sb.load("seven_r").motion(12)
    book = openpyxl.load_workbook(tmp_path / "seven_r.xlsx")
    assert book.sheetnames == [*(f"circuit {k}" for k in range(8)), "linkage", "points"]
    columns = motion.columns()
    for k in range(8):
        head, *rows = book[f"circuit {k}"].values
        assert list(head) == list(columns)
        own = columns["circuit"] == k
        for place, name in enumerate(head):
            found = [row[place] for row in rows]
            wanted = columns[name][own].tolist()
            plain = [None if value != value else value for value in wanted]
            assert found == [
                pytest.approx(value, rel=3e-16) if isinstance(value, float) else value for value in plain
            ]
    back = sb.load(tmp_path / "seven_r.xlsx")
    np.testing.assert_array_equal(back.transforms, motion.linkage.transforms)
    assert (back.points, back.drive, back.name) == (
        motion.linkage.points,
        motion.linkage.drive,
        motion.linkage.name,
    )


def test_values_that_do_not_exist_are_empty_cells_beside_their_status(tmp_path):
    linkage = sb.rssr(M=700, N=700, L1=600, L3=550, D=0)
    export(linkage, "xlsx", tmp_path / "m.xlsx", samples=12)
    head, *rows = openpyxl.load_workbook(tmp_path / "m.xlsx")["circuit 0"].values
    dead = [row for row in rows if row[head.index("status")] == "dead-centre"]
    assert dead
    assert all(row[head.index("rocker_rad_s")] is None for row in dead)


def test_measured_values_laws_and_curves_are_read_from_workbooks(tmp_path):
    circuit = sb.load("rssr").motion(24).circuits[0]
    degrees = np.degrees(circuit.q[:, [0, -1]])
    bench = saved(tmp_path / "bench.xlsx", [("crank [deg]", "rocker [deg]"), *degrees.tolist()])
    run = sevenbar("compare", "rssr", bench, "--json", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    times = np.linspace(0, 1, 12)
    law = saved(
        tmp_path / "law.xlsx", [("time [s]", "crank [deg]"), *np.column_stack([times, 90 * times]).tolist()]
    )
    np.testing.assert_allclose(sb.load_law(law, sb.load("rssr")).q, np.radians(90 * times), atol=1e-15)
    book = saved(tmp_path / "empty.xlsx", [])
    with pytest.raises(TableError, match="is empty; give a workbook with a table"):
        sb.load_law(book, sb.load("rssr"))


def test_what_a_frame_has_is_not_given_beside_it_and_a_speed_that_is_given_counts():
    frame = pd.DataFrame(ROWS, columns=DH)
    for more in ({"names": ["a", "b", "c", "d"]}, {"length_unit": "cm"}):
        with pytest.raises(RequestError, match="is given in addition to a data frame; leave one out"):
            sb.from_dh(frame, **more)
    assert sb.from_dh(frame, speed="60 rpm").drive.speed == pytest.approx(math.tau, rel=1e-15)


@pytest.mark.parametrize("name", ["%s%n", "# 1", "%"])
def test_a_name_in_a_workbook_that_begins_as_a_remark_does_is_a_name(tmp_path, name):
    joints = [
        {"name": f"{name} {i}", "kind": "RRRP"[i], "at": at, "axis": (1, 0, 0) if i == 3 else (0, 0, 1)}
        for i, at in enumerate([(0, 0, 0), (40, 0, 0), (180, 0, 0), (180, 0, 0)])
    ]
    linkage = sb.from_axes(joints)
    export(linkage.motion(12), None, tmp_path / "named.xlsx")
    assert sb.load(tmp_path / "named.xlsx").columns == linkage.columns


# Links by name

PINS = """Watt's six-bar
name,x [mm],y [mm],links,input
crank,0,0,frame crank,60 rpm
,10,40,crank coupler,
,110,80,coupler; rocker,
rocker,100,0,"frame, rocker",
,150,60,rocker link,
,220,70,link lever,
lever,200,0,lever frame,
"""

HUB = """name,kind,x,y,z,x 2,y 2,z 2,axis x,axis y,axis z,between,link,drive
lower,R,0,0,0,,,,1,0,0,chassis; lower arm,,x
upper,R,0,50,200,,,,1,0.1,0,chassis; upper arm,,
foot,S,0,350,-20,,,,,,,lower arm; upright,,
head,S,10,300,210,,,,,,,upper arm; upright,,
track rod,rod,120,60,80,110,340,90,,,,chassis; upright,,
wheel,point,0,400,90,,,,,,,,upright,
"""


def test_a_table_of_pins_is_the_net_of_a_file(tmp_path):
    path = tmp_path / "pins.csv"
    path.write_text(PINS)
    linkage, drawn = sb.load(path), sb.load("watt")
    assert note_of(path) == "read as 7 pins of a planar linkage, lengths in mm; frame stands still"
    assert (linkage.name, linkage.drive.joint) == ("Watt's six-bar", "crank")
    assert linkage.drive.speed == pytest.approx(2 * math.pi)
    assert np.array_equal(linkage.frames, drawn.frames)
    assert linkage.link_names == drawn.link_names
    # and is written as a file
    assert np.array_equal(sb.loads(toml_text(path)).frames, drawn.frames)
    book = saved(
        tmp_path / "pins.xlsx",
        [line.split(",") for line in PINS.replace('"frame, rocker"', "frame rocker").splitlines()[1:]],
    )
    assert np.array_equal(sb.load(book).frames, drawn.frames)
    run = sevenbar("analyze", "pins.csv", "--json", cwd=tmp_path)
    assert (run.returncode, "7 pins of a planar linkage" in run.stderr) == (0, True)


def test_a_data_frame_of_pins_is_taken_where_pins_are():
    frame = pd.read_csv(io.StringIO(PINS), skiprows=1)
    plain = sb.load("watt")
    without = frame.drop(columns="input")
    links = [tuple(re.split(r"[;, ]+", cell)) for cell in frame["links"]]
    for linkage in (
        sb.from_pins(frame),
        sb.from_pins(without, drive="crank", ground="frame"),
        sb.from_table(without.assign(links=links), drive="crank"),
        sb.from_axes(frame.assign(kind="pin")),
    ):
        assert np.array_equal(linkage.frames, plain.frames)
        assert linkage.drive.joint == "crank"
    # in its own unit, of a pin of three links the first hinge drives
    three = pd.DataFrame({"x [cm]": [1, 2, 3], "y [cm]": [0, 1, 0], "links": ["a b c", "b c", "b c"]})
    with pytest.raises(DescriptionError, match=r"data row 3, column 'links': b and c are joined twice"):
        sb.from_pins(three, ground="a")
    four = pd.DataFrame(
        {"x": [0, 1, 2], "y": [0, 1, 0], "links": ["a b c", "b d", "c d"], "input": ["x", "", ""]}
    )
    assert sb.from_pins(four, ground="a").drive.joint == "pin_1.1"


def test_a_table_of_joints_has_its_links_rods_and_points_by_name(tmp_path):
    path = tmp_path / "hub.csv"
    path.write_text(HUB.replace("chassis", "frame"))
    linkage = sb.load(path)
    assert note_of(path) == (
        "read as 4 joints between links by name, 1 rod, lengths in mm; frame stands still"
    )
    assert [rod.name for rod in linkage.rods] == ["track rod"]
    assert linkage.rods[0].at == ((120, 60, 80), (110, 340, 90))
    assert linkage.points == (sb.Point("wheel", linkage.link_names.index("upright") + 1, (0, 400, 90)),)
    assert linkage.mobility().finite == 1
    # two columns for the two links
    cells = [line.replace("; ", ",") if ";" in line else line for line in HUB.splitlines()]
    cells[0] = cells[0].replace("between", "between a,between b")
    cells[-1] = cells[-1].replace(",,upright", ",,,upright")
    path.write_text("\n".join(cells))
    assert np.array_equal(sb.from_table(path, ground="chassis").frames, linkage.frames)


def test_a_table_that_names_links_of_one_loop_is_that_loop():
    pins = pd.DataFrame({"x": [0, 10, 100, 90], "y": [0, 40, 70, 0], "links": ["f c", "c k", "k r", "r f"]})
    linkage = sb.from_pins(pins, ground="f")
    assert (linkage.net, linkage.motion(12).motion_type) == (None, "crank-rocker")


@pytest.mark.parametrize(
    ("content", "messages"),
    [
        ("x,y,links\n0,0,f\n1,1,a b\n", ["line 2, column 'links': 'f' names 1 link; give two or more, as in 'frame; crank'"]),
        ("x,y,links\n0,0,\n1,1,ground b\n", ["line 2, column 'links': names no link; give two or more, as in 'frame; crank'"]),
        ("x,y,links\n0,0,f a\n1,1,a b\n0,1,b f\n",
         ["no link is called ground, fixed, frame or base; name the link that stands still in a column 'ground', one of f, a, b"]),
        ("x,y,links\n0,0,base a\n1,1,a frame\n0,1,base frame\n",
         ["base and frame are links; name the link that stands still in a column 'ground', one of base, a, frame"]),
        ("x,y,links,ground\n0,0,f a,f\n1,1,a b,b\n0,1,b f,\n", ["line 3, column 'ground': is a second ground; give one"]),
        ("x,y,links,ground\n0,0,fr a,f\n1,1,a b,\n0,1,b fr,\n",
         ["line 2, column 'ground': no joint is at a link 'f'; did you mean 'fr'? name the link that stands still, one of fr, a, b"]),
        ("x,y,links\n0,0,frame a\n1,1,a b\n0,1,b wall\n",
         ["line 2, column 'links': 'frame' is named only here; a link needs two joints, or a joint and a rod",
          "line 4, column 'links': 'wall' is named only here; a link needs two joints, or a joint and a rod"]),
        ("name,x,y,links\np,0,0,frame a\np,1,1,a b\n,0,1,b frame\n",
         ["line 3, column 'name': 'p' is taken already, by line 2; give each joint and rod its own name"]),
        ("x,y,links\n0,0,frame a\n1,1,aa b\n0,1,b frame\n",
         ["line 2, column 'links': 'a' is named only here; a link needs two joints, or a joint and a rod",
          "line 3, column 'links': 'aa' is named only here; a link needs two joints, or a joint and a rod"]),
        ("x,y,links\n0,zero,frame a\n1,1,a b\n0,1,b frame\n",
         ["line 2, column 'y': 'zero': no 'zero' is known; give a length, as in 250, '25 cm' or '50*sin(30deg)'"]),
        ("kind,x,y,axis z,between\nR,0,0,1,frame a b\nR,1,1,1,a b\nR,1,0,1,b frame\n",
         ["line 2, column 'between': 'frame a b' names 3 links; give two, as in 'frame; crank'"]),
        ("kind,x,y,axis z,between\nR,0,0,1,frame a\nR,1,1,1,a b\nrod,1,0,,b frame\n",
         ["line 4: is a rod without its other end; give it in columns x 2, y 2, z 2"]),
    ],
)  # fmt: skip
def test_each_mistake_of_a_table_of_links_has_its_line_and_column(tmp_path, content, messages):
    path = tmp_path / "t.csv"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(DescriptionError) as refused:
        sb.load(path)
    assert [line.removeprefix(f"{path}: ") for line in str(refused.value).splitlines()] == messages


@pytest.mark.parametrize("name", gallery.nets())
def test_nets_go_to_tables_and_back(tmp_path, name):
    linkage = sb.load(name)
    head, rows = linkage_table(linkage)
    path = tmp_path / "t.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([[linkage.name], head, *rows])
    book = saved(tmp_path / "t.xlsx", [[linkage.name], head, *rows], "linkage")
    added = openpyxl.load_workbook(book)
    sheet = added.create_sheet("points")
    for row in [points_table(linkage)[0], *points_table(linkage)[1]]:
        sheet.append(row)
    added.save(book)
    for back in (sb.load(path), sb.load(book), sb.loads(toml_text(path))):
        assert np.array_equal(back.frames, linkage.frames)
        assert (back.drive, back.name, back.columns) == (linkage.drive, linkage.name, linkage.columns)
        assert (back.rods, back.link_names) == (linkage.rods, linkage.link_names)
    assert sb.load(book).points == linkage.points


def test_a_hinge_of_a_pin_with_several_may_drive_from_a_table(tmp_path):
    pins = "name,x,y,links,input,output\nhub,0,0,frame; one; two,hub.2,\n,10,20,one; c,,\n,40,0,c; d,,\n,60,-9,d; two,,\nend,70,5,frame; d,,x\n"
    path = tmp_path / "t.csv"
    path.write_text(pins)
    drive = sb.load(path).drive
    assert (drive.joint, drive.output) == ("hub.2", "end")
