"""Wrong nets as people type them into files, tables, commands and Python: each has one message and leaves no file."""

from __future__ import annotations

import re

import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.errors import SevenbarError

KINDS = "R, P, H, C, U, S, E, K, L"

#: A planar net of seven pins as a table.
PINS = """name,x [mm],y [mm],links,input
crank,0,0,frame crank,60 rpm
,10,40,crank coupler,
,110,80,coupler rocker,
rocker,100,0,frame rocker,
,150,60,rocker link,
,220,70,link lever,
lever,200,0,frame lever,
"""

#: A double wishbone with a track rod and a point as a table.
JOINTS = """name,kind,x,y,z,x 2,y 2,z 2,axis x,axis y,axis z,between,link,input
lower,R,0,0,0,,,,1,0,0,frame; lower arm,,x
upper,R,0,50,200,,,,1,0.1,0,frame; upper arm,,
foot,S,0,350,-20,,,,,,,lower arm; upright,,
head,S,10,300,210,,,,,,,upper arm; upright,,
track rod,rod,120,60,80,110,340,90,,,,frame; upright,,
wheel,point,0,400,90,,,,,,,,upright,
"""


def but(text, *changes):
    """A text with other words in it, each in one place."""
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def said(folder, name, text, *words, command="analyze"):
    """The one line that a command says of a file, which remains alone in its folder."""
    (folder / name).write_text(text, encoding="utf-8")
    message = mistake(command, name, *words, cwd=folder)
    assert [file.name for file in folder.iterdir()] == [name]
    assert len(message.splitlines()) == 1
    return message


NO_LINKS = "\n".join(",".join(line.split(",")[:3]) for line in PINS.splitlines())
NOT_A_JOINT = "is marked and no joint; mark the input in a joint's row"
OTHER_END = "line 6: is a rod without its other end; give it in columns x 2, y 2, z 2"

