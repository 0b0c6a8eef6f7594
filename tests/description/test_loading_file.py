"""What acts on a linkage, in a file: its units, what is refused with which words, and that written files keep it."""

import copy
import json
import math
import pickle
import tomllib
from dataclasses import replace

import jsonschema
import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.description import gallery
from sevenbar.description.draft import Draft
from sevenbar.description.forms import from_description
from sevenbar.description.schema import json_schema
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.forces.bodies import entries_of, tensor_of
from sevenbar.text.quantities import QUANTITY_KINDS, quantity_of, unit_of

RSSR = (
    'format = 1\n{head}\n[drive]\nspeed = "10 rad/s"\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL3 = 550\nD = 0\n'
)

EVERYTHING = """
[forces]
gravity = [0, 0, "-9806.65 mm/s^2"]
mass_unit = "g"

[[body]]
link = 2
mass = "1.3 kg"
centre = ["1 cm", 0, 0]
inertia = ["4e-3 kg m^2", 4e6, 10e3, 0, 0, "1e3*5"]

[[body]]
link = 1
mass = 250
solid = "rod"

[[load]]
link = 3
at = [0, 0, "1 in"]
force = [0, 0, "-0.1 kN"]
between = [30, "2 rad"]
name = "press"

[[load]]
link = 1
torque = ["300 N mm", 0, 0]
axes = "link"
table = [[0, 0], ["30 deg", 1], [60, 0]]

[[spring]]
links = [4, 3]
at = [[900, 300, 500], [100, 50, -200]]
stiffness = "300 N/m"
length = "40 cm"
damping = "10 N s/m"

[[spring]]
joint = "rocker"
stiffness = "0.5 N m/deg"
free = "20 deg"
"""


def rssr(tables: str = "", head: str = "") -> str:
    return RSSR.format(head=head) + tables


def same(one: sb.Loading, other: sb.Loading) -> bool:
    """Whether two hold the same, numbers to rounding."""
    if one.bodies.keys() != other.bodies.keys() or one.gravity != pytest.approx(other.gravity):
        return False
    for link, own in one.bodies.items():
        for a, b in zip(own, other.bodies[link], strict=True):
            close = a.mass == pytest.approx(b.mass) and np.allclose(a.tensor, b.tensor, rtol=1e-14, atol=0)
            if not close or a.centre != (b.centre and pytest.approx(b.centre)) or a.solid != b.solid:
                return False
    return repr(one.loads) == repr(other.loads) and repr(one.springs) == repr(other.springs)


def test_a_file_s_numbers_become_kilograms_newtons_and_its_own_lengths():
    loading = sb.loads(rssr(EVERYTHING)).loading
    assert loading.gravity == pytest.approx((0, 0, -9.80665), rel=1e-15)
    (rod,), (coupler,) = loading.bodies[1], loading.bodies[2]
    assert (rod.mass, rod.solid) == (0.25, "rod")
    assert (coupler.mass, coupler.centre) == (1.3, (10, 0, 0))
    expected = [[4e-3, 5e-6, 0], [5e-6, 4e-3, 0], [0, 0, 10e-6]]
    np.testing.assert_allclose(coupler.tensor, expected, rtol=1e-15)
    press, torque = loading.loads
    assert press.force == (0, 0, -100)
    assert press.at == (0, 0, 25.4)
    assert press.between == pytest.approx((math.pi / 6, 2), rel=1e-15)
    assert (press.name, press.axes, torque.axes) == ("press", "ground", "link")
    assert torque.torque == (0.3, 0, 0)
    assert torque.table == ((0, pytest.approx(math.pi / 6), pytest.approx(math.pi / 3)), (0, 1, 0))
    between, turning = loading.springs
    assert (between.links, between.stiffness, between.length, between.damping) == ((4, 3), 0.3, 400, 0.01)
    assert turning.joint == "rocker"
    assert turning.stiffness == pytest.approx(0.5 * 180 / math.pi, rel=1e-15)
    assert turning.length == pytest.approx(math.radians(20), rel=1e-15)


