"""What people type first and nearly right: each is taken, or answered with what to write."""

import importlib
import json
import subprocess
import sys

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.reporting.four_bar_text import grashof_text
from sevenbar.reporting.pose_text import stops_text


def test_public_modules_are_imported_by_their_public_names():
    from sevenbar.plot import curves
    from sevenbar.report import markdown

    assert curves is sb.plot.curves
    assert markdown is sb.report.markdown
    for name in ("animate", "gallery", "plot", "report"):
        module = importlib.import_module(f"sevenbar.{name}")
        assert module is getattr(sb, name)
        assert module.__spec__.name == module.__name__
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("sevenbar.plots")


def test_points_of_planar_families_lie_along_their_links():
    motion = sb.slider_crank(
        125, 500, speed="600 rpm", points={"G": (2, (225, 0)), "P": (1, ("5 cm", 3))}
    ).motion()
    pose = motion[0].at("45 deg")
    assert np.allclose(pose.points["G"].position[0, :2], [309.8448, 48.6136], atol=1e-3)
    assert np.linalg.norm(pose.points["G"].velocity) == pytest.approx(6734.937, abs=1e-3)
    assert np.allclose(pose.points["P"].position[0], [47 / 2**0.5, 53 / 2**0.5, 0])
    offset = sb.slider_crank(40, 140, 10, points={"G": (2, (140, 0)), "S": (3, (0, 0))}).motion()[0]
    for name in ("G", "S"):
        assert np.allclose(offset.point(name).position, offset.point("pin").position)
    bar = sb.four_bar(40, 100, 80, 90, points={"C": (2, (50, 30)), "B": (2, (100, 0))}).motion()[0]
    assert np.allclose(bar.point("C").position, bar.point(2, at=(0, 50, 30)).position)
    assert np.allclose(np.linalg.norm(bar.point("B").position - [90, 0, 0], axis=1), 80)


@pytest.mark.parametrize("offset", [0, 40, -40])
def test_two_numbers_are_a_place_along_its_link_in_every_planar_family_and_in_the_file_of_it(offset):
    places = {"A": (1, (20, 5)), "G": (2, (225, 30)), "S": (3, (7, -8))}
    family = sb.slider_crank(125, 500, offset, points=places)
    written = Draft.of_linkage(family).linkage
    turned = sb.from_axes(
        [
            {"kind": "R", "at": (9, 0, 0), "axis": (1, 0, 0)},
            {"kind": "R", "at": (9, 125, 0), "axis": (1, 0, 0)},
            {"kind": "R", "at": (9, 125 + (500**2 - offset**2) ** 0.5, offset), "axis": (1, 0, 0)},
            {"kind": "P", "at": (9, 125 + (500**2 - offset**2) ** 0.5, offset), "axis": (0, 1, 0)},
        ]
    )
    for linkage in (family, written):
        circuit = linkage.motion(24)[0]
        for name, (link, at) in places.items():
            assert np.allclose(circuit.point(link, at).position, circuit.point(name).position, atol=1e-9)
            there, named = circuit.at(0.3).point(link, at).velocity, circuit.at(0.3).points[name].velocity
            assert np.allclose(there, named)
    one, other = family.motion(24)[0], turned.motion(24)[0]
    for link, at in places.values():
        assert np.allclose(
            one.point(link, at).position[:, :2], other.point(link, at).position[:, 1:], atol=1e-9
        )
    bar = sb.four_bar(40, 100, 80, 90).motion(24)[0]
    for link in (1, 2, 3, 4):
        assert np.array_equal(bar.point(link, (50, 30)).position, bar.point(link, (0, 50, 30)).position)


def test_a_place_of_the_drawing_is_refused_of_a_slider_crank_which_has_places_on_its_links():
    circuit = sb.slider_crank(125, 500).motion(24)[0]
    for asked in (circuit, circuit.at(0.3)):
        with pytest.raises(
            RequestError, match=r"at: three numbers would be a place of the drawing here, .* give two"
        ):
            asked.point(2, at=(0, 225, 0))
    # the file of it writes its points in the drawing, as every drawing does
    file = Draft.of_linkage(sb.slider_crank(125, 500)).linkage.motion(24)[0]
    assert np.allclose(file.point(2, (350, 0, 0)).position, circuit.point(2, (225, 0)).position)


