"""The command that reports forces: what it prints, its tables and JSON, figures, and what it refuses."""

from __future__ import annotations

import csv
import json
import math
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from lettered import collisions
from sevenbar.drawing import force_figures

PRESS = """
format = 1
length_unit = "mm"
[drive]
speed = "60 rpm"
[rssr]
M = 700
N = 700
L1 = 250
L3 = 550
D = 0
"""
ROD = '[[body]]\nlink = 2\nmass = 1.3\nsolid = "rod"\n'


def press(tmp_path: Path, *tables: str) -> str:
    path = tmp_path / "press.toml"
    path.write_text(PRESS + "".join(tables), encoding="utf-8")
    return "press.toml"


def told(*arguments: object, cwd: Path | None = None) -> str:
    run = sevenbar("forces", *arguments, cwd=cwd)
    assert run.returncode == 0, run.stderr
    return " ".join(run.stdout.split())


def test_the_report_has_what_acts_and_what_a_drive_and_its_bearings_need() -> None:
    page = told("rssr_press", "--unevenness", "0.02")
    found = sb.load("rssr_press").motion().circuits[0].forces().sizing(unevenness=0.02)
    peak = found.peak_torque
    assert f"input torque peak {peak.value:.4g} N m @ {np.degrees(peak.input):.3f}°" in page
    assert f"rms {found.rms_torque:.4g} N m, mean {found.mean_torque:.4g} N m" in page
    assert f"{found.flywheel:.4g} kg m^2 at the input for an unevenness of 0.02" in page
    assert "link 1 4 kg, a uniform rod between its joints" in page
    assert "load 1 work: force (0, 0, 2000) N at (0, 0, 0) on link 3, from 320.000° to 15.000°" in page
    assert "gravity (0, 0, -9.80665) m/s^2" in page
    assert "braking -385.7 W" in page
    assert "shaking force peak" in page
    assert "power closes along the cycle" in page
    crank = found.bearings["crank"]
    assert f"crank {crank.force.peak.value:.0f}" in page
    assert f"{crank.tilting.peak.value:.4g} {crank.turning.peak.value:.4g}" in page


def test_what_rigid_bodies_leave_open_is_named_by_the_redundant_constraints() -> None:
    page = told("engine")
    for constraint in sb.load("engine").mobility().redundant:
        assert constraint in page
    assert "Mx, My, Fz of crank, crank_pin, wrist_pin; Mx, Mz, Fy of piston" in page
    # the side force of the piston is known
    side = np.abs(sb.load("engine").motion().circuits[0].forces().reactions["piston"].force[:, 0]).max()
    assert f"Fx of piston, up to {side:.4g} N" in page
    assert "the linkage drives its input" in page
    assert "nothing" not in page


def test_an_idle_spin_is_a_rod_or_has_the_moment_of_its_rule(tmp_path: Path) -> None:
    assert "coupler: not held" in told(press(tmp_path, ROD), cwd=tmp_path)
    aside = "[[body]]\nlink = 2\nmass = 1.3\ncentre = [300, 40, 0]\ninertia = [9e3, 9e3, 9e3, 0, 0, 0]\n"
    page = told(press(tmp_path, aside), cwd=tmp_path)
    moment = sb.load(str(tmp_path / "press.toml")).motion().circuits[0].forces().spin
    assert f"gives up to {np.abs(next(iter(moment.values()))).max():.4g} N m that no ball gives" in page


def test_speed_0_is_statics_on_every_row(tmp_path: Path) -> None:
    gravity = "[forces]\ngravity = [0, 0, -9.80665]\n"
    name = press(tmp_path, gravity, ROD, '[[spring]]\njoint = "rocker"\nstiffness = 3\ndamping = 2\n')
    found = json.loads(sevenbar("forces", name, "--speed", "0 rpm", "--json", cwd=tmp_path).stdout)
    assert found["drive"] == {"input": "crank", "speed": None, "law": False, "at_rest": True}
    assert found["checks"]["power"] < 1e-11
    assert found["shaking"] is None
    page = told(name, "--speed", "0", cwd=tmp_path)
    assert "at rest at each crank: no inertia, no damping" in page
    assert "power peak" not in page
    # slow enough, the motion needs the same
    circuit = sb.load(str(tmp_path / name)).motion(speed=1e-9).circuits[0]
    still = circuit.forces(at_rest=True)
    assert np.allclose(still.torque, circuit.forces().torque, rtol=0, atol=1e-8)
    assert found["sizing"]["peak_torque"]["value"] == pytest.approx(still.sizing().peak_torque.value)
    assert "not a unit" in mistake("forces", name, "--speed", "0 rmp", cwd=tmp_path)


