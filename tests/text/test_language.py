"""Reports and figures in Chinese: every sentence has its translation, and no English one is left."""

import ast
import json
import re
import string
import tomllib
import warnings
from functools import cache
from itertools import product

import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from places import PACKAGE, ROOT
from sevenbar import gallery
from sevenbar.description.draft import Draft
from sevenbar.drawing import fonts
from sevenbar.drawing.style import styled
from sevenbar.errors import MissingFontWarning, RequestError
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.kinematics.measures import MEASURES
from sevenbar.reporting import facts, how_found
from sevenbar.text import words
from sevenbar.text.words import catalogue, language, say

#: What a report has in letters of ours: symbols, units, kinds of joints, words of the paper's formula.
LEFT = {"K", "max", "min", "mm", "rpm", "rad", "deg", "s", "l", "p", "q", "e", "x", "y", "z", "br", *KINDS}
#: Units of forces, and the command that reports them.
LEFT |= {"N", "m", "kg", "W", "J", "sevenbar", "forces"}


@cache
def sentences():
    """Each sentence that a `say` of the package has, with its file."""
    found = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            called = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "say"
            if called and isinstance(node.args[0], ast.Constant):
                found.setdefault(node.args[0].value, file.name)
    return found


def places(sentence):
    return {(name, spec) for _, name, spec, _ in string.Formatter().parse(sentence) if name is not None}


def test_every_sentence_has_its_translation():
    known = catalogue("zh")
    assert len(sentences()) > 200
    assert [f"{file}: {text}" for text, file in sentences().items() if text not in known] == []


def test_every_word_that_is_put_into_a_sentence_has_one():
    ends = ("crank", "rocker", "slider", "spindle")
    types = {f"double-{a}" if a == b else f"{a}-{b}" for a, b in product(ends, ends)}
    types |= {"change-point", "mixed", "rigid", "not-followed", "two-inputs", "cannot-assemble"}
    tables = [
        types, facts.COMPLETE, facts.COMPLETE.values(), how_found._MODES.values(), how_found._UNCOUNTED.values(),
        [kind.legend for kind in KINDS.values()], [measure.title for measure in MEASURES.values()],
        ["angle", "position", "velocity", "acceleration", "change point"],
    ]  # fmt: skip
    assert [word for table in tables for word in table if word not in catalogue("zh")] == []


def test_the_catalogue_has_no_sentence_that_nobody_says():
    """Those of tables are said by their tables; all others stand in a `say`."""
    parts = tomllib.loads((PACKAGE / "text" / "words_zh.toml").read_text(encoding="utf-8"))
    source = "\n".join(file.read_text(encoding="utf-8") for file in PACKAGE.rglob("*.py"))
    said = sentences()
    written = re.sub(r'"\s*\n\s*f?"', "", source)
    made = {measure.title for measure in MEASURES.values()}
    unused = [
        text
        for name, part in parts.items()
        if name not in ("words", words.MADE_BEFORE)
        for text in part
        if text not in said and text not in made and f'"{escaped(text)}"' not in written
    ]
    assert unused == []


def escaped(text):
    return text.replace("\n", "\\n")


def test_a_sentence_is_given_in_one_part_only():
    parts = tomllib.loads((PACKAGE / "text" / "words_zh.toml").read_text(encoding="utf-8"))
    every = [text for name, part in parts.items() if name != words.MADE_BEFORE for text in part]
    assert len(every) == len(set(every))


def test_a_translation_fills_no_place_that_the_sentence_has_not():
    for text, translation in catalogue("zh").items():
        # the angle between the limit positions is told in Chinese only
        allowed = places(text) | ({("between", "")} if text == "{ratio}" else set())
        assert places(translation) <= allowed, text
        assert translation.strip(), text


def report_of(name):
    motion = sb.load(name).motion(36)
    with language("zh"):
        return motion, sb.report.markdown(motion)


def english(motion, text):
    """Words of a report that are neither names of the file nor symbols."""
    linkage = motion.linkage
    names = [linkage.heading, *linkage.columns, *(joint.name for joint in linkage.joints)]
    names += [point.name for point in linkage.points]
    for name in sorted({*names, *linkage.dimensions}, key=len, reverse=True):
        text = text.replace(name, "").replace(name.replace("_", r"\_"), "")
    return [word for word in re.findall(r"[A-Za-z]+", text) if word not in {*LEFT, linkage.length_unit}]