@pytest.mark.parametrize(
    ("linkage", "link", "says"),
    [
        (
            lambda: sb.load("rssr"),
            2,
            "at: 2 numbers; give three, as two are a place on a link of turning and sliding joints in a plane",
        ),
        (lambda: sb.load("bennett"), 2, "at: 2 numbers; give three"),
        (lambda: sb.load("planar_4r"), 7, "link: 7 is not a link; give 1 to 4"),
    ],
)
def test_two_numbers_are_no_place_where_there_is_no_plane(linkage, link, says):
    with pytest.raises(RequestError, match=says):
        linkage().motion(24)[0].point(link, (1, 2))


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ((2, 50), r"points.C: \(2, 50\) is no point; give \(link, \(u, v\)\)"),
        ((4, (50, 0)), r"points.C: 4 is not a link; give 1 to 3"),
        ((2, (50, 0, 0)), r"points.C: \(50, 0, 0\) is no place in the plane"),
    ],
)
def test_a_point_that_is_none_is_refused(given, says):
    for family in (sb.four_bar, sb.slider_crank):
        with pytest.raises(RequestError, match=says):
            family(*([2, 3, 4, 4] if family is sb.four_bar else [2, 5]), points={"C": given})


def test_a_dash_in_a_sweep_is_no_range(tmp_path):
    said = mistake("sweep", "rssr", "--over", "L1=100-400", "--measure", "swing", "-o", str(tmp_path / "s"))
    assert said == (
        "over: 'L1=100-400' is 100 less 400; a range is written L1=100..400, or L1=100:400:31 for 31 values of it"
    )
    assert not (tmp_path / "s").exists()


def test_a_map_needs_no_count():
    said = mistake("map", "rssr", "--over", "L1=100:400:61", "--over", "L3=300:800", "--measure", "swing")
    assert said == "over: L1: '100:400:61' has a count, and a map needs none; give 100:400"


@pytest.mark.parametrize(
    ("unit", "meant"),
    [("Hz", "rev/s"), ("U/min", "rpm"), ("1/min", "rpm"), ("min^-1", "rpm"), ("s^-1", "rev/s")],
)
def test_other_words_for_speeds_are_known(unit, meant):
    with pytest.raises(RequestError, match=f"did you mean '{meant}'"):
        sb.load("rssr").motion(speed=f"2 {unit}")


def test_zero_needs_no_unit():
    linkage = sb.from_dh("RRRR", length=[2, 1, 2, 1], twist=["0", "0 deg", "0", "0"], offset=[0] * 4)
    assert linkage.is_planar
    with pytest.raises(RequestError, match=r"'30' has no unit"):
        sb.from_dh("RRRR", length=[2, 1, 2, 1], twist=["30", "0", "0", "0"], offset=[0] * 4)


def test_free_motion_of_nothing_shows_what_to_write():
    assert "[[body]]" in mistake("free", "rssr")
    assert mistake("simulate", "rssr", "--engine", "adams").endswith("as in --to adams")


def test_a_planar_four_bar_has_its_lengths_and_other_loops_none():
    assert sb.four_bar(2, 1, 2, 1).lengths == (2.0, 1.0, 2.0)
    turned = sb.load("planar_4r")
    bar = turned.as_four_bar().links
    assert turned.lengths == (bar["input link"], bar["coupler"], bar["output link"])
    with pytest.raises(sb.errors.NotCoveredError):
        sb.load("seven_r").lengths  # noqa: B018


def test_a_column_that_is_not_read_is_named_where_a_kind_lacks(tmp_path):
    table = tmp_path / "loop.csv"
    rows = [f"{name};R;{x};0;0;0;0;1" for x, name in enumerate("abcd")]
    table.write_text("\n".join(["name;Typ;x [mm];y [mm];z [mm];ax;ay;az", *rows]), encoding="utf-8")
    assert "in a column 'kind', or pins their links in a column 'links'; not read: 'Typ'" in mistake(
        "analyze", str(table)
    )
    for index in ("_(i-1)", " (i-1)", "[i-1]", "_{i-1}"):
        table.write_text(f"a{index},alpha{index},d_i,theta_i\n0,0,0,0\n1,0,0,0\n", encoding="utf-8")
        assert "modified (Craig's) Denavit-Hartenberg rows" in mistake("analyze", str(table))