def test_a_circuit_that_rocks_has_no_peak_at_constant_speed_and_one_under_a_law(tmp_path: Path) -> None:
    page = told("rssr_press", "--input", "rocker")
    assert "no peak: the torque grows without bound at the dead centres of rocker" in page
    assert "2 dead-centre" in page
    low, high = np.degrees(sb.load("rssr_press").motion(8, input="rocker").circuits[0].input_range)
    angles = (low + high) / 2 + 0.3 * (high - low) * np.sin(np.linspace(0, 2 * np.pi, 101))
    rows = "\n".join(f"{t:.6g},{a:.9g}" for t, a in zip(np.linspace(0, 1, 101), angles, strict=True))
    (tmp_path / "law.csv").write_text(f"time [s],rocker [deg]\n{rows}\n", encoding="utf-8")
    for branch in (0, 1):
        page = told(
            "rssr_press", "--input", "rocker", "--law", "law.csv", "--branch", str(branch), cwd=tmp_path
        )
        assert f"circuit 0 of 2, pass {branch}, rocker by a law" in page
        assert "its accelerations are as good as its table" in page
        assert "input torque peak" in page


def test_the_table_has_units_and_no_value_for_what_is_not_determined(tmp_path: Path) -> None:
    told("engine", "--samples", "36", "--out", "forces", cwd=tmp_path)
    with (tmp_path / "forces" / "forces.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 36
    units = re.compile(r"_(s|deg|Nm|N|W|J)$")
    assert [head for head in rows[0] if not units.search(head)] == ["branch", "status"]
    forces = sb.load("engine").motion(36).circuits[0].forces()
    for k in (0, 7, 35):
        assert float(rows[k]["torque_Nm"]) == forces.torque[k]
        assert float(rows[k]["crank_pin_Fx_N"]) == forces.reactions["crank_pin"].force[k, 0]
        assert float(rows[k]["shaking_Mz_Nm"]) == forces.shaking[k, 2]
        assert rows[k]["piston_Fy_N"] == rows[k]["crank_Mx_Nm"] == ""
    found = json.loads((tmp_path / "forces" / "forces.json").read_text(encoding="utf-8"))
    assert found["joints"]["piston"]["determinate"] == {
        "Mx": False, "My": True, "Mz": False, "Fx": True, "Fy": False, "Fz": True
    }  # fmt: skip
    assert found["joints"]["crank"]["axial"] == {"value": None, "at": None, "mean_cube": None}
    assert found["units"]["torque"] == "N m"
    assert len(found["not_determined"]) == 3
    written = {path.name for path in (tmp_path / "forces").iterdir()}
    figures = {f"{name}.png" for name in ("torque", "reactions", "bearings", "shaking", "energies")}
    assert written == {"forces.csv", "forces.json", *figures}
    assert "--force" in mistake("forces", "engine", "--out", "forces", cwd=tmp_path)


def test_analyze_has_the_peaks_and_names_the_command() -> None:
    run = sevenbar("analyze", "rssr_press")
    assert "4 bodies, 1 load, gravity; 'sevenbar forces' reports all joints" in run.stdout
    found = sb.load("rssr_press").motion().circuits[0].forces().sizing()
    assert f"{found.peak_torque.value:.4g} @ {np.degrees(found.peak_torque.input):.3f}°" in run.stdout
    assert f"{found.bearings['ball_b'].force.peak.value:.0f} in ball_b" in run.stdout
    one = json.loads(sevenbar("analyze", "rssr_press", "--json").stdout)["circuits"][0]["forces"]
    assert one["peak_torque"]["value"] == found.peak_torque.value
    assert set(one["peak_forces"]) == {"crank", "ball_a", "ball_b", "rocker"}
    bare = sevenbar("analyze", "rssr").stdout
    assert "torque" not in bare
    assert json.loads(sevenbar("analyze", "rssr", "--json").stdout)["circuits"][0]["forces"] is None
    assert "no bound at limits" in sevenbar("analyze", "rssr_press", "--input", "rocker").stdout


def test_a_file_without_masses_gets_an_example(tmp_path: Path) -> None:
    message = mistake("forces", "rssr")
    assert message.startswith("rssr: nothing in it has a mass and nothing acts; write a body")
    example = message.partition("as in\n")[2].replace("sevenbar:", "")
    assert "[[body]]" in example
    # the example is what a file takes
    body = "\n".join(line.strip() for line in example.splitlines())
    assert "1.3 kg, a uniform rod" in told(press(tmp_path, body), cwd=tmp_path)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--circuit", "5"), "circuit: 5 is not a circuit of this motion; give 0 to 1"),
        (("--branch", "1"), "--branch: 1 is not a pass of circuit 0; give 0"),
        (("--joint", "cranck", "--out", "forces"), "--joint: no joint 'cranck'"),
        (("--unevenness", "0"), "unevenness: 0.0 is not an unevenness; give a part of the mean speed > 0"),
        (
            ("--unevenness", "3"),
            "unevenness: 3.0 is not an unevenness; give a part of the mean speed > 0 and up to 2",
        ),
        (("--counterweights", "1,1"), "--counterweights: '1' is given twice; leave one out"),
        (("--unevenness", "0.1", "--speed", "0"), "--unevenness: at rest nothing fluctuates"),
        (("--unevenness", "1%"), "--unevenness: '1%' is not a number; give one, as in 0.01"),
        (("--agree", "little"), "--agree: 'little' is not a number; give one, as in 1e-5"),
        (("--joint", "crank"), "--joint: no figure is drawn; give --out"),
        (("--style", "ieee"), "--style: no figure is drawn; give --out"),
        (("--size", "80x50mm"), "--size: no figure is drawn; give --out"),
        (("--figures", "png"), "--figures: a folder for them is missing"),
        (("--speed", "fast"), "speed: 'fast'"),
    ],
)
def test_wrong_options_are_refused(arguments: tuple[str, ...], message: str) -> None:
    assert message in mistake("forces", "rssr_press", *arguments)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('[[body]]\nlink = 4\nmass = 1\nsolid = "rod"\n', "is the ground"),
        ('[[body]]\nlink = 9\nmass = 1\nsolid = "rod"\n', "9 is not a link"),
        ('[[spring]]\njoint = "rockre"\nstiffness = 1\n', "rockre"),
    ],
)
def test_wrong_tables_are_refused_with_their_file(tmp_path: Path, table: str, message: str) -> None:
    said = mistake("forces", press(tmp_path, table), cwd=tmp_path)
    assert said.startswith("press.toml: ")
    assert message in said