def test_the_description_holds_the_numbers_in_the_file_s_units():
    raw = sb.loads(rssr(EVERYTHING)).description
    assert raw["body"][0] == {
        "link": 2, "mass": 1300, "centre": [10, 0, 0], "inertia": [4e6, 4e6, 10e3, 0, 0, 5000]
    }  # fmt: skip
    assert raw["spring"][0]["length"] == 400
    assert raw["load"][0]["between"] == [30, pytest.approx(math.degrees(2))]


def test_several_bodies_of_a_link_stay_apart_in_the_file_s_order():
    tables = "".join(
        f"[[body]]\nlink = {link}\nmass = {mass}\ncentre = [1, 2, 3]\n"
        for link, mass in ((2, 1), (1, 2), (2, 3))
    )
    bodies = sb.loads(rssr(tables)).loading.bodies
    assert {link: [body.mass for body in own] for link, own in bodies.items()} == {2: [1, 3], 1: [2]}


def test_an_angle_unit_of_radians_holds_for_loads_and_joints():
    tables = (
        "[[load]]\nlink = 1\ntorque = [1, 0, 0]\nbetween = [1, 2]\n"
        '[[spring]]\njoint = "crank"\nstiffness = 1\nfree = 0.5\n'
    )
    loading = sb.loads(rssr(tables, 'angle_unit = "rad"')).loading
    assert loading.loads[0].between == (1, 2)
    assert loading.springs[0].length == 0.5


def test_a_joint_that_slides_has_a_spring_in_newtons_by_the_length_unit():
    text = gallery.text("rssp") + '\n[[spring]]\njoint = "{}"\nstiffness = "2e4 N/m"\nfree = "1 cm"\n'
    linkage = sb.load("rssp")
    slide = linkage.columns[linkage.column_kinds.index("slide")]
    spring = sb.loads(text.format(slide)).loading.springs[0]
    assert (spring.joint, spring.stiffness, spring.length) == (slide, 20, 10)
    with pytest.raises(
        DescriptionError, match="'2 N m/rad': 'N m/rad' is not a unit of stiffness; give a stiff"
    ):
        sb.loads(text.format(slide).replace("2e4 N/m", "2 N m/rad"))


def test_a_joint_of_several_freedoms_has_its_spring_in_the_first_or_in_the_one_named():
    text = gallery.text("rscr") + '\n[[spring]]\njoint = "{}"\nstiffness = 3\nfree = 2\n'
    cylinder = next(joint for joint in sb.load("rscr").joints if joint.kind == "C")
    first, second = (
        sb.loads(text.format(name)).loading.springs[0] for name in (cylinder.name, cylinder.columns[1])
    )
    assert (first.joint, first.length) == (cylinder.columns[0], pytest.approx(math.radians(2)))
    assert (second.joint, second.length) == (cylinder.columns[1], 2)


PRESS = "[[load]]\nlink = 3\ntorque = [0, 0, 1]\ntable = '{}'\n"


