"""Wrong nets as people type them: each has one message, with its place, what is wrong and what to do."""

from __future__ import annotations

import copy
import tomllib

import pytest
from test_wrong_nets import HUB as HUB_TEXT

import sevenbar as sb
from sevenbar.description import gallery
from sevenbar.description.forms import from_description
from sevenbar.errors import DescriptionError, NotCoveredError, RequestError, TableError

#: A planar net of seven pins.
WATT = tomllib.loads(gallery.text("watt")) | {"drive": {"joint": "crank"}}

#: A double wishbone with a track rod: two hinges, two balls, a rod.
HUB = tomllib.loads(HUB_TEXT)


def changed(raw, head, place, keys):
    """A net with other keys in one of its tables; those that are `None` are left out."""
    result = copy.deepcopy(raw)
    table = result[head][place - 1]
    table |= keys
    result[head][place - 1] = {key: value for key, value in table.items() if value is not None}
    return result


def pin(place, **keys):
    return changed(WATT, "pin", place, keys)


def joint(place, **keys):
    return changed(HUB, "joint", place, keys)


def rod(**keys):
    return changed(HUB, "rod", 1, keys)


def more(head, *tables):
    return WATT | {head: [*WATT.get(head, []), *tables]}


def rods(*tables):
    return HUB | {"rod": [*HUB["rod"], *tables]}


def without(raw, key):
    return {word: value for word, value in raw.items() if word != key}


POINT = {"name": "P", "link": "lever", "at": [0, 0, 0]}
KINDS = "allowed: R, P, H, C, U, S, E, K, L"
LINKS = "crank, coupler, rocker, link, lever, frame"
OF_GROUND = "name the link that stands still, one of frame, crank, coupler, rocker, link, lever"
EXAMPLE = 'as in ["frame", "crank"]'
LOOSE = "a link needs two joints, or a joint and a rod"
TAKEN = "give each joint and rod its own name"
ONE_LOOP = "describes one loop; a net has [[joint]] with between, [[pin]] and [[rod]]; leave it out"
SINGLE = "is of a single loop so far; leave it out"
DRIVEN = "is not covered: the input is a joint; give drive.joint"
PINNED = "is not of a pin, a hinge about z; write other joints as [[joint]] with between"
JOINTS = "this linkage has lower, upper, foot, head"
TURNING = "'10 mm/s' is a sliding speed, and the input turns; give a number and a unit, as in '10 rad/s' or '60 rpm'"
UNITS = "is not a unit known here; "
ON_PIN = f"give the links that turn on the pin, {EXAMPLE}"