def test_a_font_that_is_missing_is_said_once_for_all_figures(tmp_path):
    """In a process of its own: what was said is remembered by the program."""
    code = (
        "import sys, sevenbar.drawing.fonts as fonts; fonts._installed = lambda: None;"
        "from sevenbar.commands.cli import main;"
        f"sys.argv = ['sevenbar', 'plot', 'planar_4r', '--lang', 'zh', '-o', {str(tmp_path / 'a')!r}, '--kind', 'curves,joints'];"
        "main()"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert result.returncode == 0
    assert result.stderr.count("no font with Chinese characters") == 1


def test_a_report_spells_the_classes_of_grashof_as_its_motion_types():
    assert grashof_text(sb.four_bar(50, 60, 70, 100).as_four_bar(), "mm").endswith(
        "; triple-rocker: no joint turns fully"
    )
    assert grashof_text(sb.four_bar(50, 90, 50, 90).as_four_bar(), "mm").endswith("; change-point")


@pytest.mark.parametrize("name", ["rssr", "planar_4r", "seven_r"])
def test_one_pose_says_whether_it_lies_beyond_a_stop(name):
    plain = sb.load(name)
    first = plain.drive.joint
    linkage = plain.stopped(ranges={first: ("-10 deg", "60 deg")})
    for circuit in linkage.motion(samples=36):
        for value, beyond in (
            ("0 deg", ""),
            ("60 deg", ""),
            ("61 deg", f"range of {first}"),
            ("-10 deg", ""),
        ):
            pose = circuit.at(value)
            assert pose.stopped_by == beyond
            assert stops_text(pose) == (f"beyond {beyond}" if beyond else "within")
    assert stops_text(plain.motion(samples=36)[0].at("61 deg")) == ""


def test_the_tables_of_poses_have_the_stops(tmp_path):
    (tmp_path / "stops.toml").write_text(
        sb.gallery.text("planar_4r") + '\n[[stop]]\njoint = "theta_1"\nrange = [-10, 60]\n', encoding="utf-8"
    )
    shown = sevenbar("modes", "stops.toml", "--at", "90", cwd=tmp_path).stdout
    assert shown.count("beyond range of theta_1") == 2
    found = json.loads(sevenbar("modes", "stops.toml", "--at", "90", "--json", cwd=tmp_path).stdout)
    assert [mode["stopped_by"] for mode in found["modes"]] == [["range of theta_1"]] * 2
    assert (
        "超出 theta_1 的范围"
        in sevenbar("modes", "stops.toml", "--at", "90", "--lang", "zh", cwd=tmp_path).stdout
    )


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda place: sb.Body(1.0, centre=place), "centre"),
        (lambda place: sb.Load(2, at=place, force=(0, -5, 0)), "at"),
        (lambda place: sb.Spring(links=(4, 2), at=(place, (0, 0, 0)), stiffness=1.0), r"at\[0\]"),
    ],
)
def test_a_place_of_what_acts_is_three_numbers_and_says_whose(make, key):
    with pytest.raises(
        RequestError, match=rf"{key}: 2 numbers; give three, as points are written in files: places"
    ):
        make((225, 0))


def test_the_middle_of_a_rod_is_a_place_of_the_drawing_and_of_a_coupler_half_its_length():
    # docs/conventions.md: a rod is a body whose centre lies there
    for linkage, link, middle in (
        (sb.slider_crank(125, 500), 2, (375, 0, 0)),
        (sb.four_bar(40, 100, 80, 90), 2, (0, 50, 0)),
    ):
        bodies = (sb.Body(1.0, solid="rod"), sb.Body(1.0, centre=middle, solid="point"))
        pulls = [
            linkage.loaded(bodies={link: body}, gravity=(0, -9.8, 0))
            .motion(24, speed="1 rpm")[0]
            .forces(at_rest=True)
            for body in bodies
        ]
        assert np.allclose(pulls[0].torque, pulls[1].torque)


@pytest.mark.parametrize(("before", "place"), [("", "input"), ("[drive]\n", "drive.input")])
def test_who_writes_input_is_told_of_the_drive(tmp_path, before, place):
    file = tmp_path / "four.toml"
    file.write_text(f'format = 1\n{before}input = "crank"\n\n[[joint]]\nkind = "R"\n', encoding="utf-8")
    line = f"{place}: is not known here; the input is the joint of [drive]: write joint = .. below that head"
    assert line in mistake("analyze", file)


@pytest.mark.parametrize(
    "words",
    [
        "plot rssr --kind skeleton --out x.png",
        "analyze rssr --out x.csv",
        "sweep rssr --over L1=30:60:3 --out x.csv",
    ],
)
def test_the_name_of_a_file_is_no_folder(words, tmp_path):
    name = words.split()[-1]
    assert mistake(*words.split(), cwd=tmp_path) == (
        f"{name}: is the name of a file, and --out is a folder here; give one, as in --out x"
    )
    assert not list(tmp_path.iterdir())
    # a folder that is there may have any name
    (tmp_path / name).mkdir()
    assert sevenbar(*words.split(), cwd=tmp_path).returncode == 0