OF_TABLES = [
    (but(PINS, (",10,40,", ",ten,40,")), "line 3, column 'x [mm]': 'ten': no 'ten' is known; give a length"),
    (but(PINS, (",10,40,", ",,40,")), "line 3, column 'x [mm]': is empty; give a number, 0 where it is none"),
    (but(PINS, (",10,40,", ",,,")), "line 3: columns 'x [mm]', 'y [mm]' are empty; give numbers, 0 where one is none"),
    (but(PINS, (",10,40,", ",inf,40,")), "line 3, column 'x [mm]': 'inf' is no number; give a number, 0 where it is none"),
    (but(PINS, (",10,40,", ',"10,5",40,')), "line 3, column 'x [mm]': '10,5': it has a comma; write a decimal point"),
    (but(PINS, (",10,40,", ",1 kg,40,")), "line 3, column 'x [mm]': '1 kg': 'kg' is not a unit known here"),
    (but(PINS, ("x [mm]", "x [deg]")), "column 'x [deg]': 'deg' is not a unit of lengths; give one like mm"),
    (but(PINS, ("links", "lnks")), "column 'lnks': is not known here; did you mean 'links'?"),
    (but(PINS, ("crank coupler", "crank")), "line 3, column 'links': 'crank' names 1 link; give two or more"),
    (but(PINS, ("crank coupler", "crank-coupler")), "'crank-coupler' names 1 link; give two or more, as in 'frame; crank'"),
    (but(PINS, ("crank coupler", "Crank coupler")), "line 3, column 'links': 'Crank' is written 'crank' elsewhere; give one name"),
    (but(PINS, ("crank coupler", "crank crank")), "line 3, column 'links': ['crank', 'crank'] names a link twice"),
    (but(PINS, (",220,70,link lever,", ",220,70,link lever,x")), "line 7, column 'input': is a second input; mark one row"),
    (but(PINS, ("60 rpm", "60 rmp")), "line 2, column 'input': 'rmp' is not a unit known here; did you mean 'rpm'?"),
    (but(PINS, ("lever,200,0,frame lever,", "lever,200,0,frame lever,\ntotal,790,250,,")), "line 9, column 'links': names no link"),
    (PINS.replace("frame", "chassis"), "name the link that stands still in a column 'ground', one of chassis, crank"),
    (NO_LINKS, f"no kind of joint; give one of {KINDS} in a column 'kind', or pins their links in a column 'links'"),
    (but(PINS, ("links", "link")), "in a column 'kind', or pins their links in a column 'links'"),
    (but(PINS, (",220,70", "name,x [mm],y [mm],links,input\n,220,70")), "line 7: is the header again; leave it out"),
    # a mark or a place that nothing would read
    (but(JOINTS, ("frame; upright,,", "frame; upright,,x"), ("lower arm,,x", "lower arm,,")), f"line 6, column 'input': {NOT_A_JOINT}"),
    (but(JOINTS, ("upright,\n", "upright,x\n")), f"line 7, column 'input': {NOT_A_JOINT}"),
    (but(JOINTS, ("lower,R,0,0,0,,,", "lower,R,0,0,0,5,5,5")), "line 2: is a joint with two places; leave x 2, y 2, z 2 empty, or give it the kind rod"),
    (but(JOINTS, ("110,340,90", ",,")), OTHER_END),
    (but(JOINTS, ("x 2,y 2,z 2", "q,w,e")), OTHER_END),
    (but(JOINTS, ("110,340,90", "120,60,80")), "line 6, columns 'x 2', 'y 2', 'z 2': its two ends are one place; give joint S there"),
    (but(JOINTS, (",1,0,0,frame", ",1,,,frame")), "line 2: columns 'axis y', 'axis z' are empty; give numbers, 0 where one is none"),
    (but(JOINTS, (",1,0,0,frame", ",,,,frame")), "line 2: no axis; a joint of kind R needs one, in columns axis x, axis y, axis z"),
    (but(JOINTS, ("frame; lower arm", "frame lower arm")), "line 2, column 'between': 'frame lower arm' names 3 links; give two"),
    (but(JOINTS, ("frame; lower arm", "frame; frame")), "line 2, column 'between': 'frame' is joined to itself; give two links"),
    (but(JOINTS, (",,,,,,,upright,\n", ",,,,,,,uprigt,\n")), "line 7, column 'link': no link 'uprigt'; did you mean 'upright'?"),
    (but(JOINTS, ("upright,,\nhead", "upright,,x\nhead"), ("lower arm,,x", "lower arm,,")), "line 4, column 'input': joint 'foot' is a ball"),
]  # fmt: skip


def test_cells_past_the_header_are_in_the_note(tmp_path):
    (tmp_path / "net.csv").write_text(but(PINS, (",220,70,link lever,", ",220,70,link lever,,,9")))
    run = sevenbar("modes", "net.csv", cwd=tmp_path)
    assert "not read: cells past the header in line 7" in run.stderr


@pytest.mark.parametrize(("text", "message"), OF_TABLES)
def test_a_wrong_table_has_one_message_with_its_line(tmp_path, text, message):
    assert message in said(tmp_path, "net.csv", text)


#: The same two nets as files.
WATT = """format = 1
ground = "frame"
[drive]
joint = "crank"
[[pin]]
name = "crank"
at = [0, 0]
links = ["frame", "crank"]
[[pin]]
at = [10, 40]
links = ["crank", "coupler"]
[[pin]]
at = [110, 80]
links = ["coupler", "rocker"]
[[pin]]
name = "rocker"
at = [100, 0]
links = ["frame", "rocker"]
[[pin]]
at = [150, 60]
links = ["rocker", "link"]
[[pin]]
at = [220, 70]
links = ["link", "lever"]
[[pin]]
name = "lever"
at = [200, 0]
links = ["frame", "lever"]
"""
FOUR_BAR = """format = 1
ground = "frame"
[[joint]]
kind = "R"
at = [0, 0, 0]
axis = [0, 0, 1]
between = ["frame", "crank"]
[[pin]]
at = [100, 80]
links = ["crank", "coupler"]
[[pin]]
at = [10, 40]
links = ["coupler", "rocker"]
[[pin]]
at = [90, 0]
links = ["frame", "rocker"]
"""
HUB = """format = 1
ground = "frame"
[drive]
joint = "lower"
[[joint]]
name = "lower"
kind = "R"
at = [0, 0, 0]
axis = [1, 0, 0]
between = ["frame", "lower arm"]
[[joint]]
name = "upper"
kind = "R"
at = [0, 50, 200]
axis = [1, 0.1, 0]
between = ["frame", "upper arm"]
[[joint]]
name = "foot"
kind = "S"
at = [0, 350, -20]
between = ["lower arm", "upright"]
[[joint]]
name = "head"
kind = "S"
at = [10, 300, 210]
between = ["upper arm", "upright"]
[[rod]]
name = "track rod"
between = ["frame", "upright"]
at = [[120, 60, 80], [110, 340, 90]]
"""