def loaded(name: str) -> sb.Linkage:
    linkage = sb.load(name)
    if not linkage.loading.is_empty:
        return linkage
    rods = {link: sb.Body(1.0, solid="rod") for link in range(1, len(linkage.joints) - 1)}
    return linkage.loaded(bodies=rods, gravity=(0.0, -9.8, -1.0))


FIGURES: dict[str, dict[str, Any]] = {
    "rssr_press": {},
    "engine": {},
    "seven_r_bodies": {},
    "planar_4r": {},
    "rssp": {},
    "rssr_press rocking": {"input": "rocker", "output": "crank"},
    "rssp sliding": {"input": "slider", "output": "crank"},
}


@cache
def forces_of(name: str) -> sb.Forces:
    return loaded(name.split()[0]).motion(72, **FIGURES[name]).circuits[0].forces()


@pytest.mark.usefixtures("fonts_of_matplotlib")
@pytest.mark.parametrize("kind", force_figures.KINDS)
@pytest.mark.parametrize(
    ("name", "style"),
    [*((name, "screen") for name in FIGURES),
     # where most is written
     *((name, "paper") for name in ("rssr_press", "engine", "seven_r_bodies"))],
)  # fmt: skip
def test_no_text_of_a_figure_of_forces_lies_on_another(
    name: str, kind: str, style: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert collisions(forces_of(name).plot(kind=kind, style=style), monkeypatch) == []


def test_figures_show_peaks_and_leave_out_what_is_not_determined() -> None:
    forces = sb.load("engine").motion(72).circuits[0].forces()
    found = forces.sizing()
    torque = sb.plot.torque(forces)
    texts = [text.get_text() for axes in torque.axes for text in axes.texts]
    assert f"{found.peak_torque.value:.4g} N m".replace("-", "\u2212") in texts
    marks = [line.get_xydata()[0] for line in torque.axes[0].lines if line.get_marker() == "o"]
    assert np.allclose(marks, [(np.degrees(found.peak_torque.input), found.peak_torque.value)])
    drawn = sb.plot.reactions(forces, joints=["piston"]).axes[0]
    curves = [line.get_ydata() for line in drawn.lines if len(line.get_ydata()) == 73]
    assert len(curves) == 2
    # a piston's side force alone is no polar picture, a pin's is one
    assert [axes.get_title() for axes in sb.plot.bearings(forces).axes] == ["crank", "crank_pin", "wrist_pin"]
    assert len(sb.plot.shaking(forces).axes) == 2
    with pytest.raises(sb.errors.RequestError, match="their forces are not determined"):
        sb.plot.bearings(forces, joints=["piston"])
    with pytest.raises(sb.errors.RequestError, match="no joint 'pistn'"):
        sb.plot.reactions(forces, joints=["pistn"])
    with pytest.raises(sb.errors.RequestError, match="at rest nothing shakes"):
        sb.load("engine").motion(8).circuits[0].forces(at_rest=True).plot(kind="shaking")
    with pytest.raises(sb.errors.RequestError, match="kind: 'torqe' is not a figure of forces; did you mean"):
        forces.plot(kind="torqe")


def test_forces_print_what_a_person_asks_first() -> None:
    forces = sb.load("rssr_press").motion(72).circuits[0].forces()
    lines = repr(forces).splitlines()
    assert lines[0] == "Forces of 'RSSR press', driven by crank: 72 ok"
    assert any(line.startswith("  input torque") and "N m @ " in line for line in lines)
    assert any(line.startswith("  rocker ") and "force up to" in line for line in lines)
    assert all(len(line) <= 100 for line in lines)
    assert "<img" in forces._repr_html_()
    assert "array" not in repr(forces)
    crank = repr(forces.reactions["crank"])
    assert crank.startswith("Reaction in crank: 72 rows")
    assert "Fx" in crank
    assert "flywheel" in repr(forces.sizing(unevenness=0.1))
    assert "cubic mean" in repr(forces.sizing().bearings["crank"])
    open_one = sb.load("engine").motion(72).circuits[0].forces().reactions["piston"]
    assert "Fy  not determined" in repr(open_one)
    assert "Mx  not determined" in repr(open_one)


def test_counterweights_are_those_of_the_circuit() -> None:
    run = sevenbar("forces", "rssr_press", "--counterweights", "1,3", "--radius", "100", "--json")
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout)["counterweights"]
    balance = sb.load("rssr_press").motion().circuits[0].counterweights([1, 3], radius=100)
    assert [one["mass"] for one in found["weights"]] == pytest.approx([12.5, 66.0], rel=1e-9)
    assert [one["product"] for one in found["weights"]] == [one.product for one in balance.counterweights]
    assert found["after"] < 1e-10 * found["before"]
    assert "link 3 6600 kg mm" in told("rssr_press", "--counterweights", "1", "--counterweights", "3")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--counterweights", "crank"], "'crank' is not a link; give their numbers, as in 1,3"),
        (["--radius", "100"], "it is that of counterweights; give --counterweights, as in 1,3"),
        (["--counterweights", "1", "--speed", "0"], "they are found for a constant speed"),
    ],
)
def test_counterweights_that_cannot_be_found_are_refused(arguments: list[str], message: str) -> None:
    assert message in mistake("forces", "rssr_press", *arguments)


