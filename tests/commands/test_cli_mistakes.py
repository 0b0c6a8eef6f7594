"""What the command line says of mistakes: one message each, exit 2, and nothing written."""

import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar

LISTED = "give the path of a TOML file, or a name that 'sevenbar gallery' lists"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "junk.toml").write_bytes(bytes(range(256)) * 20)
    (tmp_path / "nested.toml").write_text("a = " + "[" * 5_000_000 + "]" * 5_000_000)
    (tmp_path / "deep.toml").write_text("a = " + "[\n" * 30_000)
    (tmp_path / "dotted.toml").write_text(".".join("a" * 900) + " = 1\n")
    (tmp_path / "empty.toml").write_text("")
    (tmp_path / "taken").write_text("a file")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no.toml"], f"no.toml: no such file; {LISTED}"),
        (["Seven-R"], f"Seven-R: no such file; did you mean 'seven_r'? {LISTED}"),
        (["7r"], f"7r: no such file; did you mean 'seven_r'? {LISTED}"),
        (
            ["bricard"],
            "bricard: no such file; did you mean 'bricard_line' or 'bricard_plane' or 'bricard_trihedral'? "
            + LISTED,
        ),
        (["nowhere/rssr"], f"nowhere/rssr: no such file; did you mean 'rssr'? {LISTED}"),
        (["deeep.toml"], f"deeep.toml: no such file; did you mean 'deep.toml'? {LISTED}"),
        (["./empty"], f"empty: no such file; did you mean 'empty.toml'? {LISTED}"),
        (["."], ".: is a folder; give the path of a TOML file in it"),
        (
            ["junk.toml"],
            "junk.toml: not text: byte 128 is not UTF-8; give a TOML file of format 1, or a table (.csv, .xlsx)",
        ),
        (
            ["nested.toml"],
            "nested.toml: larger than 100000 bytes, so it is no linkage file; give a TOML file of format 1",
        ),
        (["deep.toml"], "deep.toml: nested too deep; a linkage file has tables of plain keys only"),
        (
            ["rssr", "--figures", "svg"],
            "--figures: a folder for them is missing; give --out, as in '--out report'",
        ),
        (["rssr", "--samples", "3"], "samples: 3 is not a count; give 4 to 1000000"),
        (
            ["rssr", "--speed", "0 rpm"],
            "speed: '0 rpm' moves nothing; give a finite speed other than 0, as in '10 rad/s'",
        ),
        (
            ["rssr", "--speed", "0"],
            "speed: '0' moves nothing; give a finite speed other than 0, as in '10 rad/s'",
        ),
        (
            ["rssr", "--speed", "1e99 rpm"],
            "speed: '1e99 rpm' is out of range; give a speed of 1e-50 to 1e+50 in size, as in '10 rad/s'",
        ),
        (
            ["rssr", "--out", "out", "--figures", ""],
            "--figures: none given; give some of png, svg, pdf, eps, or leave it out",
        ),
        (
            ["rssr", "--out", "out", "--figures", "svg,bmp"],
            "--figures: 'bmp' is not a figure format; give png, svg, pdf or eps",
        ),
        (
            ["rssr", "--out", "taken"],
            "taken: cannot be written: it is a file; give a folder that can be made or written",
        ),
        (
            ["rssr", "--out", "taken/more"],
            "taken/more: cannot be written: taken is a file; give a folder that can be made or written",
        ),
    ],
)
def test_each_mistake_ends_with_its_message_and_exit_2(folder, arguments, message):
    before = sorted(p.name for p in folder.iterdir())
    assert mistake("analyze", *arguments, cwd=folder) == message
    assert sorted(p.name for p in folder.iterdir()) == before


def test_a_name_nested_a_thousand_times_is_one_short_message(folder):
    lines = mistake("analyze", "dotted.toml", cwd=folder).splitlines()
    assert lines[1].startswith("sevenbar: dotted.toml: a: is not known here; ")
    assert all(len(line) < 300 for line in lines)


