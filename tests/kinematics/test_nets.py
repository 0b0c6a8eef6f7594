"""Nets of several loops: links by name, their freedoms and redundant constraints, the order in which they are solved."""

from __future__ import annotations

import json
import math
import re
import tomllib

import numpy as np
import pytest
from typer.testing import CliRunner

import sevenbar as sb
from sevenbar.commands.cli import app
from sevenbar.description.forms import from_description
from sevenbar.errors import DescriptionError, NotCoveredError
from sevenbar.kinematics.circuits.poses import joint_frames, poses
from sevenbar.kinematics.numbers.sensitivity import Numbers
from sevenbar.kinematics.solvers.general import expanded
from sevenbar.reporting.repeated import repeated_lines


def pin(at, *links, name=None):
    return {"at": at, "links": list(links)} | ({} if name is None else {"name": name})


WATT = [
    pin((0, 0), "frame", "crank", name="crank"),
    pin((10, 40), "crank", "coupler"),
    pin((110, 80), "coupler", "rocker"),
    pin((100, 0), "frame", "rocker", name="rocker"),
    pin((150, 60), "rocker", "link"),
    pin((220, 70), "link", "lever"),
    pin((200, 0), "lever", "frame", name="lever"),
]

# two ternary links, on the ground's link between two others
STEPHENSON = [
    pin((0, 0), "frame", "crank", name="crank"),
    pin((20, 30), "crank", "left"),
    pin((110, 5), "frame", "right", name="right"),
    pin((30, 80), "left", "upper"),
    pin((95, 85), "upper", "right"),
    pin((45, 55), "left", "lower"),
    pin((90, 45), "lower", "right"),
]

# Klann's leg: five links that move, one pin of three
KLANN = [
    pin((0, 0), "frame", "crank", name="crank"),
    pin((11, 2), "crank", "coupler"),
    pin((26, -13), "coupler", "rocker"),
    pin((14, -24), "rocker", "frame"),
    pin((58, -14), "coupler", "leg"),
    pin((60, 20), "leg", "upper"),
    pin((37, 37), "upper", "frame"),
]


def net(pins, drive="crank", **more):
    return sb.from_pins(pins, ground="frame", drive=drive, **more)


def blocks(linkage):
    return [[linkage.link_name(link) for link in block.links] for block in linkage.order.blocks]


@pytest.mark.parametrize("pins", [WATT, STEPHENSON, KLANN])
def test_a_planar_six_bar_moves_with_one_freedom_and_repeats_three_constraints_a_cycle(pins):
    mobility = net(pins).mobility()
    assert (mobility.finite, mobility.gruebler, len(mobility.redundant)) == (1, -5, 6)
    assert all("cycle" in line for line in mobility.redundant)


def test_dyads_are_solved_one_after_the_other():
    assert blocks(net(WATT)) == [["coupler", "rocker"], ["link", "lever"]]
    assert blocks(net(KLANN)) == [["coupler", "rocker"], ["leg", "upper"]]
    assert {block.solver for block in net(WATT).order.blocks} == {"dyad"}


def test_watt_driven_at_its_other_end_comes_out_the_other_way_round():
    assert blocks(net(WATT, drive="lever")) == [["rocker", "link"], ["crank", "coupler"]]


def test_stephenson_driven_at_a_link_between_is_one_block_of_four():
    # held at the crank, left and right hang on the frame's link
    (block,) = net(STEPHENSON).order.blocks
    assert (len(block.links), block.solver, block.group) == (4, "links", "planar")


def test_the_order_of_solving_is_that_of_the_links_however_they_are_written():
    want = blocks(net(WATT))
    other = [{**one, "links": one["links"][::-1], "at": (one["at"][1], -one["at"][0])} for one in WATT[::-1]]
    for one in other:
        one["at"] = tuple(300 + 2.5 * x for x in one["at"])
    linkage = net(other)
    assert [set(block) for block in blocks(linkage)] == [set(block) for block in want]
    assert linkage.mobility().finite == 1