OF_LINKS = [
    # names of links
    (pin(3, links=["coupler", "rockr"]), f"pin[3].links: 'rockr' is named only here; did you mean 'rocker'? {LOOSE}"),
    (pin(7, links=["lever", "wall"]), f"pin[7].links: 'wall' is named only here; {LOOSE}"),
    (pin(3, links=["coupler", "Rocker"]), "pin[3].links: 'Rocker' is written 'rocker' elsewhere; give one name"),
    # a link of two joints: both names stand alone
    (pin(5, links=["rocker", "lnk"]), "pin[6].links: 'link' is named only here, and 'lnk' only at pin[5]; give them one name, or each another joint"),
    (joint(3, between=["lower_arm", "upright"]), "joint[3].between: 'lower_arm' is written 'lower arm' elsewhere; give one name"),
    (pin(3, links=["coupler", ""]), f"pin[3].links: '' is not the name of a link; {ON_PIN}"),
    (pin(3, links=["coupler", 3]), f"pin[3].links: 3 is not the name of a link; {ON_PIN}"),
    (pin(3, links="coupler rocker"), 'pin[3].links: \'coupler rocker\' is one text; give the links that turn on the pin, as a list: ["coupler", "rocker"]'),
    (pin(3, links=[]), f"pin[3].links: [] are no links; {ON_PIN}"),
    (pin(1, links=["frame"]), f"pin[1].links: ['frame'] are no links; give the names of two or more, {EXAMPLE}"),
    (pin(1, links=None), f"pin[1].links: is missing; give the names of two or more, {EXAMPLE}"),
    (pin(1, links=None, between=["frame", "crank"]), 'pin[1].links: is missing; a pin has it in place of between, as in links = ["frame", "crank"]'),
    (pin(1, links=["frame", "crank", "frame"]), "pin[1].links: ['frame', 'crank', 'frame'] names a link twice; give each once"),
    (joint(1, between=["frame", "lower arm", "x"]), f"joint[1].between: ['frame', 'lower arm', 'x'] are not two links; give their names, {EXAMPLE}"),
    (joint(1, between=["frame"]), f"joint[1].between: ['frame'] are not two links; give their names, {EXAMPLE}"),
    (joint(1, between="frame, lower arm"), 'joint[1].between: \'frame, lower arm\' is one text; give two links, one after the other, as a list: ["frame", "lower arm"]'),
    (joint(1, between=[1, 2]), f"joint[1].between: 1 is not the name of a link; give two links, one after the other, {EXAMPLE}"),
    (joint(1, between=["frame", "frame"]), "joint[1].between: 'frame' is joined to itself; give two links"),
    (joint(4, between=None), "joint[4].between: is missing; where one joint says which two links it is between, all do"),
    (joint(1, between=None, links=["frame", "lower arm"]), 'joint[1].between: is missing; a joint has it in place of links, as in between = ["frame", "crank"]'),
    (rod(between=["frame", "wheel"]), f"rod[1].between: 'wheel' is named only here; {LOOSE}"),
    (rod(between=["a", "b", "c"]), f"rod[1].between: ['a', 'b', 'c'] are not two links; give their names, {EXAMPLE}"),
    (rod(between=["upright", "upright"]), "rod[1].between: 'upright' is joined to itself; give two links"),
    (rod(between=None), "rod[1].between: is missing; where one joint says which two links it is between, all do"),
    # the ground
    (without(WATT, "ground"), f"ground: is missing; {OF_GROUND}"),
    (WATT | {"ground": "Frame"}, f"ground: no joint is at a link 'Frame'; did you mean 'frame'? {OF_GROUND}"),
    (WATT | {"ground": "wall"}, f"ground: no joint is at a link 'wall'; {OF_GROUND}"),
    (WATT | {"ground": "pin_2"}, f"ground: no joint is at a link 'pin_2'; {OF_GROUND}"),
    (WATT | {"ground": 3}, 'ground: 3 is not the name of a link; give one, as in ground = "frame"'),
    (WATT | {"ground": ["frame"]}, 'ground: [\'frame\'] is not the name of a link; give one, as in ground = "frame"'),
    (without(pin(7, ground="frame"), "ground"), "pin[7].ground: is a key of the whole file; write it above the first table"),
    # the graph
    (pin(3, links=["coupler", "crank"]), "pin[3].links: coupler and crank are joined twice, by pin_2 and pin_3, 108 apart; leave one out, or name another link"),
    (more("pin", {"at": [10, 40.2], "links": ["crank", "coupler"]}), "pin[8].links: crank and coupler are joined twice, by pin_2 and pin_8, 0.2 apart; leave one out, or name another link"),
    (more("pin", WATT["pin"][1]), "pin[8].links: crank and coupler are joined twice, by pin_2 and pin_8 in one place; leave one out, or name another link"),
    (HUB | {"joint": [*HUB["joint"], {"kind": "P", "at": [0, 0, 0], "axis": [1, 0, 0], "between": ["lower arm", "frame"]}]},
     "joint[5].between: lower arm and frame are joined twice, by lower and theta_5; give one joint with the freedoms that both leave"),
    (more("pin", {"at": [500, 0], "links": ["x", "y"]}, {"at": [510, 0], "links": ["y", "z"]}, {"at": [520, 9], "links": ["z", "x"]}), "ground: x, y, z: nothing joins them to 'frame'"),
    (WATT | {"pin": [{"at": [i, i % 7], "links": [f"a{i}", f"a{i + 1}"]} for i in range(45)], "ground": "a0"}, "pin: 45 joints and rods are not taken; give up to 40"),
    (without(HUB, "joint"), "joint: there is none; give the joints of the linkage"),
    (WATT | {"pin": []}, "joint: there is none; give the joints of the linkage"),
    (WATT | {"pin": {"at": [0, 0]}}, "pin: {'at': [0, 0]} is no list; write [[pin]]"),
    (WATT | {"pin": [3]}, "pin[1]: 3 is not a table; give keys with values"),
    (rods(HUB["rod"][0] | {"name": "other"}), "rod[2]: is rod[1] again; leave one out"),
    (rods({"between": ["upright", "frame"], "at": HUB["rod"][0]["at"][::-1]}), "rod[2]: is rod[1] again; leave one out"),
]  # fmt: skip

