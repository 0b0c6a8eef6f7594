"""Redundant constraints that agree up to a closure error, in every command that opens a linkage, and in all made of it."""

import copy
import json
import pickle

import numpy as np
import pytest
import typer.main

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.commands.cli import app
from sevenbar.description.draft import Draft
from sevenbar.design.tolerance.linear import linear_estimate
from sevenbar.design.tolerance.samples import monte_carlo
from sevenbar.errors import RequestError
from sevenbar.kinematics.solvers.general import AGREE

#: A Bennett linkage whose rods are cut to 0.01 mm: rigid up to 1e-9, a double-crank up to 1e-5.
ROUNDED = """format = 1
name = "rounded"
angle_unit = "deg"
[[link]]
length = 50
twist = 30
[[link]]
length = 98.48
twist = 100
[[link]]
length = 50
twist = 30
[[link]]
length = 98.48
twist = 100
[[point]]
name = "P"
link = 2
at = [0, 10, 5]
"""

#: The measured rows of `compare` and `calibrate`: the four-bar's own.
COLUMNS = tuple(
    word
    for name in ("angle=theta_4_deg", "velocity=theta_4_rad_s", "acceleration=theta_4_rad_s2")
    for word in ("--column", name)
)

#: A call of each command that can do nothing with a rigid linkage; OUT is a folder, ROWS its own motion.csv.
CALLS = {
    "modes": ("--at", "30deg"),
    "axodes": ("--link", 2, "--samples", 12),
    "export": ("--to", "csv", "--samples", 12, "-o", "OUT/motion.csv"),
    "tolerance": ("--tolerance", "P.*=0.1", "--of", "P.x", "--count", 8, "--samples", 24),
    "compare": ("ROWS", *COLUMNS),
    "calibrate": ("ROWS", *COLUMNS, "--offset", "output"),
    "design point": ("--link", 2, "--box=0:10,0:10,0:10", "--least", "velocity"),
    "design inertia": ("--mass", "P=1", "--samples", 24),
    "simulate": ("--engine", "mujoco", "--steps", 360),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rounded")
    (folder / "b.toml").write_text(ROUNDED, encoding="utf-8")
    table = sb.load(folder / "b.toml", agree=1e-5).motion(24).to_frame()
    table.to_csv(folder / "rows.csv", index=False)
    return folder


def call(folder, command, *options):
    given = [str(word).replace("ROWS", "rows.csv").replace("OUT", str(folder)) for word in CALLS[command]]
    table, rest = (given[:1], given[1:]) if "rows.csv" in given else ([], given)
    return sevenbar(*command.split(), "b.toml", *table, *rest, *options, cwd=folder)


@pytest.mark.parametrize("command", [c for c in CALLS if c not in ("modes", "export", "axodes")])
def test_a_command_for_which_the_rounded_linkage_is_rigid_takes_it_as_moving(folder, command):
    rigid, moves = call(folder, command), call(folder, command, "--agree", "1e-5")
    assert (rigid.returncode, moves.returncode) == (2, 0), rigid.stderr + moves.stderr


def test_modes_and_rows_are_there_where_constraints_agree(folder):
    assert json.loads(call(folder, "modes", "--json").stdout)["modes"] == []
    modes = json.loads(call(folder, "modes", "--agree", "1e-5", "--json").stdout)
    assert (len(modes["modes"]), modes["agree"]) == (1, 1e-5)
    assert call(folder, "export", "--agree", "1e-5").returncode == 0
    assert json.loads(call(folder, "axodes", "--json", "--agree", "1e-5").stdout)["circuits"]
    assert json.loads(call(folder, "axodes", "--json").stdout)["circuits"] == []
    assert len((folder / "motion.csv").read_text(encoding="utf-8").splitlines()) > 12


def test_a_sweep_and_a_map_have_its_motion_type(folder):
    over = ("--over", "length_1=49.9999,50,50.0001", "--measure", "motion_type", "--json")
    for agree, moving in ((), None), (("--agree", "1e-5"), 3):
        found = json.loads(sevenbar("sweep", "b.toml", *over, *agree, cwd=folder).stdout)
        assert found["totals"]["words"]["motion_type"].get("double-crank") == moving
        assert found.get("agree") == (1e-5 if agree else None)
    grid = ("--over", "length_1=49.99:50.01", "--over", "length_3=49.99:50.01", "--grid", 5, "--json")
    found = json.loads(sevenbar("map", "b.toml", *grid, "--agree", "1e-4", cwd=folder).stdout)
    assert found["design"]["motion_type"] == "double-crank"


def test_the_studio_opens_it_moving():
    session = pytest.importorskip("sevenbar.studio.state.session").Session
    assert "rigid" in session(ROUNDED, "b.toml").problem
    shown = session(ROUNDED, "b.toml", agree=1e-5)
    assert shown.problem == ""
    shown.open(ROUNDED.replace("98.48", "98.481"), "c.toml")
    assert (shown.problem, shown.motion.agree) == ("", 1e-5)


def commands_with_a_linkage():
    """Each command whose argument is a linkage, with the options it has."""

    def within(command, words):
        context = typer.Context(command)
        if hasattr(command, "list_commands"):
            for name in command.list_commands(context):
                yield from within(command.get_command(context, name), (*words, name))
        elif any((one.name, one.param_type_name) == ("linkage", "argument") for one in command.params):
            yield " ".join(words), {option for parameter in command.params for option in parameter.opts}

    return dict(within(typer.main.get_command(app), ()))


def test_every_command_that_opens_a_linkage_has_the_option_but_path_generation():
    found = commands_with_a_linkage()
    assert len(found) > 12
    assert [name for name, options in found.items() if "--agree" not in options] == ["design path"]


@pytest.mark.parametrize("command", ["sweep", "map", "tolerance", "simulate", "studio", "analyze"])
def test_one_message_for_what_is_no_closure_error(command):
    assert mistake(command, "bennett", "--agree", 2).startswith("--agree: 2.0 is not a closure error; ")


def test_a_linkage_keeps_it_through_copies_drafts_and_changed_numbers():
    linkage = sb.loads(ROUNDED).agreeing(1e-5)
    assert linkage.motion(24).linkage is linkage
    for same in (
        copy.deepcopy(linkage),
        pickle.loads(pickle.dumps(linkage)),
        Draft.of_linkage(linkage).linkage,
    ):
        assert same.agree == 1e-5
        assert same.motion(24).motion_type == "double-crank"
    changed = Draft.of_linkage(linkage).with_values({"length_1": 50.0001}).linkage
    assert changed.motion(24).motion_type == "double-crank"
    assert sb.loads(ROUNDED).motion(24).motion_type == "rigid"


def test_the_usual_error_and_none_change_nothing():
    linkage = sb.load("bennett")
    assert linkage.agreeing(None) is linkage
    assert linkage.agreeing(AGREE) is linkage
    # one solver for each error, however often it is asked
    assert linkage.agreeing(1e-5) is linkage.agreeing(1e-5)
    assert linkage.agreeing(1e-5).agreeing(1e-9).motion(24).agree == 1e-9
    with pytest.raises(RequestError, match=r"^agree: 2 is not a closure error"):
        sb.load("bennett", agree=2)


def test_what_is_asked_of_a_motion_takes_its_error():
    motion = sb.loads(ROUNDED).motion(72, agree=1e-5)
    (circuit,) = motion.circuits
    exact = sb.load("bennett").motion(72).circuits[0]
    assert exact.advantage is not None
    advantage = circuit.advantage
    # input and output turn at rates whose ratio the law of the half tangents gives: K and 1 / K
    ratio = np.sin(np.radians(65)) / np.sin(np.radians(35))
    assert advantage.highest == pytest.approx(ratio, rel=1e-4)
    assert advantage.lowest == pytest.approx(1 / ratio, rel=1e-4)


def test_a_tolerance_that_moves_nothing_of_what_is_told_is_an_error_of_zero():
    draft = Draft.of_linkage(sb.load("rssr")).with_point("P", 2, (0.0, 10.0, 5.0))
    linear = linear_estimate(draft.linkage, {"P.*": 0.5})
    found = monte_carlo(linear.found, linear, 8)
    assert (found.ratio, found.bias) == (1.0, 0.0)
    assert found.greatest < 1e-14