def test_a_pin_of_three_links_is_two_hinges():
    # two dyads that share a pin
    pins = [
        pin((0, 0), "frame", "crank", name="crank"),
        pin((10, 30), "crank", "a", "b"),
        pin((60, 60), "a", "c"),
        pin((70, 0), "c", "frame"),
        pin((-60, 50), "b", "d"),
        pin((-70, 0), "d", "frame"),
    ]
    linkage = net(pins)
    assert [joint.name for joint in linkage.joints[1:3]] == ["pin_2.1", "pin_2.2"]
    assert sorted(map(sorted, blocks(linkage))) == [["a", "c"], ["b", "d"]]
    assert linkage.mobility().finite == 1


def test_three_equal_cranks_repeat_one_constraint_besides():
    pins = [
        pin((0, 0), "frame", "one", name="crank"),
        pin((6, 10), "one", "coupler"),
        pin((20, 0), "frame", "two"),
        pin((26, 10), "two", "coupler"),
        pin((50, 0), "frame", "three"),
        pin((56, 10), "three", "coupler"),
    ]
    linkage = net(pins)
    mobility = linkage.mobility()
    assert (mobility.finite, mobility.gruebler, len(mobility.redundant)) == (1, -6, 7)
    assert mobility.redundant[-1] == "a constraint that repeats the others of its cycles"
    assert linkage.order.held
    assert not linkage.order.blocks
    # one crank longer than the others: a structure
    pins[5] = pin((56, 11), "three", "coupler")
    assert net(pins).mobility().finite == 0


def test_a_double_wishbone_with_a_track_rod_moves_with_one_freedom():
    joints = [
        {
            "name": "lower",
            "kind": "R",
            "at": [0, 300, 200],
            "axis": [1, 0, 0],
            "between": ["frame", "lower arm"],
        },
        {
            "name": "upper",
            "kind": "R",
            "at": [10, 350, 450],
            "axis": [1, 0.1, 0],
            "between": ["frame", "upper arm"],
        },
        {"name": "ball low", "kind": "S", "at": [0, 700, 190], "between": ["lower arm", "upright"]},
        {"name": "ball high", "kind": "S", "at": [-10, 660, 440], "between": ["upper arm", "upright"]},
    ]
    rods = [{"name": "track rod", "between": ["frame", "upright"], "at": [[120, 320, 250], [110, 690, 255]]}]
    linkage = sb.from_axes(joints, rods=rods, ground="frame", drive="lower")
    mobility = linkage.mobility()
    # 3 links on two hinges, two balls and a rod
    assert (mobility.gruebler, mobility.finite, mobility.redundant) == (1, 1, ())
    assert mobility.idle == ("turn of track rod about the line of its two balls",)
    (block,) = linkage.order.blocks
    assert set(blocks(linkage)[0]) == {"upper arm", "upright"}
    assert (block.solver, block.group, block.rods) == ("links", "spatial", (0,))
    # the rod as a link between two balls, which spins
    balls = [
        {"name": f"end {i}", "kind": "S", "at": at, "between": [link, "track rod"]}
        for i, (link, at) in enumerate(zip(rods[0]["between"], rods[0]["at"], strict=True))
    ]
    drawn = sb.from_axes([*joints, *balls], ground="frame", drive="lower").mobility()
    assert (drawn.gruebler, drawn.finite, drawn.idle) == (2, 1, mobility.idle)