OF_NAMES = [
    (joint(2, name="lower"), f"joint[2].name: 'lower' is taken already, by joint[1]; {TAKEN}"),
    (pin(4, name="crank"), f"pin[4].name: 'crank' is taken already, by pin[1]; {TAKEN}"),
    # the name that is written is at fault, not the one that a joint without a name has
    (pin(7, name="pin_2"), f"pin[7].name: 'pin_2' is taken already, by pin[2]; {TAKEN}"),
    (pin(4, name="pin_5"), f"pin[4].name: 'pin_5' is taken already, by pin[5]; {TAKEN}"),
    (rod(name="lower"), f"rod[1].name: 'lower' is taken already, by joint[1]; {TAKEN}"),
    (rods(HUB["rod"][0] | {"at": [[0, 60, 80], [110, 340, 99]]}), f"rod[2].name: 'track rod' is taken already, by rod[1]; {TAKEN}"),
    (HUB | {"joint": [*HUB["joint"][:2], HUB["joint"][2] | {"name": "a"}, HUB["joint"][3] | {"name": "a.2"}]}, f"joint[4].name: 'a.2' is taken already, by joint[3]; {TAKEN}"),
    (pin(2, name=3), "pin[2].name: 3 is not a name; give printable text in quotes, at most 200 characters"),
    (more("point", POINT, POINT), "point[2].name: 'P' is taken already; give each point its own name"),
    (more("point", POINT | {"link": "Lever"}), f"point[1].link: no link 'Lever'; did you mean 'lever'? this linkage has {LINKS}"),
    (more("point", POINT | {"link": 3}), "point[1].link: 3 is not the name of a link; give one, as in link = \"crank\""),
    (more("point", without(POINT, "link")), "point[1].link: is missing; needed here: name, link, at"),
    (more("point", without(POINT, "name")), "point[1].name: is missing; needed here: name, link, at"),
    (HUB | {"point": [POINT | {"link": "track rod"}]}, "point[1].link: 'track rod' is a rod, which takes part with its length alone; give one of lower arm, upper arm, upright, frame"),
    (HUB | {"drive": {"joint": "cranck"}}, f"drive.joint: no joint 'cranck'; {JOINTS}"),
    (HUB | {"drive": {"joint": "track rod"}}, "drive.joint: 'track rod' is a rod, whose length stays; give a joint: lower, upper"),
    (HUB | {"drive": {"joint": "lower arm"}}, "drive.joint: 'lower arm' is a link; give one of its joints: lower"),
    (HUB | {"drive": {"joint": "foot"}}, "drive.joint: joint 'foot' is a ball; give a joint with one freedom: lower, upper"),
    (HUB | {"drive": {"joint": ["lower", "upper"]}},
     "drive.joint: ['lower', 'upper'] are 2 inputs; a linkage has one input here, so give one joint, as in 'lower'; with two inputs lock one of them: leave that joint out"),
    (HUB | {"drive": {"joint": "lower", "output": "lower"}}, "drive.output: joint 'lower' is the input; the output is the other one, upper"),
    (HUB | {"drive": {"joint": "lower", "output": "nix"}}, f"drive.output: no joint 'nix'; {JOINTS}"),
    (HUB | {"drive": {"rod": "track rod"}}, f"drive.rod: {DRIVEN}"),
    (HUB | {"drive": {"point": "P"}}, f"drive.point: {DRIVEN}"),
    (HUB | {"drive": {"speed": "10 mm/s"}}, f"drive.speed: {TURNING}"),
    (HUB | {"drive": {"speed": 0}}, "drive.speed: 0 moves nothing; give a finite speed other than 0, as in '10 rad/s'"),
]  # fmt: skip