def pinned(*pins):
    """Watt's six-bar with more pins, each the two coordinates and the links."""
    return WATT + "".join(f"[[pin]]\nat = [{x}, {y}]\nlinks = {links.split()}\n" for x, y, links in pins)


#: With a brace, so that nothing moves; with a chain of four links, so that it has two freedoms; with a triangle.
BRACED = pinned((10, 20, "crank brace"), (60, 10, "frame brace"))
LOOSE = pinned((0, 150, "crank u"), (50, 200, "u v"), (150, 200, "v w"), (200, 150, "w lever"))
STILL = pinned((310, 20, "p q"), (330, 0, "frame q")) + (
    '[[pin]]\nname = "still"\nat = [300, 0]\nlinks = ["frame", "p"]\n'
)


OF_CALLS = [
    # the words of a file and of options are the same
    (HUB, ("analyze", "--input", "track rod"), "--input: 'track rod' is a rod, whose length stays; give a joint: lower, upper"),
    (HUB, ("analyze", "--input", "lower arm"), "--input: 'lower arm' is a link; give one of its joints: lower"),
    (HUB, ("analyze", "--output", "upright"), "output: 'upright' is a link that balls and rods alone hold; give a joint: lower, upper"),
    (HUB, ("modes", "--input", "foot"), "--input: joint 'foot' is a ball; give a joint with one freedom: lower, upper"),
    (HUB, ("analyze", "--output", "wheel"), "output: no joint 'wheel'; this linkage has lower, upper, foot, head"),
    (WATT, ("analyze", "--input", "Crank"), "--input: no joint 'Crank'; did you mean 'crank'?"),
    (WATT, ("modes", "--input", "coupler"), "--input: 'coupler' is a link; give one of its joints: pin_2, pin_3"),
    (WATT, ("analyze", "--input", "lever", "--output", "lever"), "output: joint 'lever' is the input; give another:"),
    (WATT, ("analyze", "--input", "lever", "--input", "crank"), "--input: given 2 times; one joint drives"),
    (WATT, ("analyze", "--speed", "10 mm/s"), "speed: '10 mm/s' is a sliding speed, and the input turns"),
    (WATT, ("plot", "--out", "figures", "--kind", "point", "--link", "levr", "--at", "0,0,0"), "--link: 'levr' is not a link; did you mean 'lever'? give crank, coupler"),
    (WATT, ("plot", "--out", "figures", "--kind", "point", "--link", "9", "--at", "0,0,0"), "--link: 9 is not a link; give 1 to 6, the last is the ground"),
    (WATT, ("plot", "--out", "figures", "--kind", "point", "--link", "lever", "--at", "0,0"), "--at: '0,0' is not a place; give three numbers"),
    (WATT, ("plot", "--out", "figures", "--kind", "bends"), "--kind: 'bends' is not a figure; give curves, joints"),
    (WATT, ("axodes", "--link", "lever", "--relative-to", "lever"), "--relative-to: lever is one of --link; give another"),
    (WATT, ("analyze", "--agree", "1e-3"), "agree: 0.001 is of a single loop; of a net redundant constraints agree to 1e-09, so leave it out"),
    (WATT, ("forces",), "net: this linkage has several loops; its freedoms, modes and motion"),
    (WATT, ("export", "--to", "step"), "net: this linkage has several loops; its freedoms, modes and motion"),
    # nets that no one input moves
    (BRACED, ("modes",), "net: motion is found of nets that one input moves; here it has 0 freedoms; leave out a joint or a rod"),
    (LOOSE, ("modes", "--at", "30deg"), "here it has 2 freedoms; join links by more joints or rods"),
    (LOOSE, ("plot", "--out", "figures"), "here it has 2 freedoms; join links by more joints or rods"),
    (LOOSE, ("export", "--to", "csv"), "here it has 2 freedoms; join links by more joints or rods"),
    (LOOSE, ("analyze", "--animate", "film.gif"), "--animate: no one input moves it; leave it out, the report says why"),
    (BRACED, ("analyze", "--output", "levr"), "output: no joint 'levr'; did you mean 'lever'?"),
    (BRACED, ("analyze", "--samples", "-3"), "samples: -3 is not a count; give 4 to 1000000"),
    (BRACED, ("analyze", "--law", "law.csv"), "law.csv: no such file; give the path of a table of an input law"),
    (STILL, ("analyze", "--input", "still"), "input: joint 'still' stands still while others move, so it cannot drive; give another: crank"),
    (but(WATT, ("at = [110, 80]", "at = [10, 40]")), ("analyze",), "give another: pin_2, pin_3; pin_2 and pin_3 are on one axis, so the link between them has no length"),
    (WATT, ("modes", "--out", "modes.foo"), "modes.foo: '.foo' is not a figure format; give .png, .svg, .pdf or .eps"),
    (WATT, ("modes", "--at", "20mm"), "--at: '20mm' is no value of crank, which turns; give 30, 30deg or 0.5rad"),
    (WATT, ("modes", "--at", "nan"), "--at: 'nan' is no value of crank, which turns; give 30, 30deg or 0.5rad"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "call", "message"), OF_CALLS)
