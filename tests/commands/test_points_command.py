"""`sevenbar design point` and `sevenbar design inertia`: what they print, write, and say of mistakes."""

import contextlib
import csv
import io
import json
import re

import numpy as np
import pytest
import typer

import sevenbar as sb
from places import ROOT
from sevenbar.commands.points import inertia, point
from sevenbar.errors import SevenbarError

PAGE = (ROOT / "docs" / "points.md").read_text(encoding="utf-8")

app = typer.Typer()
app.command()(point)
app.command()(inertia)

CUBE = "--box=-200:200,-200:200,-200:200"


@pytest.fixture(autouse=True)
def width(monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")


def run(*words):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        assert not app([str(word) for word in words], standalone_mode=False)
    return out.getvalue()


def rows(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_page_prints_what_its_commands_print_today(tmp_path):
    # what rounding leaves, nothing or a little, so lines may end elsewhere; and how many steps it takes a solver
    small = re.compile(r"\d\.?\d*e-1\d|\b0(?= (?:mm/s\^2|of the value))|in \d+ steps")
    shown = " ".join(small.sub("~", PAGE).split())
    commands = re.findall(r"^    \$ sevenbar design (.*)$", PAGE, flags=re.MULTILINE)
    assert len(commands) == 2
    for index, command in enumerate(commands):
        printed = run(*command.replace("DIR", str(tmp_path / str(index))).split())
        for line in printed.partition("\nwritten:")[0].splitlines():
            told = " ".join(small.sub("~", line).split())
            assert not told.strip("─") or f" {told} " in shown, line


def test_the_new_file_has_the_point_and_keeps_its_comments(tmp_path):
    out = tmp_path / "out"
    run("point", ROOT / "examples" / "seven_r.toml", "--link", 4, CUBE, "--out", out, "--figures", "svg")
    assert {path.name for path in out.iterdir()} == {
        *("point.toml", "point.json", "rates.csv", "poles.csv", "point.svg")
    }
    told = json.loads((out / "point.json").read_text(encoding="utf-8"))
    assert told["relative_gap"] < 1e-9
    assert told["whole_cycle"]
    linkage = sb.load(str(out / "point.toml"))
    (named,) = [p for p in linkage.points if p.name == "least_acceleration"]
    trace = linkage.motion(720).circuits[0].point(named.link, named.at)
    greatest = np.linalg.norm(trace.acceleration, axis=1).max()
    assert greatest == pytest.approx(told["value"], rel=1e-4)
    text = (out / "point.toml").read_text(encoding="utf-8")
    assert "# u along joint 4, v along link 4" in text
    written = rows(out / "rates.csv")
    column = [float(row["least_acceleration_acceleration_mm_s2"]) for row in written]
    assert column == pytest.approx(np.linalg.norm(trace.acceleration, axis=1))
    poles = rows(out / "poles.csv")
    at = tuple(float(poles[8][name]) for name in ("u_mm", "v_mm", "w_mm"))
    assert np.linalg.norm(linkage.motion(720).circuits[0].point(4, at).acceleration[8]) < 1e-8


def test_json_is_what_the_folder_has(tmp_path):
    arguments = ("point", "rssr", "--link", 2, "--box=-50:50,-50:50,0", "--least", "velocity")
    out = tmp_path / "out"
    printed = json.loads(run(*arguments, "--json", "--out", out))
    assert printed == json.loads((out / "point.json").read_text(encoding="utf-8"))
    assert printed["of"] == "velocity"
    assert printed["at"][2] == 0
    assert "spin of the coupler (link 2)" in printed["notes"][0]


@pytest.mark.parametrize("timed", [False, True])
def test_a_curve_in_other_units_is_met_by_the_point_it_came_from(tmp_path, timed):
    circuit = sb.load("seven_r").motion(33).circuits[0]
    places = circuit.point(4, (-100.0, -90.0, -80.0)).position / 10
    head = "x [cm],y [cm],z [cm]" + ",theta_1 [deg]" * timed
    table = np.column_stack([places, np.degrees(circuit.input)][: 1 + timed])
    path = tmp_path / "curve.csv"
    np.savetxt(path, table, delimiter=",", header=head, comments="")
    out = tmp_path / "out"
    printed = run("point", "seven_r", "--link", 4, CUBE, "--curve", path, "--out", out, "--name", "Q")
    assert "point (-100, -90, -80) mm" in re.sub(" +", " ", printed)
    assert ("each at its input" if timed else "local: the best of 27 starts") in printed
    (named,) = [p for p in sb.load(str(out / "point.toml")).points if p.name == "Q"]
    assert named.at == pytest.approx((-100, -90, -80), abs=1e-5)
    assert max(float(row["distance_mm"]) for row in rows(out / "path.csv")) < 1e-6


def test_the_table_of_masses_has_torque_and_forces_of_the_library(tmp_path):
    out = tmp_path / "out"
    run("inertia", "seven_r", "--mass", "P=2.5kg", "--gravity", "0,0,-9.80665", "--out", out)
    assert {path.name for path in out.iterdir()} == {"inertia.json", "inertia.csv", "inertia.png"}
    written = rows(out / "inertia.csv")
    assert len(written) == 360
    trace = sb.load("seven_r").motion().circuits[0].point(4, (-100.0, -90.0, -80.0))
    forces = [[float(row[f"P_f{letter}_N"]) for letter in "xyz"] for row in written]
    assert np.array(forces) == pytest.approx(-2.5e-3 * trace.acceleration)
    pull = trace.acceleration / 1000 - np.array([0, 0, -9.80665])
    torque = 2.5 * (pull * trace.velocity / 1000).sum(axis=1)
    assert [float(row["torque_Nm"]) for row in written] == pytest.approx(torque)


def test_a_law_lets_a_mass_on_a_rocking_circuit_be_asked_for(tmp_path):
    t = np.linspace(0, 6.28, 60)
    law = tmp_path / "law.csv"
    table = np.column_stack([t, 75 - 60 * np.cos(t)])
    np.savetxt(law, table, delimiter=",", header="time [s],crank [deg]", comments="")
    motion = sb.load("rscr").motion()
    rocking = next(c for c in motion if c.input_range is not None)
    words = ("point", "rscr", "--link", 2, "--box=-9:9,-9:9,-9:9", "--circuit", rocking.index, "--law", law)
    told = json.loads(run(*words, "--branch", 1, "--json"))
    assert (told["branch"], told["whole_cycle"], told["drive"]["speed"]) == (1, False, None)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("point", "seven_r", "--link", 4, "--box=wide"),
            "--box: 'wide' is no box; give three sides low:high, as in '-200:200,-200:200,0:50'",
        ),
        (
            ("point", "seven_r", "--link", 4, "--box=0:1,0:1,2:1"),
            "--box: empty along w: lowest 2 above highest 1; give the lower first",
        ),
        (
            ("point", "seven_r", "--link", 4, "--box=0:nan,0:1,0:1"),
            "--box: '0:nan,0:1,0:1' is no box; give three sides low:high, as in '-200:200,-200:200,0:50'",
        ),
        (
            ("point", "seven_r", "--link", 4, CUBE, "--least", "snap"),
            "--least: 'snap' is not offered; give acceleration, velocity, jerk or rms",
        ),
        (
            ("point", "seven_r", "--link", 4, CUBE, "--least", "rms", "--curve", "c.csv"),
            "--least: a path near a curve is looked for with --curve; leave one of them out",
        ),
        (("point", "seven_r", "--link", 7, CUBE), "link: 7 is the ground, which stands still; give 1 to 6"),
        (
            ("point", "seven_r", "--link", 4, CUBE, "--law", "l.csv", "--speed", "1 rad/s"),
            "--speed: a law gives the speed; leave --speed or --law out",
        ),
        (
            ("inertia", "seven_r", "--mass", "P"),
            "--mass: 'P' is not a mass; give a point and kilograms, as in P=2.5",
        ),
        (("inertia", "seven_r", "--mass", "P=-2"), "mass of P: -2.0 is not a mass; give kilograms > 0"),
        (
            ("inertia", "seven_r", "--mass", "p=2"),
            "masses: no point 'p'; did you mean 'P'? this linkage has P",
        ),
        (
            ("inertia", "seven_r", "--mass", "P=1", "--mass", "P=2"),
            "--mass: 'P' is given twice; leave one out",
        ),
        (
            ("inertia", "seven_r", "--mass", "P=1", "--gravity", "9.81"),
            "--gravity: '9.81' is not an acceleration; give three numbers, as in '0,0,-9.80665'",
        ),
    ],
)
def test_what_is_said_of_a_mistake(words, message):
    with pytest.raises(SevenbarError) as caught:
        run(*words)
    assert str(caught.value) == message