@pytest.mark.parametrize("name", gallery.loops())
def test_no_english_is_left_in_a_chinese_report_of_the_gallery(name):
    motion, text = report_of(name)
    assert english(motion, text) == []
    # and it was there before
    assert len(english(motion, sb.report.markdown(motion))) > 30


ODD = {
    "rounded": lambda: sb.from_dh("RRRR", length=[50, 98.48] * 2, twist=["30 deg", "100 deg"] * 2).motion(24),
    "agreeing": lambda: sb.from_dh("RRRR", length=[50, 98.48] * 2, twist=["30 deg", "100 deg"] * 2).motion(
        24, agree=1e-5
    ),
    "two inputs": lambda: sb.from_dh("R" * 8, length=[10.0] * 8, twist=[1.0] * 8).motion(24),
    "change point": lambda: sb.four_bar(100, 60, 100, 60).motion(24),
    "not to be assembled": lambda: sb.rssr(M=700, N=700, L1=250, L2=10, L3=550, D=0).motion(24),
    "radians?": lambda: sb.loads(
        "format = 1\n"
        + "".join(f"[[link]]\nlength = 1\ntwist = {x}\n" for x in (1.5, 2, 1, 0.5, 1.2, 1.4, 0.7))
    ).motion(24),
    "a law": lambda: sb.load("rssr").motion(law=sb.Law.of([0.0, 1.0, 2.0], [0.0, 0.5, 1.0], 0.5, 0.0)),
}


@pytest.mark.filterwarnings("ignore::sevenbar.errors.AngleUnitWarning")
@pytest.mark.parametrize("name", ODD)
def test_no_english_is_left_in_reports_of_what_does_not_simply_move(name):
    motion = ODD[name]()
    with language("zh"):
        text = sb.report.markdown(motion)
    assert [word for word in english(motion, text) if word not in ("agree",)] == []


@pytest.mark.usefixtures("chinese_font")
def test_programs_read_english_whatever_is_spoken(tmp_path):
    motion = sb.load("rssr").motion(24)
    before = sb.report.as_json(motion), repr(motion)
    with language("zh"):
        report = sb.report.motion_report()
        assert (report.json(motion), repr(motion)) == before
        sb.report.write(motion, tmp_path, [])
    assert (tmp_path / "report.json").read_text(encoding="utf-8") == before[0] + "\n"
    assert "曲柄摇杆机构" in (tmp_path / "report.md").read_text(encoding="utf-8")
    assert (tmp_path / "motion.csv").read_text(encoding="utf-8").isascii()


def test_the_language_ends_with_its_block():
    with language("zh"):
        assert say("circuit {number}", number=3) == "回路 3"
        with language("en"):
            assert say("circuit {number}", number=3) == "circuit 3"
        with language(None):
            assert say("circuit {number}", number=3) == "回路 3"
    assert say("circuit {number}", number=3) == "circuit 3"
    with pytest.raises(RequestError, match=r"^language: 'fr' is not offered; give en \(English\) or zh"):
        language("fr").__enter__()


def test_the_command_speaks_it_and_json_does_not():
    told = sevenbar("analyze", "rssr", "--samples", 24, "--lang", "zh").stdout
    assert "运动型式" in told
    assert "传动角 γ 最小" in told
    assert "极位夹角" in told
    assert "motion type" in sevenbar("analyze", "rssr", "--samples", 24).stdout
    found = json.loads(sevenbar("analyze", "rssr", "--samples", 24, "--lang", "zh", "--json").stdout)
    assert found["motion_type"] == "crank-rocker"
    assert "装配模式" in sevenbar("modes", "rssr", "--lang", "zh").stdout
    assert mistake("analyze", "rssr", "--lang", "de").startswith("--lang: 'de' is not offered")


#: What makes a crank-rocker fall.
DROP = """
[forces]
gravity = [0, -9.81, 0]
[[body]]
link = 1
mass = 2
centre = [0, 20, 0]
"""