def test_a_platform_on_six_rods_is_held():
    rng = np.random.default_rng(3)
    base, top = (np.round(rng.uniform(-1, 1, (6, 3)), 3) for _ in range(2))
    top[:, 2] += 4
    rods = [
        {"name": f"leg {i}", "between": ["frame", "platform"], "at": [a.tolist(), b.tolist()]}
        for i, (a, b) in enumerate(zip(base, top, strict=True), 1)
    ]
    crank = {"name": "crank", "kind": "R", "at": [5, 0, 0], "axis": [0, 0, 1], "between": ["frame", "crank"]}
    rods[0]["between"] = ["crank", "platform"]
    # an arm that a rod holds to the platform
    arm = {"name": "arm", "kind": "R", "at": [-6, 0, 0], "axis": [0, 1, 0], "between": ["frame", "arm"]}
    rods.append({"name": "link", "between": ["arm", "platform"], "at": [[-6, 0, 2], top[0].tolist()]})
    joints = [crank, arm]
    linkage = sb.from_axes(joints, rods=rods, ground="frame", drive="crank")
    mobility = linkage.mobility()
    assert (mobility.gruebler, mobility.finite) == (1, 1)
    block, follower = linkage.order.blocks
    assert blocks(linkage) == [["platform"], ["arm"]]
    assert (len(block.rods), len(follower.rods)) == (6, 1)


def test_a_spherical_net_has_a_centre():
    axes = np.array(
        [
            [1, 0, 0],
            [0.9, 0.6, 0],
            [0.3, 0.9, 0.5],
            [0, 1, 0],
            [0.2, 0.7, 0.8],
            [-0.3, 0.4, 0.9],
            [-0.5, 0.1, 1],
        ]
    )
    pairs = [
        "frame crank",
        "crank coupler",
        "coupler rocker",
        "rocker frame",
        "rocker link",
        "link lever",
        "lever frame",
    ]
    joints = [
        {
            "name": f"j{i}",
            "kind": "R",
            "at": (3 * axis).tolist(),
            "axis": axis.tolist(),
            "between": pair.split(),
        }
        for i, (axis, pair) in enumerate(zip(axes, pairs, strict=True), 1)
    ]
    linkage = sb.from_axes(joints, ground="frame")
    mobility = linkage.mobility()
    assert (mobility.finite, mobility.gruebler, len(mobility.redundant)) == (1, -5, 6)
    assert {block.group for block in linkage.order.blocks} == {"spherical"}
    assert [block.solver for block in linkage.order.blocks] == ["loop", "loop"]


@pytest.mark.parametrize("kind", ["R", "P", "C", "U", "S", "E", "K", "L"])
def test_every_kind_of_joint_closes_a_net_as_its_own_freedoms_say(kind):
    # the same six links in space, one joint of another kind: freedoms rise by those it has more than a hinge
    rng = np.random.default_rng(5)
    names = ["frame", "a", "b", "c", "d", "e"]
    pairs = [("frame", "a"), ("a", "b"), ("b", "c"), ("c", "d"), ("d", "e"), ("e", "frame"), ("b", "e")]
    joints = []
    for i, pair in enumerate(pairs):
        own = {
            "name": f"j{i}",
            "kind": "R" if i < 5 else "S",
            "at": rng.uniform(-5, 5, 3).tolist(),
            "between": list(pair),
        }
        if own["kind"] == "R":
            own["axis"] = rng.normal(size=3).tolist()
        joints.append(own)
    last = {"name": "last", "kind": kind, "at": [1.0, 2.0, -1.0], "between": ["c", "frame"]}
    if kind in "KL":
        last["axes"] = [[1.0, 0, 0], [0, 0, 1.0]]
    elif kind == "U":
        last["axes"] = [[1.0, 0.2, 0], [0, 0.3, 1.0]]
    elif kind != "S":
        last["axis"] = [0.2, 0.3, 0.9]
    freedoms = {"R": 1, "P": 1, "C": 2, "U": 2, "S": 3, "E": 3, "K": 2, "L": 2}[kind]
    linkage = sb.from_axes([*joints, last], ground="frame")
    mobility = linkage.mobility()
    assert mobility.freedoms == 5 + 6 + freedoms
    assert mobility.gruebler == 6 * 5 - 5 * 5 - 2 * 3 - (6 - freedoms)
    assert mobility.gruebler == mobility.finite - len(mobility.redundant)
    assert len(names) == linkage.graph.ground