def test_a_wrong_call_has_one_message(tmp_path, text, call, message):
    command, *words = call
    assert message in said(tmp_path, "net.toml", text, *words, command=command)


def test_a_link_of_a_net_without_length_is_named(tmp_path):
    (tmp_path / "net.toml").write_text(but(WATT, ("at = [220, 70]", "at = [200, 0]")))
    run = sevenbar("analyze", "net.toml", "--input", "lever", cwd=tmp_path)
    assert "pin_6 and lever are on one axis: link lever has length 0" in " ".join(run.stdout.split())


def test_links_of_a_net_may_be_given_by_name(tmp_path):
    (tmp_path / "net.toml").write_text(WATT)
    by_name, by_number = (
        sevenbar("axodes", "net.toml", "--link", link, "--relative-to", other, cwd=tmp_path)
        for link, other in (("lever", "coupler"), (5, 2))
    )
    assert by_name.returncode == 0
    assert by_name.stdout == by_number.stdout


FOUR = {"x": [0, 1, 5, 6], "y": [0, 4, 5, 0], "links": ["frame a", "a b", "b c", "frame c"]}

OF_PYTHON = [
    # a list for one linkage
    (lambda _: sb.from_pins({"crank": {"at": (0, 0), "links": ["frame", "crank"]}}, ground="frame"), "pins: {'crank': {'at': [0, 0]"),
    (lambda _: sb.from_pins({"at": (0, 0), "links": ("a", "b")}, ground="a"), "is not a list; give one with a mapping for each of the pins"),
    (lambda _: sb.from_axes({"kind": "R", "at": (0, 0, 0)}, ground="a"), "is not a list; give one with a mapping for each of the joints"),
    (lambda _: sb.from_pins("watt.toml"), "pins: watt.toml is a linkage file, no table; give it to sevenbar.load"),
    (lambda _: sb.from_pins(FOUR, rods=3), "rods: 3 is not a list; give one with a mapping for each of the rods"),
    (lambda _: sb.from_pins(FOUR, points="P"), "points: 'P' is not a list; give one with a mapping for each of the points"),
    (lambda _: sb.from_pins(FOUR, ground="wall"), "table: ground: no joint is at a link 'wall'; name the link that stands still"),
    (lambda _: sb.from_pins({"foo": [1, 2], "bar": [1, 2]}), "table: the columns describe no linkage; name them as in"),
    (lambda _: sb.from_pins([{"at": (0, 0, 0), "kind": "R", "between": ["a", "b"]}], ground="a"), "pin[1]: is a joint, with between and a kind; write it as [[joint]]"),
    (lambda _: sb.from_axes([{"at": (0, 0), "links": ["a", "b"]}], ground="a"), "joint[1]: is a pin, with links and no kind; write it as [[pin]]"),
    (lambda _: sb.from_pins([{"at": (0, 0), "links": {"a", "b"}}], ground="a"), "pin[1].links: {'"),
    # questions that a net does not answer
    (lambda net: net.loaded(bodies={1: sb.Body(mass=1, centre=(0, 0, 0))}), "forces, stops, sweeps of dimensions, bodies, engines"),
    (lambda net: net.stopped(ranges={"lever": (0, 1)}), "forces, stops, sweeps of dimensions, bodies, engines"),
    (lambda net: net.agreeing(1e-5), "agree: 1e-05 is of a single loop"),
    (lambda net: net.mobility(agree=1e-5), "agree: 1e-05 is of a single loop"),
    (lambda net: net.circuit([0] * 7, agree=1e-5), "agree: 1e-05 is of a single loop"),
    (lambda net: net.motion(method="closed"), "method: 'closed' is not offered; give auto or general"),
    (lambda net: net.assembly_modes(0, method="closed"), "method: 'closed' is not offered; give auto or general"),
    (lambda net: net.motion(output="coupler"), "output: 'coupler' is a link; give one of its joints: pin_2, pin_3"),
    (lambda net: net.motion(input="cranc"), "input: no joint 'cranc'; did you mean 'crank'?"),
    (lambda net: net.assembly_modes("3 mm"), "theta: '3 mm' is not a number with a unit that fits"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "message"), OF_PYTHON)