@pytest.mark.parametrize(
    ("text", "inputs", "factors"),
    [
        ("crank [deg],factor\n0,0\n30,1\n60,0\n", (0, 30, 60), (0, 1, 0)),
        ("crank_rad;share\n0;0\n1,5;0,5\n", (0, math.degrees(1.5)), (0, 0.5)),
        ("time [s],crank [deg],factor,other\n0,10,0,5\n1,20,2,6\n", (10, 20), (0, 2)),
    ],
)
def test_a_table_is_read_from_the_folder_of_its_file(tmp_path, text, inputs, factors):
    (tmp_path / "press.csv").write_text(text, encoding="utf-8")
    (tmp_path / "a.toml").write_text(rssr(PRESS.format("press.csv")), encoding="utf-8")
    linkage = sb.load(tmp_path / "a.toml")
    at, found = linkage.loading.loads[0].table
    assert np.degrees(at) == pytest.approx(inputs, rel=1e-14)
    assert found == factors
    assert linkage.description["load"][0]["table"] == [
        [pytest.approx(a), b] for a, b in zip(inputs, factors, strict=True)
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "crank,factor\n0,0\n30,1\n",
            "needs one column of the input, an angle with its unit, and one of the factor without; the columns are "
            "'crank', 'factor'; name them as in 'crank [deg],factor'",
        ),
        ("crank [deg],factor\n0,0\n30,1\n30,0\n", "line 4, column 'crank [deg]': give two rows or more, inputs rising"),
        ("crank [deg],factor\n0,0\n", "give two rows or more, inputs rising"),
        ("crank [deg],factor\n0,0\n30,wide\n", "line 3, column 'factor': 'wide' is not a number; mend the cell or "
         "leave the row out"),
        ("crank [deg],factor\n" + "".join(f"{i},1\n" for i in range(1001)), "1001 rows; give at most 1000"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_table_is_told_with_its_line(tmp_path, text, message):
    (tmp_path / "press.csv").write_text(text, encoding="utf-8")
    (tmp_path / "a.toml").write_text(rssr(PRESS.format("press.csv")), encoding="utf-8")
    with pytest.raises(DescriptionError) as caught:
        sb.load(tmp_path / "a.toml")
    problem = caught.value.problems[0]
    assert problem.place == "load[1].table"
    assert problem.message == f"{tmp_path / 'press.csv'}: {message}"


PRESS_ROWS = "crank [deg],factor\n0,0\n30,1\n60,0\n"


def test_a_table_below_the_folder_is_read_and_one_outside_is_refused_whether_it_exists_or_not(tmp_path):
    folder, outside = tmp_path / "mine", tmp_path / "press.csv"
    (folder / "deep").mkdir(parents=True)
    for path in (outside, folder / "deep" / "press.csv"):
        path.write_text(PRESS_ROWS, encoding="utf-8")
    (folder / "link.csv").symlink_to(outside)
    (folder / "up").symlink_to(tmp_path)
    (folder / "inner.csv").symlink_to(folder / "deep" / "press.csv")
    (folder / "loop.csv").symlink_to(folder / "loop.csv")
    file = folder / "a.toml"
    for name in ("deep/press.csv", "./deep/../deep/press.csv", "inner.csv"):
        file.write_text(rssr(PRESS.format(name)), encoding="utf-8")
        assert len(sb.load(file).loading.loads[0].table[0]) == 3
    for name in (
        str(outside), str(folder / "deep" / "press.csv"), "../press.csv", "../none.csv", "deep/../../press.csv", "link.csv",
        "up/press.csv", "/etc/passwd", "/none", "C:\\\\press.csv", "C:press.csv", "\\\\\\\\host\\\\share\\\\press.csv",
        "\\\\press.csv", "//host/share/press.csv",
    ):  # fmt: skip
        file.write_text(rssr(PRESS.format("X").replace("'X'", f'"{name}"')), encoding="utf-8")
        for read in (sb.load, lambda path: Draft.of(path.read_text(encoding="utf-8"), str(path))):
            with pytest.raises(DescriptionError) as caught:
                read(file)
            (problem,) = caught.value.problems
            assert problem.place == "load[1].table"
            assert (
                "is not below the folder of this file, which reads no other files; put it there and"
                in problem.message
            )
    for name in ("loop.csv", "none.csv"):
        file.write_text(rssr(PRESS.format(name)), encoding="utf-8")
        with pytest.raises(DescriptionError):
            sb.load(file)


def test_a_written_file_holds_the_rows_of_its_table_and_opens_anywhere(tmp_path):
    degrees = np.linspace(0, 350.1, 400)
    rows = "".join(f"{x!r},{math.sin(x)!r}\n" for x in map(float, degrees))
    (tmp_path / "press.csv").write_text("crank [deg],factor\n" + rows, encoding="utf-8")
    file = tmp_path / "a.toml"
    file.write_text("# kept\n" + rssr(PRESS.format("press.csv")), encoding="utf-8")
    loading = sb.load(file).loading
    draft = Draft.of(file.read_text(encoding="utf-8"), str(file))
    for changed in (
        draft,
        draft.with_values({"L1": 251.5}),
        Draft.of_linkage(sb.load(file)),
        draft.as_opened(),
    ):
        text = changed.toml()
        assert same(sb.loads(text, "elsewhere").loading, loading)
        assert ("# kept" in text) == bool(changed.text)


def test_drafts_sweeps_and_held_dimensions_keep_what_acts():
    text = "# press\n" + rssr(EVERYTHING)
    linkage = sb.loads(text)
    draft = Draft.of(text, "press.toml")
    for changed in (
        draft,
        draft.holding(),
        draft.with_values({"L1": 260.0}),
        draft.with_point("P", 2, (1.0, 2.0, 3.0)),
    ):
        assert same(changed.linkage.loading, linkage.loading)
        written = changed.toml()
        assert same(sb.loads(written).loading, linkage.loading)
        assert "# press" in written
        assert 'mass = "1.3 kg"' in written
    again = draft.with_point("P", 2, (1.0, 2.0, 3.0)).without_point(0)
    assert same(again.linkage.loading, linkage.loading)
    assert same(Draft.of_linkage(linkage).linkage.loading, linkage.loading)


def test_a_body_s_numbers_have_their_place_in_a_draft():
    draft = Draft.of(rssr(EVERYTHING), "press.toml").with_value(("body", 1, "mass"), 500)
    assert draft.linkage.loading.bodies[1][0].mass == 0.5
    moved = draft.with_value(("body", 0, "centre", 2), 7.5)
    assert moved.linkage.loading.bodies[2][0].centre == (10, 0, 7.5)
    assert sb.loads(moved.toml()).loading.bodies[2][0].centre == (10, 0, 7.5)


def test_a_drawn_linkage_that_is_moved_takes_bodies_along_and_leaves_the_ground_s_forces():
    from scipy.spatial.transform import Rotation

    from sevenbar.design.task.placing import Placing, moved

    tables = (
        "\n[[body]]\nlink = 2\nmass = 2\ncentre = [50, 20, 10]\ninertia = [4, 5, 6, 0.3, 0.2, 0.1]\n"
        "[[load]]\nlink = 2\nat = [50, 20, 10]\nforce = [1, 2, 3]\n"
        "[[load]]\nlink = 2\nat = [50, 20, 10]\nforce = [1, 2, 3]\naxes = 'link'\n"
        "[[spring]]\nlinks = [4, 2]\nat = [[1, 2, 3], [50, 20, 10]]\nstiffness = 1\n"
        "[[point]]\nname = 'P'\nlink = 2\nat = [50, 20, 10]\n"
    )
    draft = Draft.of(gallery.text("rscr") + tables, "rscr")
    turn, shift = Rotation.from_rotvec([0.3, -0.7, 1.1]).as_matrix(), np.array([10.0, -4.0, 30.0])
    loading = moved(draft, Placing(turn, shift)).linkage.loading
    place = turn @ (50, 20, 10) + shift
    (body,) = loading.bodies[2]
    assert body.centre == pytest.approx(place)
    inertia = turn @ (1e-6 * tensor_of([4, 5, 6, 0.3, 0.2, 0.1])) @ turn.T
    np.testing.assert_allclose(body.tensor, inertia, rtol=1e-13, atol=1e-20)
    ground, carried = loading.loads
    assert ground.force == (1, 2, 3)
    assert carried.force == pytest.approx(turn @ (1, 2, 3))
    assert ground.at == carried.at == pytest.approx(place)
    assert np.array(loading.springs[0].at) == pytest.approx(np.array([turn @ (1, 2, 3) + shift, place]))


def test_the_entries_of_an_inertia_are_those_of_the_tensor():
    tensor = tensor_of([1, 2, 3, 4, 5, 6])
    assert (tensor[0, 0], tensor[1, 1], tensor[2, 2]) == (1, 2, 3)
    assert (tensor[1, 2], tensor[0, 2], tensor[0, 1]) == (4, 5, 6)
    np.testing.assert_array_equal(tensor, tensor.T)
    assert entries_of(tensor) == [1, 2, 3, 4, 5, 6]


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rscr", "bennett"])
def test_what_python_gives_is_kept_in_the_description(name):
    linkage = sb.load(name)
    given = sb.Loading(
        (0, 0, -9.81),
        {1: (sb.Body(1.2, solid="rod"), sb.Body(0.3, (1, 2, 3), np.diag([1e-6, 2e-6, 2.5e-6]))), 2: (sb.Body(solid="drawn"),)},
        (sb.Load(1, force=(1, 2, 3), at=(4, 5, 6), between=(1, 2)), sb.Load(2, torque=(1, 0, 0), axes="link")),
        (
            sb.Spring(3.0, 0.25, joint=linkage.columns[-1]),
            sb.Spring(3.0, 1.0, 0.1, links=(1, len(linkage.joints)), at=((0, 0, 0), (1, 2, 3))),
        ),
    )  # fmt: skip
    loaded = linkage.loaded(
        bodies=given.bodies, gravity=given.gravity, loads=given.loads, springs=given.springs
    )
    assert same(loaded.loading, given)
    assert same(Draft.of_linkage(loaded).linkage.loading, given)
    assert same(sb.loads(Draft.of_linkage(loaded).toml()).loading, given)
    assert linkage.loading.is_empty
    lighter = loaded.loaded(bodies={1: sb.Body(1.0, solid="rod")})
    assert same(lighter.loading, replace(given, bodies={1: (sb.Body(1.0, solid="rod"),)}))
    nothing = loaded.loaded(bodies={}, loads=(), springs=(), gravity=(0, 0, 0))
    assert nothing.loading.is_empty
    assert Draft.of_linkage(nothing).linkage.loading.is_empty


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"bodies": {7: sb.Body(1, solid="rod")}}, "bodies: link 7 is not a link; give 1 to 3"),
        ({"bodies": {4: sb.Body(1, solid="rod")}}, "bodies: link 4 is the ground, which does not move; give 1 to 3"),
        ({"loads": [sb.Load(5, torque=(1, 0, 0))]}, "loads[0]: link 5 is not a link; give 1 to 3"),
        (
            {"springs": [sb.Spring(1, joint="ball_a")]},
            "springs[0].joint: joint 'ball_a' is a ball; give a joint with one freedom: crank, rocker",
        ),
        (
            {"springs": [sb.Spring(1, links=(1, 9), at=((0, 0, 0), (0, 0, 0)))]},
            "springs[0]: link 9 is not a link; give 1 to 4, the last is the ground",
        ),
        ({"gravity": (0, 0)}, "gravity: 2 numbers; give three"),
    ],
)  # fmt: skip
def test_links_and_joints_that_do_not_exist_are_refused_in_python(given, message):
    with pytest.raises(RequestError) as caught:
        sb.load("rssr").loaded(**given)
    assert str(caught.value) == message