def test_the_force_in_the_plane_is_in_the_table_the_json_and_the_csv(tmp_path: Path) -> None:
    page = told("engine", "--out", str(tmp_path / "out"), cwd=tmp_path)
    sizing = sb.load("engine").motion().circuits[0].forces().sizing()
    piston = sizing.bearings["piston"].in_plane
    assert f"piston {piston.peak.value:.4g}" in page
    assert "in plane: the force in the plane of motion; -: not determined" in page
    joints = json.loads((tmp_path / "out" / "forces.json").read_text())["joints"]
    assert joints["piston"]["in_plane"]["mean_cube"] == pytest.approx(piston.mean_cube, rel=1e-12)
    with (tmp_path / "out" / "forces.csv").open(newline="", encoding="utf-8-sig") as file:
        rows = list(csv.DictReader(file))
    sizes = [float(row["piston_F_in_plane_N"]) for row in rows]
    assert max(sizes) == pytest.approx(piston.peak.value, rel=1e-3)


PARALLELOGRAM = """format = 1
layout = "planar"
length_unit = "m"

[forces]
gravity = [0, -9.81, 0]

[[link]]
length = 1

[[link]]
length = 2

[[link]]
length = 1

[[link]]
length = 2

[[body]]
link = 2
mass = 3
solid = "rod"
"""