def test_a_wrong_question_to_a_net_has_one_message(call, message):
    with pytest.raises(SevenbarError) as caught:
        call(sb.load("watt"))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


OF_FILES = [
    # heads and keys of the whole file
    (WATT.replace("[[pin]]", "[[pins]]"), "pins: is not known here; write [[pin]]"),
    (WATT.replace("[[pin]]", "[[Pin]]"), "Pin: is not known here; write [[pin]]"),
    (WATT.replace("[[pin]]", "[[hinge]]"), "hinge: is not known here; write [[pin]]"),
    (WATT.replace("[[pin]]", "[pin]"), "line 9: '[pin]' stands twice; write [[pin]] before each one"),
    (HUB.replace("[[joint]]", "[[joints]]"), "joints: is not known here; write [[joint]]"),
    (HUB.replace("[[rod]]", "[[bar]]"), "bar: is not known here; write [[rod]]"),
    (HUB.replace("[[rod]]", "[[rods]]"), "rods: is not known here; write [[rod]]"),
    (but(WATT, ("[drive]", "[[drive]]")), "drive: [{'joint': 'crank'}] is a list; write [drive], once"),
    (but(WATT, ('[drive]\njoint = "crank"', 'drive = "crank"')), "drive: 'crank' is not a table; give keys with values"),
    (but(WATT, ('ground = "frame"', 'ground = frame')), "line 2: 'ground = frame' is not valid TOML: invalid value; write a text in quotes"),
    (but(WATT, ('ground = "frame"\n', ""), ('joint = "crank"', 'joint = "crank"\nground = "frame"')), "drive.ground: is a key of the whole file; write it above the first table"),
    (but(WATT, ('ground = "frame"', "ground = true")), "ground: True is not the name of a link"),
    (but(WATT, ('ground = "frame"', 'ground = "FRAME"')), "ground: no joint is at a link 'FRAME'; did you mean 'frame'?"),
    (but(WATT, ('ground = "frame"', 'ground = "frame"\ninput = "crank"')), "input: is not known here; the input is the joint of [drive]"),
    (but(WATT, ('joint = "crank"', 'joint = "crank"\nrange = [0, 90]')), "drive.range: is not known here; allowed: speed, joint, output"),
    (but(WATT, ('joint = "crank"', 'joint = "crank"\nspeed = "60 rmp"')), "drive.speed: 'rmp' is not a unit known here; did you mean 'rpm'?"),
    (but(WATT, ('joint = "crank"', 'joint = ""')), "drive.joint: '' is not a name; give printable text in quotes"),
    (but(WATT, ('joint = "crank"', 'joint = "Crank"')), "drive.joint: no joint 'Crank'; did you mean 'crank'?"),
    (but(WATT, ('["link", "lever"]', '["link", lever]')), "line 24: 'links = [\"link\", lever]' is not valid TOML: invalid value; write each text in quotes"),
    (but(WATT, ("[10, 40]", "[10, 40")), "line 10: 'at = [10, 40' is not valid TOML: unclosed array; close the list with ]"),
    (but(WATT, ("[10, 40]", "[10 40]")), "line 10: 'at = [10 40]' is not valid TOML: unclosed array; write a comma between numbers"),
    (WATT.replace("[[pin]]", "[[pin]", 1), "line 5: '[[pin]' is not valid TOML: expected ']]' at the end of an array declaration; close the head of a table"),
    (but(WATT, ("[10, 40]", "[10,5, 40]")), "pin[2].at: [10, 5, 40] is not a place; give x and y, as in [40, 0]"),
    (re.sub(r"\[\[joint\]\]\nname = (.*)", r"[joint.\1]", HUB), "is no list; write [[joint]]"),
    (HUB.replace("[[rod]]", "[rod]"), "does not fit here; write [[rod]] before each one"),
    (but(WATT, ('joint = "crank"', 'joint = "m"'), ('["rocker", "link"]', '["rocker", "link", "x"]\nname = "m"')) + '[[pin]]\nat = [300, 0]\nlinks = ["x", "frame"]\n', "drive.joint: no joint 'm'; did you mean 'm.1'?"),
    # one mistake in several keys or places is one message
    (WATT.replace('"coupler"', '"co\\nupler"', 1), "pin[2].links: 'co\\nupler' is not the name of a link; give printable text in quotes, at most 200 characters"),
    (WATT.replace('"coupler"', '"' + "x" * 201 + '"', 1), "is not the name of a link; give printable text in quotes, at most 200 characters"),
    (but(WATT, ('name = "crank"', 'name = "  "')), "pin[1].name: '  ' is not a name; give printable text in quotes"),
    (but(WATT, ("at = [10, 40]", "x = 10\ny = 40")), "pin[2].at: is missing; give x and y, as in [40, 0]; not known here: x, y"),
    (but(WATT, ('links = ["crank", "coupler"]', 'link = ["crank", "coupler"]')), "pin[2].links: is missing; give the names of two or more, as in [\"frame\", \"crank\"]; not known here: link"),
    (but(HUB, ('between = ["frame", "lower arm"]', 'betwen = ["frame", "lower arm"]')), "joint[1].between: is missing; where one joint says which two links it is between, all do; not known here: betwen"),
    (but(FOUR_BAR, ("at = [10, 40]", 'at = [10, 40]\ncolour = "red"')), "pin[2].colour: is not known here; allowed: at, links, name"),
    (but(FOUR_BAR, ("at = [10, 40]", "at = [10, 40]\naxis = [0, 0, 1]")), "pin[2].axis: is not of a pin, a hinge about z"),
    # it may be one loop, except for the slip
    (but(FOUR_BAR, ('"frame", "rocker"', '"frame", "rockr"'), ('kind = "R"', 'kind = "R"\nlonger = 2')), "pin[3].links: 'rockr' is named only here, and 'rocker' only at pin[2]; give them one name, or each another joint"),
    (but(WATT, ('links = ["crank", "coupler"]', 'links = "crank-coupler"')), "'crank-coupler' is one text; give the links that turn on the pin, as a list: [\"frame\", \"crank\"]"),
    (but(HUB, ("at = [0, 0, 0]", "x = 0\ny = 0\nz = 0")), "joint[1].at: is missing; needed here: kind, at, between; not known here: x, y, z"),
    (but(HUB, ("at = [[120, 60, 80], [110, 340, 90]]", "from = [120, 60, 80]\nto = [110, 340, 90]")), "rod[1].at: is missing; needed here: between, at; not known here: from, to"),
    (but(HUB, ('between = ["frame", "lower arm"]', 'parent = "frame"\nchild = "lower arm"')), "joint[1].between: is missing; a joint has it in place of parent and child, as in between"),
    (but(HUB, ('between = ["frame", "lower arm"]', 'link = "lower arm"')), "joint[1].between: is missing; a joint has it in place of link, as in between"),
    (but(HUB, ('between = ["frame", "lower arm"]', 'between = ["frame", "lower arm"]\nlink = "lower arm"')), "joint[1].link: is not known here; a joint has its links in between"),
    (but(HUB, ('between = ["frame", "upright"]', 'links = ["frame", "upright"]')), "rod[1].between: is missing; a rod has it in place of links"),
    (re.sub(r"between = .*arm.*\n", "", HUB), "joint: do not name their links; each needs between, as in between"),
    (but(HUB, ('name = "foot"\nkind = "S"', 'name = "foot"\nkind = "U"\naxis = [0, 0, 1]')), "joint[3].axis: does not belong to a joint of kind U; give its axes, as in axes = [[1, 0, 0], [0, 1, 0]]"),
    (but(HUB, ('name = "foot"\nkind = "S"', 'name = "foot"\nkind = "E"\naxes = [[0, 0, 1], [1, 0, 0]]')), "joint[3].axes: does not belong to a joint of kind E; give its axis, as in axis = [0, 0, 1]"),
    (WATT + "[[point]]\n", "point[1].name: is missing; needed here: name, link, at"),
    (WATT.partition("[[pin]]")[0], "joint: there is none; give the joints of the linkage"),
    # slips of many digits
    (but(WATT, ("at = [10, 40]", "at = [1e6, 40]")), "pin[2].at: [1000000.0, 40.0, 0.0] is 1e+06 mm from most of the others, and 100 mm is too short to be followed with that"),
    (but(WATT, ("at = [10, 40]", "at = [1e90, 40]")), "pin[2].at: [1e+90, 40.0, 0.0] is 1e+90 mm from most of the others"),
    (but(HUB, ("at = [10, 300, 210]", "at = [1e12, 300, 210]")), "joint[4].at: [1000000000000.0, 300.0, 210.0] is 1e+12 mm from most of the others"),
    (but(HUB, ("[110, 340, 90]", "[120, 60, 1e9]")), "rod[1].at: [120.0, 60.0, 1000000000.0] is 1e+09 mm from most of the others"),
    (but(HUB, ("[110, 340, 90]", "[120, 60, 80.00000000001]")), "rod[1].at: its two ends are one place; give joint S there"),
    (WATT + '[[point]]\nname = "P"\nlink = 2\nat = [0, 0, 0]\n', "point[1].link: 2 is not the name of a link; give one, as in link = \"crank\""),
    (WATT + '[[rod]]\nlink = "cranc"\nradius = 3\n', "rod[1].link: no link 'cranc'; did you mean 'crank'?"),
    (but(HUB, ('joint = "lower"', 'joint = "lower"\noutput = "upright"')), "drive.output: 'upright' is a link that balls and rods alone hold; give a joint: lower, upper"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), OF_FILES)
def test_a_wrong_file_has_one_message_with_its_place(tmp_path, text, message):
    assert message in said(tmp_path, "net.toml", text)