def test_what_is_said_of_a_name_that_is_taken(tmp_path):
    with pytest.raises(SevenbarError, match="--name: seven_r has a point 'P' already; give another name"):
        run("point", "seven_r", "--link", 4, CUBE, "--name", "P", "--out", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_path_from_the_tables_of_sevenbar_leads_back_to_its_point(tmp_path):
    """With the input's column and the other columns that such a table has."""
    linkage = sb.load("seven_r")
    (name,) = [each.name for each in linkage.points]
    columns = linkage.motion(24).columns()
    first = columns["circuit"] == 0
    table = tmp_path / "motion.csv"
    with table.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(values[first].tolist() for values in columns.values()), strict=True))
    found = json.loads(run("point", "seven_r", "--link", 4, CUBE, "--curve", table, "--json"))
    assert found["at"] == pytest.approx(list(linkage.points[0].at), abs=1e-9), name


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x [mm],z [mm]\n1,2\n", "no column for y; the columns are 'x [mm]', 'z [mm]'; name them as in"),
        ("x,y,z\n1,2,3\n", "column 'x': has no unit; write it as in 'x [mm]'"),
        (
            "x [mm],y [deg],z [mm]\n1,2,3\n",
            "column 'y [deg]': 'deg' is not a unit of the y; give one like mm",
        ),
        ("x [mm],y [mm],z [mm]\n1,,3\n4,5,6\n", "line 2: no number in column 'y [mm]' ('')"),
        (
            "x [mm],y [mm],z [mm],theta_1 [mm]\n1,2,3,4\n",
            "'mm' is not a unit of the input; give one like deg",
        ),
    ],
)
def test_what_is_said_of_a_bad_curve(tmp_path, text, message):
    path = tmp_path / "curve.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SevenbarError, match=re.escape(message)):
        run("point", "seven_r", "--link", 4, CUBE, "--curve", path)


@pytest.mark.parametrize("more", [("--least", "velocity"), ("--curve",)])
def test_a_point_on_a_link_that_spins_idly_is_refused(tmp_path, more):
    if more == ("--curve",):
        table = tmp_path / "curve.csv"
        table.write_text("x [mm],y [mm],z [mm]\n1,2,3\n4,5,6\n7,8,8\n", encoding="utf-8")
        more = ("--curve", table)
    with pytest.raises(
        SevenbarError, match=r"^point: the spin of .*link 2.* about the line of .* is not deter"
    ):
        run("point", "rssp", "--link", 2, CUBE, *more)
    # its neighbours have the balls
    assert run("point", "rssp", "--link", 1, CUBE, "--least", "rms")