def test_a_parallelogram_is_sized_through_its_change_points(tmp_path: Path) -> None:
    file = tmp_path / "parallelogram.toml"
    file.write_text(PARALLELOGRAM)
    # the coupler rises and falls by a metre to each side; the rows at change points have no rates
    page = told(file, "--circuit", 1, "--speed", "60rpm", "--unevenness", 0.02)
    assert "nan" not in page
    assert "peak 184.9 W @ 0.000°, braking -184.9 W @ 180.000° mean 0 W" in page
    assert "flywheel 74.55 kg m^2" in page


def test_counterweights_say_that_change_points_are_in_their_way(tmp_path: Path) -> None:
    file = tmp_path / "parallelogram.toml"
    file.write_text(PARALLELOGRAM)
    message = mistake("forces", file, "--circuit", 0, "--counterweights", "1,3", "--radius", 1)
    assert "the rows at change points, where branches meet, have no shaking of their own" in message
    assert "dead centre" not in message


def test_mean_power_at_constant_speed_is_that_of_the_mean_torque() -> None:
    # a load that sets in between rows is not seen by their mean
    found = sb.load("rssr_press").motion().circuits[0].forces().sizing()
    assert found is not None
    assert f"mean {math.tau * found.mean_torque:.4g} W" in told("rssr_press")


def test_a_start_without_a_unit_is_in_degrees(tmp_path: Path) -> None:
    file = tmp_path / "parallelogram.toml"
    file.write_text(PARALLELOGRAM)
    free = ("free", str(file), "--circuit", "1", "--time", "1s", "--json", "--from")
    plain, degrees = (sevenbar(*free, start) for start in ("30", "30deg"))
    assert plain.returncode == 0, plain.stderr
    assert plain.stdout == degrees.stdout
    assert "--from: 'wide' is no value of theta_1, which turns; give" in mistake(*free, "wide")


def test_a_sizing_prints_units_and_places_as_the_report_does() -> None:
    circuit = sb.load("rssr_press").motion(samples=90).circuits[0]
    forces = circuit.forces()
    found = forces.sizing()
    assert found is not None
    text = str(found)
    assert re.search(r"peak torque +-?[\d.]+ N m @ [\d.]+°", text)
    assert re.search(r"rms, mean +[\d.]+ N m, -?[\d.]+ N m", text)
    assert re.search(r"peak power +[\d.]+ W @ [\d.]+°", text)
    assert re.search(r"radial +peak [\d.]+ N @ [\d.]+°", str(found.bearings["crank"]))


def test_a_cone_takes_a_text_with_its_unit_wherever_it_is_given() -> None:
    assert sb.Cone("45 deg") == sb.Cone(math.pi / 4)
    rssr = sb.load("rssr")
    assert (
        rssr.stopped(cones={"ball_a": sb.Cone("45 deg")}).stops
        == rssr.stopped(cones={"ball_a": "45 deg"}).stops
    )
    with pytest.raises(sb.errors.RequestError, match="cone: '45' is not a number with a unit that fits"):
        sb.Cone("45")