OF_VALUES = [
    (pin(1, at=None), "pin[1].at: is missing; give x and y, as in [40, 0]"),
    (pin(1, at=[0, 0, 0]), "pin[1].at: [0, 0, 0] is not a place; give x and y, as in [40, 0]"),
    (pin(1, at=3), "pin[1].at: 3 is not a place; give x and y, as in [40, 0]"),
    (pin(1, at=[float("nan"), 0]), "pin[1].at: nan is not a finite number; give a finite number"),
    (pin(1, at=[1e200, 0]), "pin[1].at: 1e+200 is out of range; give a number up to 1e+100 in size"),
    (pin(1, at=[0, True]), "pin[1].at: True is not a number; give a number"),
    (pin(1, at=["3 deg", 0]), "pin[1].at: '3 deg': is an angle where a length belongs; give a length, as in 250, '25 cm' or '50*sin(30deg)'"),
    (pin(1, kind="R"), f"pin[1].kind: {PINNED}"),
    (pin(1, axis=[0, 0, 1]), f"pin[1].axis: {PINNED}"),
    (pin(1, extra=3), "pin[1].extra: is not known here; allowed: at, links, name"),
    (joint(1, at=[0, 0]), "joint[1].at: [0, 0] is not a point or direction; give three numbers, as in [0, 0, 1]"),
    (joint(1, at=None), "joint[1].at: is missing; needed here: kind, at, between"),
    (joint(1, axis=[0, 0, 0]), "joint[1].axis: [0, 0, 0] has no direction; give three numbers, not all 0"),
    (joint(1, axis=None), "joint[1].axis: is missing; a joint of kind R needs it"),
    (joint(3, axis=[0, 0, 1]), "joint[3].axis: does not belong to a joint of kind S; leave it out"),
    (joint(1, kind="X"), f"joint[1].kind: 'X' is not a joint kind; {KINDS}"),
    (joint(1, kind="hinge"), f"joint[1].kind: 'hinge' is not a joint kind; did you mean 'R'? {KINDS}"),
    (joint(3, kind="rod"), "joint[3].kind: 'rod' is not a joint kind; write [[rod]] with between and its two places at"),
    (joint(1, kind="gear"), f"joint[1].kind: 'gear' is not a joint kind: gears are not covered; give the loop of links alone; {KINDS}"),
    (joint(1, kind=None), "joint[1].kind: is missing; needed here: kind, at, between"),
    (joint(1, kind="H"), "joint[1].pitch: is missing; a joint of kind H needs it"),
    (joint(1, pitch=3), "joint[1].pitch: does not belong to a joint of kind R; leave it out"),
    (joint(3, value=3), "joint[3].value: is of joints R and P; one of kind S reads 0 as drawn, so leave it out"),
    (joint(3, kind="U"), "joint[3].axes: is missing; a joint of kind U needs it"),
    (joint(3, kind="U", axes=[[1, 0, 0], [2, 0, 0]]), "joint[3].axes: [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]] are 0 deg apart; give two axes that cross, as in [[1, 0, 0], [0, 1, 0]]"),
    (joint(3, kind="K", axes=[[1, 0, 0], [1, 1, 0]]), "joint[3].axes: [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]] are 45 deg apart; a slot is square to its pin"),
    (joint(1, longer=3), "joint[1].longer: is of a single loop; draw the link as long as it is"),
    (joint(1, held=3), "joint[1].held: is not covered; to hold a joint give its two links one name"),
    (rod(at=[[1, 2, 3], [1, 2, 3]]), "rod[1].at: its two ends are one place; give joint S there"),
    (rod(at=[[0, 0, 0]]), "rod[1].at: [[0, 0, 0]] are not two places; give that on each link, as in [[0, 0, 0], [100, 0, 0]]"),
    (rod(at=[[1, 2], [3, 4]]), "rod[1].at: [1, 2] is not a point or direction; give three numbers, as in [0, 0, 1]"),
    (rod(at=None), "rod[1].at: is missing; needed here: between, at"),
    (rod(length=300), "rod[1].length: follows from its two places; leave it out"),
    (rod(radius=5), f"rod[1].radius: {SINGLE}"),
    (rods({"link": "upright", "radius": 5}), "rod[2].radius: is of a single loop so far; leave this rod out"),
    # the whole file
    (HUB | {"link": [{"length": 3}]}, f"link: {ONE_LOOP}"),
    (HUB | {"rssr": {"M": 700}}, f"rssr: {ONE_LOOP}"),
    (WATT | {"layout": "planar"}, f"layout: {ONE_LOOP}"),
    (more("body", {"link": "lever", "mass": 1}), f"body: {SINGLE}"),
    (more("spring", {"joint": "lever", "stiffness": 1}), f"spring: {SINGLE}"),
    (more("stop", {"joint": "lever", "range": [0, 1]}), f"stop: {SINGLE}"),
    (WATT | {"forces": {"gravity": [0, 0, -9.8]}}, f"forces: {SINGLE}"),
    (more("tie", {"joint": "lever"}), "tie: is not covered: a net has one input, drive.joint; leave it out"),
    (more("gear", {}), "gear: gears are not covered; give the loop of links alone"),
    (WATT | {"length_unit": "parsec"}, f"length_unit: 'parsec' {UNITS}allowed: um, mm, cm, m, in, ft"),
    (WATT | {"angle_unit": "degrees"}, f"angle_unit: 'degrees' {UNITS}did you mean 'deg'? allowed: rad, deg"),
    (WATT | {"format": 2}, "format: 2 is not a format of this version; give format = 1"),
    (without(WATT, "format"), "format: is missing; give format = 1"),
    (WATT | {"name": 3}, "name: 3 is not a name; give printable text in quotes, at most 200 characters"),
    ({"format": 1, "ground": "frame", "link": [{"length": 1}] * 4}, "ground: is not known here; link 4 is the ground already; leave it out"),
]  # fmt: skip