def test_units_are_read_with_every_sign_that_people_write():
    for text in ("2 N m", "2 N*m", "2 N·m", "2Nm", "2 Nm", "0.002 kN m", "2000 N mm", "(1+1) N m", "2"):
        assert quantity_of(text, "torque") == pytest.approx(2, rel=1e-15)
    for text in ("2 m/s^2", "2 m/s2", "2 m/s²", "2 m/s/s", "2 m/s**2", "2000 mm/s^2"):
        assert quantity_of(text, "acceleration") == pytest.approx(2, rel=1e-15)
    assert quantity_of("1 lbf", "force") == pytest.approx(0.45359237 * 9.80665, rel=1e-15)
    assert quantity_of("1 lb ft^2", "inertia", mass_unit="lb", length_unit="in") == 144
    assert unit_of("lbf").powers == unit_of("kg m/s^2").powers


@pytest.mark.parametrize("kind", QUANTITY_KINDS)
@pytest.mark.parametrize(
    "text", ["", "kg", "1 furlong", "1 kg^7", "1 N/", "1 / N", "nan", "1e999 N", "1,5 kg", "x"]
)
def test_a_text_that_is_no_amount_has_one_message(kind, text):
    with pytest.raises(RequestError, match=r"; give an? [a-z ]+, as in 12, '12 ") as caught:
        quantity_of(text, kind)
    assert "\n" not in str(caught.value)


