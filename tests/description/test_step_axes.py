"""Axes of a STEP model: the joints of our own models are found, and a linkage is made of their table."""

import csv
import json

import build123d
import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.errors import MissingExtraError, TableError
from sevenbar.export import export
from sevenbar.export.pose import take


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """STEP files of linkages of the gallery, in the first pose of circuit 0, with the motion they show."""
    folder = tmp_path_factory.mktemp("models")
    found = {}
    for name in ("rscr", "seven_r"):
        motion = sb.load(name).motion(24)
        export(motion, "step", folder / f"{name}.step")
        found[name] = (folder / f"{name}.step", take(motion))
    return found


def apart(axis, frame):
    """How far a joint's frame (4, 4) is from an axis: the angle of the directions, the distance of the lines."""
    direction, at = frame[:3, 2], frame[:3, 3]
    if axis.direction is None:
        return 0.0, np.linalg.norm(axis.at - at)
    away = at - axis.at
    return np.linalg.norm(np.cross(axis.direction, direction)), np.linalg.norm(
        away - (away @ axis.direction) * axis.direction
    )


@pytest.mark.parametrize("name", ["rscr", "seven_r"])
def test_the_axes_shared_by_parts_are_those_of_the_joints(models, name):
    path, pose = models[name]
    shared = [axis for axis in sb.axes_of_step(path) if len(axis.parts) > 1]
    joints = pose.linkage.joints
    assert len(shared) == len(joints)
    for joint, frame in zip(joints, pose.near, strict=True):
        wanted = "ball" if joint.row.is_ball else "cylinder"
        misses = [max(apart(axis, frame)) for axis in shared if axis.shape == wanted]
        assert min(misses) < 1e-9, joint.name


def test_a_linkage_is_made_of_the_table_and_moves_as_the_model_s(models, tmp_path):
    path, pose = models["rscr"]
    run = sevenbar("axes", path, "--out", "axes.csv", cwd=tmp_path)
    assert run.returncode == 0
    count = len(sb.axes_of_step(path))
    assert run.stdout.startswith(f"rscr.step: {count} axes and balls, 4 of them shared by several parts")
    assert run.stdout.rstrip().endswith("written: axes.csv")
    with (tmp_path / "axes.csv").open(newline="") as file:
        head, *rows = list(csv.reader(file))
    # what a person does: order and kind of the axes that are joints, here by the shafts' names
    joints = {
        "shaft_crank": ("1", "R"),
        "link_1 link_2": ("2", "S"),
        "shaft_cylinder": ("3", "C"),
        "shaft_rocker": ("4", "R"),
    }
    for row in rows:
        parts = row[head.index("parts")]
        for word, (order, kind) in joints.items():
            if (word in parts if "shaft" in word else word == parts) and len(parts.split()) > 1:
                row[head.index("order")], row[head.index("kind")] = order, kind
    with (tmp_path / "axes.csv").open("w", newline="") as file:
        csv.writer(file).writerows([head, *rows])
    linkage = sb.load(tmp_path / "axes.csv")
    assert linkage.kind == "RSCR"
    model = pose.linkage.motion(24)
    motion = linkage.motion(24)
    assert sorted(c.motion_type for c in motion) == sorted(c.motion_type for c in model)
    # the ranges of the output are the model's, whatever sense and zero the axes give it
    ours, theirs = (sorted(np.ptp(c.output) for c in m) for m in (motion, model))
    np.testing.assert_allclose(ours, theirs, rtol=1e-6)
    assert (
        f"{count - 4} rows without a kind left out"
        in sevenbar("analyze", "axes.csv", "--json", cwd=tmp_path).stderr
    )


def test_faces_keep_their_names_and_fillets_are_left_out(tmp_path):
    hole = build123d.Pos(10, 20, 0) * build123d.Cylinder(3, 40)
    block = build123d.fillet(build123d.Box(60, 60, 20).edges().filter_by(build123d.Axis.Z), 5)
    build123d.export_step(block - hole, tmp_path / "block.step")
    text = (tmp_path / "block.step").read_text()
    named = text.splitlines()
    faces = [k for k, line in enumerate(named) if "ADVANCED_FACE(''" in line]
    # every face named; only the hole's is a whole cylinder
    for n, k in enumerate(faces):
        named[k] = named[k].replace("ADVANCED_FACE(''", f"ADVANCED_FACE('F{n}'")
    (tmp_path / "block.step").write_text("\n".join(named))
    (axis,) = sb.axes_of_step(tmp_path / "block.step")
    assert (axis.shape, axis.radii, axis.extent) == ("cylinder", (3.0,), pytest.approx(20))
    np.testing.assert_allclose(axis.at, [10, 20, 0], atol=1e-9)
    np.testing.assert_allclose(axis.direction, [0, 0, 1], atol=1e-12)
    assert len(axis.faces) == 1
    assert axis.faces[0].startswith("F")
    assert (
        json.loads(sevenbar("axes", tmp_path / "block.step", "--json").stdout)["axes"][0]["name"]
        == axis.faces[0]
    )


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no such file; give the path of a STEP file"),
        (b"format = 1\n", "is no STEP file; export the model as STEP (.step, .stp)"),
        (
            b"ISO-10303-21;\nHEADER;\n",
            "is damaged, or no model: no part could be read; export it again as STEP",
        ),
    ],
)
def test_what_is_no_model_is_refused(tmp_path, content, message):
    path = tmp_path / "m.step"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(TableError) as refused:
        sb.axes_of_step(path)
    assert str(refused.value) == f"{path}: {message}"


def test_the_table_needs_an_ending_and_replaces_nothing(models, tmp_path):
    path = models["rscr"][0]
    assert mistake("axes", path, "--out", "axes.toml", cwd=tmp_path).startswith(
        "--out: axes.toml: the table is written as CSV"
    )
    (tmp_path / "axes.csv").write_text("mine")
    assert "exists already" in mistake("axes", path, "--out", "axes.csv", cwd=tmp_path)
    assert (tmp_path / "axes.csv").read_text() == "mine"


def test_without_build123d_one_message_says_what_to_install(models, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "OCP.BRepAdaptor", None)
    with pytest.raises(
        MissingExtraError,
        match=r"reading STEP needs build123d; install it with: pip install 'sevenbar\[cad\]'",
    ):
        sb.axes_of_step(models["rscr"][0])