@pytest.mark.parametrize(
    ("content", "messages"),
    [
        (
            "format = 1\n[rssr]\nM = 700 mm\n",
            [
                "line 3: 'M = 700 mm' is not valid TOML: expected newline or end of document after a statement; "
                "write a number without its unit, which length_unit and angle_unit give for the whole file, "
                'or both in quotes, as in "25 cm"'
            ],
        ),
        (
            "format = 1\n[rssr]\nM = 0,5\n",
            [
                "line 3: 'M = 0,5' is not valid TOML: expected newline or end of document after a statement; "
                "write a decimal point, as in 0.5"
            ],
        ),
        (
            "format = 1\nname = Bench\n",
            [
                "line 2: 'name = Bench' is not valid TOML: invalid value; write a text in quotes, as in kind = \"R\""
            ],
        ),
        (
            "format: 1\n",
            [
                "line 1: 'format: 1' is not valid TOML: expected '=' after a key in a key/value pair; "
                "write a key and its value with '=', as in M = 700"
            ],
        ),
        (
            "format = 1\n[rssr\nM = 7\n",
            [
                "line 2: '[rssr' is not valid TOML: expected ']' at the end of a table declaration; "
                "close the head of a table, as in [rssr] or [[joint]]"
            ],
        ),
        ("[rssr]\nM = 7\n[rssr]\n", ["line 3: '[rssr]' stands twice; leave one of them out"]),
        (
            'name = """\n',
            [
                "not valid TOML: unterminated string, at the end of the file; 'sevenbar gallery rssr' prints a file that is right"
            ],
        ),
        ("", ["is empty; begin with a linkage of the gallery, as in 'sevenbar gallery rssr > mine.toml'"]),
        (
            "# nothing yet\n",
            ["is empty; begin with a linkage of the gallery, as in 'sevenbar gallery rssr > mine.toml'"],
        ),
        (
            "linkage = 'rssr'\n[free]\nL1 = '200:300'\n[[want]]\nkind = 'function'\n",
            ["is a design task and not a linkage; 'sevenbar design task' takes it"],
        ),
        (
            "format = 1\nM = 700\nspeed = 3\ntwist = 80\n",
            [
                "M: is a key of [rssr]; write it below that head",
                "speed: is a key of [drive]; write it below that head",
                "twist: is a key of [[link]]; write it below that head",
                "no linkage is described; give one of [rssr], [[joint]], [[pin]] or [[link]]",
            ],
        ),
        (
            "[rssr]\nM = 1\nN = 1\nL1 = 1\nL3 = 1\nD = 0\nformat = 1\n",
            [
                "format: is missing; give format = 1",
                "rssr.format: is a key of the whole file; write it above the first table",
            ],
        ),
        (
            'format = 1\n[[joint]]\nkind = "Revolute"\nat = [0, 0, 0]\n[[joint]]\nkind = "ball joint"\nat = [0, 0, 0]\n',
            [
                "joint[1].kind: 'Revolute' is not a joint kind; did you mean 'R'? allowed: R, P, H, C, U, S, E, K, L",
                "joint[2].kind: 'ball joint' is not a joint kind; did you mean 'S'? allowed: R, P, H, C, U, S, E, K, L",
            ],
        ),
        (
            'format = 1\n[[link]]\njoint = "spherical"\n[[link]]\njoint = "prismatic"\n[[link]]\n',
            [
                "link[1].joint: 'spherical' takes more than one row; "
                "write R, R and R through one point, or draw the loop as [[joint]]",
                "link[2].joint: 'prismatic' is not a joint kind; did you mean 'P'? allowed: R, P, H",
            ],
        ),
        (
            'format = 1\n[drive]\njoint = "b"\n' + "[[link]]\nname = 'a'\n" * 3 + "[[link]]\nname = 'c'\n",
            [
                "link[2].name: 'a' is taken already; give each joint its own name",
                "link[3].name: 'a' is taken already; give each joint its own name",
                "drive.joint: no joint 'b'; this linkage has a, c",
            ],
        ),
        (
            'format = 1\n[drive]\njoint = "a"\noutput = "a"\n'
            + "".join(f"[[link]]\nname = '{name}'\n" for name in "abbc"),
            [
                "link[3].name: 'b' is taken already; give each joint its own name",
                "drive.output: joint 'a' is the input; give another: b, c",
            ],
        ),
    ],
)
def test_a_slip_in_a_file_is_told_with_what_to_write_instead(tmp_path, content, messages):
    (tmp_path / "f.toml").write_text(content)
    told = mistake("analyze", "f.toml", cwd=tmp_path).replace("sevenbar: ", "").splitlines()
    assert told == [f"f.toml: {message}" for message in messages]