@pytest.mark.parametrize(("raw", "message"), OF_LINKS + OF_NAMES + OF_VALUES)
def test_a_wrong_net_has_one_message(raw, message):
    with pytest.raises(DescriptionError) as caught:
        from_description(raw)
    assert str(caught.value) == message


def test_there_are_over_a_hundred_wrong_nets_each_another():
    messages = [message for _, message in OF_LINKS + OF_NAMES + OF_VALUES]
    assert len(set(messages)) > 110


def test_mistakes_of_links_and_of_numbers_are_reported_together():
    raw = changed(pin(3, links=["coupler", "rockr"]), "pin", 1, {"at": ["x", 0]}) | {"length_unit": "parsec"}
    with pytest.raises(DescriptionError) as caught:
        from_description(raw)
    assert [problem.place for problem in caught.value.problems] == [
        "pin[3].links",
        "length_unit",
        "pin[1].at",
    ]


def test_names_of_a_kind_are_no_slips_of_each_other():
    # two loose ends
    raw = joint(3, between=["lower arm", "foot 1"])
    raw["joint"][3]["between"] = ["upper arm", "foot 2"]
    raw["rod"] = []
    with pytest.raises(DescriptionError) as caught:
        from_description(raw)
    assert str(caught.value) == (
        f"joint[3].between: 'foot 1' is named only here; {LOOSE}\n"
        f"joint[4].between: 'foot 2' is named only here; {LOOSE}"
    )