FOUR_BAR = """
format = 1
ground = "frame"
[drive]
joint = "crank"
output = "rocker"
speed = "60 rpm"
[[joint]]
name = "crank"
kind = "R"
at = [0, 0, 0]
axis = [0, 0, 1]
between = ["frame", "crank"]
[[joint]]
name = "rocker"
kind = "R"
at = [90, 0, 0]
axis = [0, 0, 1]
between = ["frame", "rocker"]
[[joint]]
name = "b"
kind = "R"
at = [100, 70, 0]
axis = [0, 0, -1]
between = ["rocker", "coupler"]
[[joint]]
name = "a"
kind = "R"
at = [10, 40, 0]
axis = [0, 0, 1]
between = ["crank", "coupler"]
[[point]]
name = "P"
link = "coupler"
at = [50, 90, 0]
[[body]]
link = "rocker"
mass = 2.0
centre = [95, 35, 0]
"""


def loop_in_order(raw):
    joints = {joint["name"]: {k: v for k, v in joint.items() if k != "between"} for joint in raw["joint"]}
    joints["b"]["axis"] = [0, 0, 1]
    tables = {k: v for k, v in raw.items() if k != "ground"}
    tables["joint"] = [joints[name] for name in ("crank", "a", "b", "rocker")]
    return tables | {"point": [{**raw["point"][0], "link": 2}], "body": [{**raw["body"][0], "link": 3}]}


def test_a_single_loop_with_links_by_name_equals_itself_to_the_last_bit():
    raw = tomllib.loads(FOUR_BAR)
    one, other = sb.loads(FOUR_BAR), sb.loads(FOUR_BAR.replace("[0, 0, -1]", "[0, 0, 1]"))
    plain = from_description(loop_in_order(raw))
    assert one.columns == plain.columns == ("crank", "a", "b", "rocker")
    assert np.array_equal(one.frames, plain.frames)
    for mine, theirs in zip(one.motion(), plain.motion(), strict=True):
        assert np.array_equal(mine.q, theirs.q)
        assert np.array_equal(mine.dq, theirs.dq)
        assert np.array_equal(mine.forces().torque, theirs.forces().torque)
    # a joint between two links in the other order counts the other way round
    q, turned = one.motion().circuits[0]["b"], other.motion().circuits[0]["b"]
    assert np.abs(np.angle(np.exp(1j * (q + turned)))).max() < 1e-12


@pytest.mark.parametrize("name", ["a", "b", "rocker"])
def test_values_count_the_second_link_against_the_first(name):
    raw = tomllib.loads(FOUR_BAR)
    plain = from_description(raw).motion().circuits[0][name]
    next(joint for joint in raw["joint"] if joint["name"] == name)["between"].reverse()
    turned = from_description(raw).motion().circuits[0][name]
    assert np.abs(np.angle(np.exp(1j * (plain + turned)))).max() < 1e-12


def test_links_that_nothing_joins_to_the_ground_are_named():
    apart = [
        *WATT,
        pin((500, 0), "x", "y"),
        pin((510, 0), "y", "z"),
        pin((520, 9), "z", "x"),
    ]
    with pytest.raises(DescriptionError, match=r"ground: x, y, z: nothing joins them to 'frame'"):
        net(apart)


def test_two_freedoms_and_none_are_told():
    open_pins = [*WATT[:6], pin((220, 70), "lever", "arm"), pin((200, 0), "arm", "frame")]
    open_pins[5] = pin((190, 90), "link", "lever")
    two = net(open_pins)
    assert two.mobility().finite == 2
    assert set(two.order.free) <= {"link", "lever", "arm"}
    assert two.order.free
    held = net([*WATT, pin((160, 40), "rocker", "brace"), pin((40, 10), "brace", "frame")])
    assert held.mobility().finite == 0