#: Commands with a report, each with what it may leave in English: names that people type, and other programs'.
COMMANDS = {
    "analyze rssr_press --samples 36": set(),
    "modes planar_4r": set(),
    "forces rssr_press --samples 36": {"work", "ok"},
    "forces engine --samples 36 --unevenness 0.02": {"gas", "ok", "Mx", "My", "Mz", "Fx", "Fy", "Fz"},
    "free DROP --time 1s --from 30deg": set(),
    "compare rssr examples/rssr_table1.csv": {"examples", "rssr", "table", "csv"},
    "compare rssr examples/rssr_bench.csv": {"examples", "rssr", "bench", "csv"},
    "calibrate rssr examples/rssr_bench.csv --hold D --offset input,output": {
        *("examples", "rssr", "bench", "csv", "input", "output", "offset"),
    },
    "tolerance rssr --tolerance L*=0.5mm --tolerance M=1 --samples 36": set(),
    "map rssr --over L1=100:400 --over L3=300:800 --grid 24 --measure transmission_lowest": {
        *("transmission", "lowest"),
    },
    "sweep rssr --over L1=100:400:5 --measure motion_type,swing": {"swing"},
    "design function --y x^2 --x 0:1 --designs 1": {"RSSR"},
    "design swing --swing 60deg --time-ratio 1.2 --designs 1": {"RSSR"},
    "design survey --count 400 --ball-angle 30deg --output-range 0:23.75deg --designs 2": {
        *("RSSR", "M", "N", "L", "D"),
    },
    "design survey --count 400 --swing 60deg --time-ratio 1.3 --motion-type crank-rocker": {
        *("RSSR", "M", "N", "L", "D"),
    },
    "design point rssr --link 2 --box=-200:200,-200:200,-200:200": {"u", "v", "w", "Clarabel", "Solved"},
    "design inertia seven_r --mass P=2.5": set(),
}


@pytest.mark.parametrize("call", COMMANDS)
def test_the_reports_of_all_commands_are_in_chinese(call, tmp_path):
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    drop = tmp_path / "drop.toml"
    drop.write_text(Draft.of_linkage(linkage).toml() + DROP, encoding="utf-8")
    words = [str(drop) if word == "DROP" else word for word in call.split()]
    run = sevenbar(*words, "--lang", "zh", cwd=ROOT)
    assert run.returncode == 0, run.stderr
    name = next((word for word in words if word in gallery.names()), None)
    motion = (sb.load(name) if name else linkage if "free" in call else sb.load("rssr")).motion(12)
    left = [word for word in english(motion, run.stdout) if word not in COMMANDS[call]]
    assert left == []
    assert re.search("[\u4e00-\u9fff]{3}", run.stdout)


def texts_of(figure):
    figure.canvas.draw()
    return " ".join(text.get_text() for text in figure.findobj(match=lambda one: hasattr(one, "get_text")))


@pytest.mark.usefixtures("chinese_font")
@pytest.mark.parametrize("kind", ["curves", "configuration", "transmission", "joints", "axodes"])
def test_a_figure_has_no_english_and_every_character(kind):
    motion = sb.load("planar_4r").motion(24)
    with language("zh"), warnings.catch_warnings():
        # of a character that no font has
        warnings.simplefilter("error")
        texts = texts_of(getattr(sb.plot, kind)(motion, title=False))
    assert english(motion, texts) == []
    assert re.search("[\u4e00-\u9fff]", texts)


@pytest.mark.usefixtures("chinese_font")
@pytest.mark.parametrize("kind", ["torque", "reactions", "bearings", "shaking", "energies"])
def test_a_figure_of_forces_has_no_english(kind):
    motion = sb.load("rssr_press").motion(24)
    with language("zh"):
        texts = texts_of(motion[0].forces().plot(kind=kind, title=False))
    assert [word for word in english(motion, texts) if word not in ("W", "J", "Fx", "Fy", "Fz")] == []


def test_without_a_font_figures_are_in_english_and_one_warning_says_why(monkeypatch):
    monkeypatch.setattr(fonts, "_installed", lambda: None)
    motion = sb.load("planar_4r").motion(24)
    with language("zh"):
        with pytest.warns(MissingFontWarning, match="figures are in English; install one"):
            figure = sb.plot.curves(motion)
        assert "运动型式" in sb.report.markdown(motion)
    assert figure.axes[0].get_ylabel() == "θ₄ [deg]"
    assert "circuit 0" in texts_of(figure)


def test_a_font_is_found_by_its_name_and_taken_with_the_style(monkeypatch):
    from matplotlib import rcParams

    monkeypatch.setattr(fonts, "_installed", lambda: "SimHei")
    with language("zh"), styled("paper"):
        assert "SimHei" in rcParams["font.family"]
    with styled("paper"):
        assert "SimHei" not in rcParams["font.family"]