def test_blanks_about_names_are_none_of_them():
    raw = pin(3, links=[" coupler", "rocker "]) | {"ground": " frame "}
    assert from_description(raw).link_names == from_description(WATT).link_names


def test_mistakes_of_a_single_loop_have_the_places_of_the_file():
    # the loop's own order is pins 2, 4, 3, 1
    pins = [
        ([100, 70], "coupler", "rocker"),
        ([0, 0], "frame", "crank"),
        ([90, 0], "rocker", "frame"),
        ([10, 40], "crank", "coupler"),
    ]
    raw = {"format": 1, "ground": "frame", "pin": [{"at": at, "links": list(links)} for at, *links in pins]}
    assert from_description(raw).net is None
    cases = [
        (changed(raw, "pin", 3, {"at": [0, 1e200]}), "pin[3].at: 1e+200 is out of range; give a number up to 1e+100 in size"),
        (changed(raw, "pin", 3, {"name": "pin_4"}), f"pin[3].name: 'pin_4' is taken already, by pin[4]; {TAKEN}"),
        (raw | {"point": [POINT]}, "point[1].link: no link 'lever'; this linkage has coupler, rocker, crank, frame"),
        (raw | {"body": [{"link": "cranc", "mass": 1}]}, "body[1].link: no link 'cranc'; did you mean 'crank'? this linkage has coupler, rocker, crank, frame"),
        (raw | {"drive": {"joint": "crank"}}, "drive.joint: 'crank' is a link; give one of its joints: pin_2, pin_4"),
    ]  # fmt: skip
    for wrong, message in cases:
        with pytest.raises(DescriptionError) as caught:
            from_description(wrong)
        assert str(caught.value) == message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('format = 1\n[pin]\nat = [0, 0]\n[pin]\nat = [1, 0]\n', "text: line 4: '[pin]' stands twice; write [[pin]] before each one"),
        ('format = 1\nground = frame\n', "write a text in quotes, as in kind = \"R\""),
        ('format = 1\n[[pin]]\nat = [0, 0]\nlinks = ["frame", crank]\n', "line 4"),
    ],
)  # fmt: skip
def test_a_slip_of_toml_in_a_net_has_its_line(text, message):
    with pytest.raises(DescriptionError) as caught:
        sb.loads(text)
    assert message in str(caught.value)


def test_wrong_arguments_have_their_message():
    calls = [
        (lambda: sb.from_pins(3), "pins: 3 is not a list; give one with a mapping for each of the pins"),
        (lambda: sb.from_pins([], ground="frame"), "joint: there is none; give the joints of the linkage"),
        (lambda: sb.from_pins("nix.csv"), "nix.csv: no such file"),
        (lambda: sb.from_pins({"a [mm]": [1, 2], "alpha [deg]": [30, 40]}), "pins: the table has no pins as drawn; give it to sevenbar.from_table"),
        (lambda: sb.from_pins({"x": [1], "y": [2], "links": ["a b"]}, length_unit="cm"), "length_unit: is given in addition to a table"),
        (lambda: sb.from_axes([], rods=3), "rods: 3 is not a list"),
    ]  # fmt: skip
    for call, message in calls:
        with pytest.raises((DescriptionError, RequestError, TableError)) as caught:
            call()
        assert message in str(caught.value)


def test_a_screw_that_closes_a_loop_of_screws_is_refused():
    places = [
        ([0, 0, 0], "f", "p"),
        ([5, 0, 0], "f", "p2"),
        ([5, 5, 0], "p", "p2"),
        ([9, 5, 0], "p", "q"),
        ([9, 1, 0], "f", "q"),
    ]
    screws = [
        {"kind": "H", "at": at, "axis": [0, 0, 1], "pitch": 3 + i, "between": links}
        for i, (at, *links) in enumerate(places)
    ]
    with pytest.raises(NotCoveredError, match="net: joint 'theta_3' is a screw that closes a loop of screws"):
        sb.from_axes(screws, ground="f").mobility()