def circles(a, b, one, two):
    """Where a circle of radius one about a meets that of radius two about b."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    line = b - a
    d = math.hypot(*line)
    along = (one**2 - two**2 + d**2) / (2 * d)
    square = one**2 - along**2
    if square < 0:
        return []
    x, y = line / d
    return [a + along * np.array([x, y]) + side * math.sqrt(square) * np.array([-y, x]) for side in (1, -1)]


def carried(places, a, b, onto_a, onto_b):
    """A place of a link, drawn at `places`, whose drawn places a, b are at onto_a, onto_b."""
    turn = complex(*(onto_b - onto_a)) / complex(*np.subtract(b, a))
    at = complex(*onto_a) + turn * complex(*np.subtract(places, a))
    return np.array([at.real, at.imag])


def watt_by_hand(angle):
    """The lever's end in every mode, by four circles."""
    at = [np.array(one["at"], dtype=float) for one in WATT]
    turn = complex(math.cos(angle), math.sin(angle)) * complex(*at[1])
    crank = np.array([turn.real, turn.imag])
    result = []
    for knee in circles(crank, at[3], math.dist(at[1], at[2]), math.dist(at[3], at[2])):
        side = carried(at[4], at[3], at[2], at[3], knee)
        result += circles(side, at[6], math.dist(at[4], at[5]), math.dist(at[6], at[5]))
    return np.array(result)


@pytest.mark.parametrize("angle", np.linspace(0, 6, 13))
def test_modes_of_watt_are_those_of_circles_by_hand(angle):
    linkage = net(WATT)
    modes = linkage.assembly_modes(angle)
    assert (modes.completeness, modes.residual.max(initial=0) < 1e-12) == ("closed-form", True)
    frames = poses(linkage, modes.q)
    lever = linkage.link_names.index("lever")
    ends = (frames[:, lever] @ [220, 70, 0, 1])[:, :2]
    want = watt_by_hand(angle)
    assert len(ends) == len(want)
    for end in want:
        assert np.abs(ends - end).max(axis=1).min(initial=1) < 1e-10


def test_a_curve_of_poses_at_one_input_is_told_and_no_mode():
    # a kite, whose rocker turns freely where its pivot and the crank's end are in one place, and a dyad on it
    kite = [
        pin((0, 0), "frame", "crank", name="crank"),
        pin((0.8, 0.6), "crank", "coupler"),
        pin((1, 2), "coupler", "rocker"),
        pin((1, 0), "frame", "rocker"),
        pin((1.5, 2), "rocker", "link"),
        pin((3, 2.5), "link", "lever"),
        pin((3, 0), "lever", "frame"),
    ]
    # both links of the kite are as long
    knee = np.array([0.8, 0.6])
    end = np.array([1.0, 0.0])
    middle = (knee + end) / 2
    across = np.array([0.6, 0.2]) / math.hypot(0.6, 0.2)
    kite[2] = pin(tuple((middle + 1.5 * across).tolist()), "coupler", "rocker")
    linkage = net(kite)
    angle = -math.atan2(0.6, 0.8)
    curved = linkage.assembly_modes(angle)
    assert (curved.completeness, len(curved)) == ("algebraic", 0)
    before, after = joint_frames(linkage, poses(linkage, curved.on_curve[None]))
    for joint, one in enumerate(linkage.joints):
        moved = before[:, joint] @ one.motion(curved.on_curve[None, linkage.places[joint]])
        assert np.abs(moved - after[:, joint]).max() < 1e-9 * linkage.size
    near = linkage.assembly_modes(angle + 1e-3)
    assert (near.completeness, near.on_curve) == ("closed-form", None)
    assert len(near) > 0