def test_nothing_where_a_choice_should_stand_is_no_choice(tmp_path):
    for arguments, told in (
        (["plot", "rssr", "--out", "p", "--kind", ""], "--kind: none given; give some of curves, joints, "),
        (["sweep", "rssr", "--over", "L1=1,2", "--resume"], "--resume: of no folder; give --out too"),
        (["sweep", "rssr", "--over", "L1=1,2", "--mixed"], "--mixed: of no folder; give --out too"),
        (["gallery", ""], "'': no such linkage; 'sevenbar gallery' lists all"),
    ):
        assert mistake(*arguments, cwd=tmp_path).startswith(told)
    assert list(tmp_path.iterdir()) == []


def test_a_linkage_in_the_place_of_a_command_is_told_what_is_missing(tmp_path):
    for word in ("rssr", "mine.toml"):
        assert mistake(word, cwd=tmp_path) == (
            f"{word}: is a linkage, where a command should stand; give: sevenbar analyze {word}"
        )


def test_the_file_of_a_linkage_of_the_gallery_is_printed_to_begin_with(tmp_path):
    for name in ("rssr", "seven_r"):
        (tmp_path / "mine.toml").write_text(sevenbar("gallery", name).stdout)
        assert sb.load(tmp_path / "mine.toml").name == sb.load(name).name
    assert mistake("gallery", "Sarus") == (
        "Sarus: no such linkage; did you mean 'sarrus'? 'sevenbar gallery' lists all"
    )


def test_words_that_the_command_line_does_not_know_end_with_exit_2():
    assert sevenbar("analyze", "rssr", "--samples", "many").returncode == 2
    assert sevenbar("analyse", "rssr").returncode == 2
    assert sevenbar("analyze").returncode == 2


def test_a_figure_in_a_place_that_cannot_be_written_leaves_nothing(folder):
    before = sorted(p.name for p in folder.iterdir())
    for place in ("taken/move.gif", "nowhere/move.gif", "out/below/move.gif", "move.avi", "out/move.avi"):
        message = mistake("analyze", "rssr", "--out", "out", "--animate", place, cwd=folder)
        assert place in message or "avi" in message
    assert sorted(p.name for p in folder.iterdir()) == before


def test_a_length_that_is_lost_beside_the_others_is_the_callers_mistake(tmp_path):
    (tmp_path / "thin.toml").write_text("format = 1\n[rssr]\nM = 700\nN = 700\nL1 = 1e-50\nL3 = 550\nD = 0\n")
    assert mistake("analyze", "thin.toml", cwd=tmp_path) == (
        "linkage: link 1: its two joints coincide, so it has no length; "
        "give it one that is not lost beside the others"
    )


@pytest.mark.parametrize(
    "call",
    [
        ("forces", "rssr_press", "--counterweights", ""),
        ("forces", "rssr_press", "--joint", " , ", "--out", "here"),
        ("tolerance", "rssr", "--follow", ""),
        ("calibrate", "rssr", "motion.csv", "--hold", ""),
    ],
)
def test_an_option_that_lists_nothing_is_a_mistake(call, tmp_path):
    (tmp_path / "motion.csv").write_text("crank [deg],rocker [deg]\n0,1\n10,2\n20,4\n")
    option = next(word for word in call if word.startswith("--"))
    call = [str(tmp_path / word) if word == "motion.csv" else word for word in call]
    assert mistake(*call) == f"{option}: is empty; give what it lists, or leave it out"