def test_the_json_schema_takes_what_the_program_takes():
    takes = jsonschema.Draft202012Validator(json_schema()).is_valid
    right = tomllib.loads(rssr(EVERYTHING))
    assert takes(right)
    assert takes(json.loads(json.dumps(sb.loads(rssr(EVERYTHING)).description)))
    for head, mistake in (
        ("forces", {"mass_unit": "stone"}),
        ("forces", {"gravity": 9.81}),
        ("body", [{"mass": 1}]),
        ("body", [{"link": 1, "mass": -1, "solid": "rod"}]),
        ("body", [{"link": 1, "mass": 1, "solid": "bar"}]),
        ("body", [{"link": 1, "mass": 1, "centre": [0, 0, 0], "inertia": [1, 1, 1]}]),
        ("load", [{"link": 1, "torque": [0, 0, 1], "axes": "body"}]),
        ("load", [{"link": 1, "torque": [0, 0, 1], "table": 3}]),
        ("spring", [{"links": [1], "at": [[0, 0, 0], [1, 0, 0]], "stiffness": 1}]),
        ("spring", [{"joint": "crank", "stiffness": "stiff"}]),
    ):
        assert not takes(right | {head: mistake}), mistake
        with pytest.raises(DescriptionError):
            from_description(right | {head: mistake})