SLIDERS = [
    # a crank, a coupler, a block on a rail; a rocker in a block of the coupler; a lever with a slide at its end
    {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1], "between": ["frame", "crank"]},
    {"name": "knee", "kind": "R", "at": [20, 30, 0], "axis": [0, 0, 1], "between": ["crank", "coupler"]},
    {"name": "pin", "kind": "R", "at": [120, 10, 0], "axis": [0, 0, 1], "between": ["coupler", "block"]},
    {"name": "rail", "kind": "P", "at": [120, 10, 0], "axis": [1, 0.1, 0], "between": ["frame", "block"]},
    {"name": "swing", "kind": "R", "at": [60, -60, 0], "axis": [0, 0, 1], "between": ["frame", "rocker"]},
    {"name": "slot", "kind": "P", "at": [70, 20, 0], "axis": [0.2, 1, 0], "between": ["rocker", "sleeve"]},
    {"name": "eye", "kind": "R", "at": [70, 20, 0], "axis": [0, 0, 1], "between": ["sleeve", "coupler"]},
]


def test_every_mode_closes_every_joint_and_the_drawing_is_one():
    for linkage in (net(WATT), net(KLANN), sb.from_axes(SLIDERS, ground="frame", drive="crank")):
        drawn = linkage.assembly_modes(0.0)
        assert np.abs(drawn.q).max(axis=1).min() < 1e-9
        for angle in (-0.2, 0.0, 0.15):
            q = linkage.assembly_modes(angle).q
            assert len(q)
            before, after = joint_frames(linkage, poses(linkage, q))
            for joint, own in enumerate(linkage.joints):
                moved = before[:, joint] @ own.motion(q[:, linkage.places[joint]])
                assert np.abs(moved - after[:, joint]).max() < 1e-9 * linkage.size


def test_modes_are_the_same_however_a_net_is_written():
    plain = net(WATT).assembly_modes(0.4)
    turned = complex(math.cos(1.1), math.sin(1.1))
    other = []
    for one in WATT[::-1]:
        at = 2.5 * turned * complex(*one["at"]) + complex(300, -70)
        other.append({**one, "at": (at.real, at.imag), "links": one["links"][::-1]})
    # each joint counts the other way round
    again = net(other, drive="crank").assembly_modes(-0.4)
    columns = [
        [modes.columns.index(name) for name in ("crank", "rocker", "lever")] for modes in (plain, again)
    ]
    want, rows = np.exp(1j * plain.q[:, columns[0]]), np.exp(-1j * again.q[:, columns[1]])
    assert len(want) == len(rows)
    for row in want:
        assert np.abs(rows - row).max(axis=1).min() < 1e-10
    mirrored = [{**one, "at": (-one["at"][0], one["at"][1])} for one in WATT]
    assert len(net(mirrored).assembly_modes(-0.4)) == len(plain)


def test_a_slide_may_drive_and_values_count_from_the_drawing():
    joints = [dict(one) for one in SLIDERS]
    joints[3]["value"] = 12.0
    linkage = sb.from_axes(joints, ground="frame", drive="rail")
    assert blocks(linkage) == [["crank", "coupler"], ["rocker", "sleeve"]]
    modes = linkage.assembly_modes(12.0)
    drawn = np.zeros(len(linkage.columns))
    drawn[linkage.columns.index("rail")] = 12.0
    assert np.abs(modes.q - drawn).max(axis=1).min() < 1e-9
    assert np.allclose(modes.q[:, linkage.columns.index("rail")], 12.0)


def test_what_a_net_does_not_answer_yet_says_what_it_does():
    linkage = net(WATT)
    for asked in (lambda: Numbers(linkage), lambda: expanded(linkage)):
        with pytest.raises(NotCoveredError, match="net: this linkage has several loops; its freedoms"):
            asked()
    assert linkage.plane.normal.tolist() == [0, 0, 1]
    assert linkage.as_four_bar() is None


def test_analyze_prints_freedoms_and_blocks(tmp_path):
    file = tmp_path / "watt.toml"
    lines = ['format = 1\nname = "Watt"\nground = "frame"\n[drive]\njoint = "crank"\n']
    lines += [
        f"[[pin]]\nat = {list(one['at'])}\nlinks = {json.dumps(one['links'])}\n"
        + (f'name = "{one["name"]}"\n' if "name" in one else "")
        for one in WATT
    ]
    file.write_text("".join(lines), encoding="utf-8")
    runner = CliRunner()
    printed = runner.invoke(app, ["analyze", str(file)])
    assert printed.exit_code == 0
    assert "1 (Gruebler 7 - 12 = -5, rank 6, 6 redundant constraints)" in printed.stdout
    assert "a dyad, in closed form" in printed.stdout
    answer = json.loads(runner.invoke(app, ["analyze", str(file), "--json"]).stdout)
    order = answer["net"]["order"]
    assert [block["links"] for block in order] == [["coupler", "rocker"], ["link", "lever"]]
    assert answer["mobility"]["finite"] == 1
    modes = json.loads(runner.invoke(app, ["modes", str(file), "--at", "10deg", "--json"]).stdout)
    assert (modes["completeness"], len(modes["modes"])) == ("closed-form", 2)
    other = json.loads(runner.invoke(app, ["analyze", str(file), "--json", "--input", "lever"]).stdout)
    order = other["net"]["order"]
    assert [block["links"] for block in order] == [["rocker", "link"], ["crank", "coupler"]]
    assert runner.invoke(app, ["analyze", str(file), "--input", "nix"]).exit_code != 0
    ranges = json.loads(runner.invoke(app, ["analyze", str(file), "--json", "--ranges"]).stdout)
    assert "lever" in ranges["circuits"][0]["joint_ranges"]
    assert runner.invoke(app, ["plot", str(file), "--out", str(tmp_path / "figures")]).exit_code == 0
    table = tmp_path / "motion.csv"
    assert runner.invoke(app, ["export", str(file), "--out", str(table)]).exit_code == 0
    assert table.read_text(encoding="utf-8").count("\n") > 700
    # a body or an engine's model is refused before a file is begun
    for command in (["forces", str(file)], ["simulate", str(file)], ["export", str(file), "--to", "glb"]):
        with pytest.raises(NotCoveredError, match="are of single loops"):
            runner.invoke(app, command, catch_exceptions=False)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["figures", "motion.csv", "watt.toml"]


def test_rows_of_a_rod_keep_its_length():
    with pytest.raises(DescriptionError, match="rod"):
        sb.from_pins(WATT, ground="frame", rods=[{"between": ["coupler", "lever"], "at": [[0, 0, 0]]}])
    braced = net(
        WATT, rods=[{"name": "brace", "between": ["coupler", "lever"], "at": [[50, 60, 0], [210, 30, 0]]}]
    )
    assert braced.mobility().finite == 0
    assert math.isclose(braced.size, braced.length)


def test_constraints_that_repeat_are_told_for_all_cycles_of_a_part_at_once():
    of_watt = repeated_lines(net(WATT), 6)
    assert of_watt == [
        "each of 2 cycles of crank, coupler, rocker, link, lever, frame: a force across the plane and two moments in it"
    ]
    assert repeated_lines(net(WATT), 8)[1:] == ["2 more that repeat the others of their cycles"]
    assert repeated_lines(net(WATT), 5) == ["5 that repeat others"]
    assert repeated_lines(net(WATT), 0) == []
    # two single loops that share the crank and the frame
    two = [
        *WATT[:4],
        pin((-20, -30), "crank", "link"),
        pin((-90, -60), "link", "lever"),
        pin((-80, 0), "lever", "frame"),
    ]
    assert len(repeated_lines(net(two), 6)) == 1
    with sb.language("zh"):
        assert not re.search("cycle|plane|repeat", repeated_lines(net(WATT), 8)[0])