@pytest.mark.parametrize("again", [copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_what_acts_is_copied_and_pickled_with_its_linkage(again):
    linkage = sb.loads(rssr(EVERYTHING))
    assert same(again(linkage).loading, linkage.loading)
    assert same(replace(linkage, name="other").loading, linkage.loading)


def test_what_acts_changes_no_motion():
    plain, loaded = (sb.loads(rssr(tables)).motion(24).circuits[0] for tables in ("", EVERYTHING))
    np.testing.assert_array_equal(plain.q, loaded.q)
    np.testing.assert_array_equal(plain.ddq, loaded.ddq)


def test_calibrated_and_swept_files_keep_what_acts(tmp_path):
    """The commands write files to other folders, which open there."""
    (tmp_path / "press.csv").write_text("crank [deg],factor\n0,0\n30,1\n", encoding="utf-8")
    (tmp_path / "a.toml").write_text(rssr(EVERYTHING + PRESS.format("press.csv")), encoding="utf-8")
    linkage = sb.load(tmp_path / "a.toml")
    circuit = linkage.motion(36).circuits[0]
    rows = zip(np.degrees(circuit.input).tolist(), np.degrees(circuit.output).tolist(), strict=True)
    lines = "\n".join(f"{x!r},{y!r}" for x, y in rows)
    (tmp_path / "bench.csv").write_text(f"crank [deg],rocker [deg]\n{lines}\n", encoding="utf-8")
    run = sevenbar("calibrate", "a.toml", "bench.csv", "--free", "L3", "-o", "out", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert same(sb.load(tmp_path / "out" / "calibrated.toml").loading, linkage.loading)
    run = sevenbar("sweep", "a.toml", "--over", "L1=240:250:2", "-o", "swept", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    plan = json.loads((tmp_path / "swept" / "sweep.json").read_text(encoding="utf-8"))
    assert same(sb.loads(plan["toml"]).loading, linkage.loading)
