"""Figures show the linkage as it is: blocks on pins, planes and spheres, far points; panels, styles, films from a command."""

from __future__ import annotations

import itertools
import json
import math
import re
import xml.etree.ElementTree as ET
from html import escape
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from mpl_toolkits.mplot3d import proj3d

import sevenbar as sb
from command_runs import sevenbar
from lettered import SLIDER_CRANK, SPHERICAL
from sevenbar.drawing import plot
from sevenbar.drawing.animate import animate
from sevenbar.drawing.names import amount_text, quantity_label, shown_name
from sevenbar.drawing.skeleton import skeleton
from sevenbar.drawing.space import PANE
from sevenbar.drawing.style import CIRCUIT_COLOURS, COUPLER, GROUND, INPUT, OUTPUT
from sevenbar.drawing.ticks import DegreeLocator, settle
from sevenbar.errors import RequestError

CRANK, ROD = 40.0, 140.0


@pytest.fixture(scope="module")
def slider_crank() -> sb.Motion:
    return sb.from_axes(SLIDER_CRANK, name="Slider-crank").motion(samples=72)


def test_a_block_is_on_its_pin_and_its_rail_on_the_ground(slider_crank: sb.Motion) -> None:
    circuit = slider_crank.circuits[0]
    frame = skeleton(slider_crank, circuit)
    (block,) = [places for _, word, places in frame.marks if word == "block"]
    (rail,) = [places for _, word, places in frame.marks if word == "rail"]
    middle = frame.places[:, list(block)].mean(axis=1)
    # the textbook's formula for the pin, on either circuit: the rod is to the right or to the left of the crank
    angle = np.append(circuit.input, circuit.input[0])
    side = math.copysign(1.0, float(middle[0, 0] - CRANK * math.cos(angle[0])))
    pin = CRANK * np.cos(angle) + side * np.sqrt(ROD**2 - (CRANK * np.sin(angle)) ** 2)
    np.testing.assert_allclose(middle, np.stack([pin, 0 * pin, 0 * pin], axis=1), atol=1e-9)
    ends = frame.places[:, list(rail)]
    assert np.ptp(ends, axis=0).max() == 0
    assert (ends[0, :, 0].min() < pin).all()
    assert (pin < ends[0, :, 0].max()).all()


def test_the_block_of_rssp_moves_with_its_ball() -> None:
    motion = sb.load("rssp").motion(samples=36)
    frame = skeleton(motion, motion.circuits[0])
    (block,) = [places for _, word, places in frame.marks if word == "block"]
    ball = next(places for joint, word, places in frame.marks if joint == 2 and word == "ball")
    apart = frame.places[:, list(block)].mean(axis=1) - frame.places[:, ball[0]]
    assert np.ptp(frame.places[:, ball[0]], axis=0).max() > 1.0
    np.testing.assert_allclose(apart, np.broadcast_to(apart[0], apart.shape), atol=1e-9)


def test_a_planar_loop_is_an_x_y_figure_whose_circles_are_circles() -> None:
    motion = sb.load("planar_4r").motion(samples=72)
    figure = plot.configuration(motion)
    axes: Any = figure.axes[0]
    assert not hasattr(axes, "get_zlim")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("y [mm]", "z [mm]")
    figure.canvas.draw()
    # a length is as many pixels in both directions
    unit = axes.transData.transform([(0, 0), (1, 0), (0, 1)])
    across, up = unit[1, 0] - unit[0, 0], unit[2, 1] - unit[0, 1]
    assert across == pytest.approx(up, rel=1e-3)
    pin = motion.linkage.plane.coordinates(skeleton(motion, motion.circuits[0]).places)[:, 2]
    assert np.isfinite(pin).all()
    in_space = plot.configuration(motion, view="space").axes[0]
    assert hasattr(in_space, "get_zlim")


def test_a_spherical_loop_lies_on_the_sphere_of_its_farthest_point() -> None:
    linkage = sb.from_axes(SPHERICAL, points=[{"name": "P", "link": 2, "at": (60, 40, 30)}])
    motion = linkage.motion(samples=36)
    frame = skeleton(motion, motion.circuits[0])
    radius = math.sqrt(60**2 + 40**2 + 30**2)
    links = np.concatenate([frame.places[:, list(link)] for link in frame.polylines], axis=1)
    np.testing.assert_allclose(np.linalg.norm(links, axis=2), radius, rtol=1e-9)
    entries = [text.get_text() for text in plot.configuration(motion).legends[0].get_texts()]
    assert "sphere, radius 78.1 mm" in entries


def test_the_box_of_a_tall_linkage_is_whole() -> None:
    linkage = sb.rssr(M=40, N=900, L1=30, L2=905, L3=60, D=20)
    figure = plot.configuration(linkage.motion(36))
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    (axes,) = figure.axes
    ends = axes.get_xlim3d(), axes.get_ylim3d(), axes.get_zlim3d()
    assert max(np.ptp(ends, axis=1)) > 2 * min(np.ptp(ends, axis=1))
    corners = np.array(list(itertools.product(*ends))).T
    seen = axes.transData.transform(np.stack(proj3d.proj_transform(*corners, axes.get_proj())[:2], axis=-1))
    top, middle = seen[seen[:, 1].argmax()], seen.mean(axis=0)
    x, y = top + 8 * (middle - top) / np.linalg.norm(middle - top)
    rows = np.asarray(canvas.buffer_rgba())
    assert to_hex(rows[len(rows) - 1 - round(y), round(x)] / 255) == PANE


def test_a_point_far_off_leaves_the_linkage_its_size() -> None:
    joints = [{**joint} for joint in SLIDER_CRANK]
    motion = sb.from_axes(joints, points=[{"name": "far", "link": 2, "at": (0, 50_000, 0)}]).motion(
        samples=36
    )
    figure = plot.configuration(motion)
    low, high = figure.axes[0].get_xlim()
    assert high - low < 500
    entries = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "far is far off, not shown" in entries


def test_what_varies_by_rounding_is_flat() -> None:
    noise = 1e-14 * np.random.default_rng(3).standard_normal(50)
    assert (settle(noise, 90.0) == 0).all()
    assert np.ptp(settle(45.0 + noise, 90.0)) == 0
    wave = np.sin(np.linspace(0, 6, 50))
    assert (settle(wave, 90.0) == wave).all()
    # the spin of the paper's coupler is held: its column is rounding
    motion = sb.load("rssr").motion(samples=72)
    figure = plot.joints(motion)
    spans = [np.ptp(line.get_ydata()) for axes in figure.axes for line in axes.lines]
    assert all(span == 0 or span > 1e-4 for span in spans)
    flat = [axes for axes in figure.axes if all(np.ptp(line.get_ydata()) == 0 for line in axes.lines)]
    for axes in flat:
        low, high = axes.get_ylim()
        assert high - low > 1


@pytest.mark.parametrize(
    ("low", "high", "most", "ticks"),
    [
        (0, 360, 9, range(0, 361, 45)),
        (0, 360, 5, range(0, 361, 90)),
        (-190, 190, 6, range(-180, 181, 90)),
        (-10, 70, 7, range(0, 61, 15)),
        (0, 720, 6, range(0, 721, 180)),
    ],
)
def test_angles_have_ticks_by_which_people_read_them(
    low: float, high: float, most: int, ticks: range
) -> None:
    np.testing.assert_allclose(DegreeLocator(most).tick_values(low, high), list(ticks))


def test_names_and_numbers_are_written_as_people_write_them() -> None:
    assert shown_name("theta_12") == "θ₁₂"
    assert shown_name("theta_x") == "theta_x"
    assert quantity_label("rocker", "velocity", "rad/s") == "rocker velocity [rad/s]"
    assert amount_text(7.564e4, "mm", "/s²") == "75.6 m/s²"
    assert amount_text(4378.2, "mm", "/s") == "4378 mm/s"
    assert amount_text(0.0123, "m") == "0.0123 m"
    assert amount_text(2e5, "in") == "200000 in"


def test_a_fast_slide_is_drawn_in_metres() -> None:
    motion = sb.from_axes(SLIDER_CRANK, speed="3000 rpm").motion(samples=72)
    figure = plot.curves(motion, "input")
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "slider position [mm]",
        "slider velocity [m/s]",
        "slider acceleration [m/s²]",
    ]
    circuit = motion.circuits[0]
    for axes, rates in zip(figure.axes[1:], (circuit.dq, circuit.ddq), strict=True):
        drawn = np.asarray(axes.lines[0].get_ydata())[:-1]
        np.testing.assert_allclose(drawn, rates[:, circuit.output_column] / 1000, rtol=1e-12)
        low, high = axes.get_ylim()
        extremes = next(line for line in axes.lines if line.get_label() == "extreme").get_ydata()
        assert low < min(extremes) <= max(extremes) < high


def test_one_colour_has_one_meaning() -> None:
    assert not {INPUT, OUTPUT, COUPLER, GROUND} & set(CIRCUIT_COLOURS)
    assert len(set(CIRCUIT_COLOURS)) == len(CIRCUIT_COLOURS) == 8


def test_a_figure_of_several_panels_is_composed() -> None:
    motion = sb.load("planar_4r").motion(samples=48)
    spatial = sb.load("rssr").motion(samples=48)
    figure = plot.configuration(spatial)
    panels = [figure.add_axes((0.1 * k, 0.1, 0.1, 0.1)) for k in range(4)]
    solid = figure.add_axes((0.5, 0.5, 0.4, 0.4), projection="3d")
    assert plot.configuration(motion, ax=panels[0]) is figure
    assert plot.curves(motion, "time", quantities=["angle"], ax=panels[1]) is figure
    assert plot.joints(motion, columns=[motion.linkage.columns[1]], ax=panels[2]) is figure
    assert plot.point_path(motion, (2, (1.0, 2.0, 0.0)), parts=["speed"], ax=panels[3]) is figure
    assert plot.configuration(spatial, ax=solid) is figure
    assert [bool(axes.lines) for axes in panels] == [True] * 4
    assert panels[1].get_xlabel() == "time [s]"
    with pytest.raises(
        RequestError, match="ax: is flat, and the linkage moves in space; give axes made with"
    ):
        plot.configuration(spatial, ax=panels[0])
    with pytest.raises(RequestError, match="ax: give 3 axes of matplotlib, one for each of the quantities"):
        plot.curves(motion, ax=panels[0])


def test_styles_sizes_and_titles_are_as_asked() -> None:
    motion = sb.load("rssr").motion(samples=48)
    before = dict(matplotlib.rcParams)
    paper = plot.configuration(motion, style="paper", title=False)
    assert paper.get_figwidth() == pytest.approx(85 / 25.4)
    assert paper.get_suptitle() == ""
    assert plot.curves(motion, style="ieee", title="Ours").get_suptitle() == "Ours"
    assert tuple(plot.curves(motion, figsize=(4, 3)).get_size_inches()) == (4, 3)
    assert dict(matplotlib.rcParams) == before
    for wrong, message in (
        ({"style": "nature"}, "style: 'nature' is not a style; give screen, paper or ieee"),
        ({"figsize": (0, 1)}, "figsize: .0, 1. is not a size; give width and height"),
        ({"view": "xyz"}, "view: 'xyz' is not a view; did you mean"),
        ({"view": (100, 0)}, "view: .100, 0. is not a view"),
        ({"view": "plane"}, "view: the linkage is not planar; give another one of space"),
    ):
        with pytest.raises(RequestError, match=message):
            plot.configuration(motion, **wrong)  # type: ignore[arg-type]


def test_text_in_svg_is_text(tmp_path: Path) -> None:
    motion = sb.load("rssr").motion(samples=48)
    path = plot.save(plot.curves(motion), tmp_path / "a.svg")
    words = [
        "".join(element.itertext()) for element in ET.parse(path).iter("{http://www.w3.org/2000/svg}text")
    ]
    assert "rocker angle [deg]" in words


def film_of(page: str) -> Any:
    return json.loads(re.search(r"const film = (.*);\n", page)[1])  # type: ignore[index]


def test_an_html_film_holds_the_motions_numbers_and_needs_no_other_file(tmp_path: Path) -> None:
    motion = sb.load("rssr").motion(samples=72)
    page = animate(motion, tmp_path / "a.html", seconds=4, fps=10).read_text(encoding="utf-8")
    assert not re.search(r"(?:src|href)=|https?:|import ", page)
    film = film_of(page)
    assert len(film["linkage"]["poses"]) == 40
    assert film["fps"] == 10
    circuit = motion.circuits[0]
    output = circuit.output_column
    for curve, values in zip(
        film["curves"],
        (np.degrees(circuit.output), circuit.dq[:, output], circuit.ddq[:, output]),
        strict=True,
    ):
        np.testing.assert_allclose(curve["lines"][0]["y"][:-1], values, rtol=1e-6)
    # links keep their lengths in every picture
    poses = np.array(film["linkage"]["poses"])
    for link in film["linkage"]["links"]:
        start, end = poses[:, link["at"][0]], poses[:, link["at"][-1]]
        assert np.ptp(np.linalg.norm(end - start, axis=1)) < 1e-2


def test_a_name_cannot_end_the_script_of_a_film(tmp_path: Path) -> None:
    joints = [{**joint} for joint in SLIDER_CRANK]
    joints[0]["name"] = "</script><b>"
    motion = sb.from_axes(joints, name="<b>&").motion(samples=36)
    page = animate(motion, tmp_path / "a.html", seconds=1, fps=4).read_text(encoding="utf-8")
    assert page.count("</script>") == 1
    assert "<b>" not in page.split("<script>")[0]
    assert any("</script><b>" in name["text"] for name in film_of(page)["linkage"]["names"])


HOSTILE = ("<svg onload=alert(1)>", "<!--<script>", "@FILM@", "@HEADING@", "$& $` \\u003c")


@pytest.mark.parametrize("name", ["@FILM@", "@HEADING@ @TITLE@", "<!--<script>", "{quantity} $'"])
def test_a_name_in_a_film_is_put_where_it_belongs_and_read_for_nothing_else(
    name: str, tmp_path: Path
) -> None:
    joints = [{**joint, "name": own} for joint, own in zip(SLIDER_CRANK, HOSTILE, strict=False)]
    motion = sb.from_axes(joints, name=name).motion(samples=36)
    page = animate(motion, tmp_path / "a.html", seconds=1, fps=4).read_text(encoding="utf-8")
    assert page.count('{"fps"') == page.count("<script>") == page.count("</script>") == 1
    assert "<!--" not in page
    assert "<svg" not in page
    assert re.findall("<h1>(.*)</h1>", page)[0].startswith(escape(name))
    names = [text for one in film_of(page)["linkage"]["names"] for text in one["text"].split(", ")]
    assert set(names) == {joint["name"] for joint in joints}


def test_the_length_of_a_film_is_seconds_times_rate(tmp_path: Path) -> None:
    motion = sb.load("planar_4r").motion(samples=36)
    page = animate(motion, tmp_path / "a.html", seconds=2.5, fps=8).read_text(encoding="utf-8")
    assert len(film_of(page)["reading"]) == 20
    with pytest.raises(RequestError, match="seconds: frames and fps give the length"):
        animate(motion, tmp_path / "b.html", seconds=2, frames=3)
    with pytest.raises(
        RequestError, match=r"seconds: 0 is not offered; at 25 pictures a second give 0.08 to 400"
    ):
        animate(motion, tmp_path / "b.html", seconds=0)
    assert [path.name for path in tmp_path.iterdir()] == ["a.html"]


def test_centrodes_touch_in_the_instant_centre() -> None:
    motion = sb.load("planar_4r").motion(samples=360)
    figure = plot.axodes(motion)
    lines = {line.get_color(): np.array(line.get_data()).T for line in figure.axes[0].lines}
    fixed, moving = lines["#4B4B4B"], lines["#B4436C"]
    centre = next(
        np.array(line.get_data()).T[0]
        for line in figure.axes[0].lines
        if line.get_color() == "black" and line.get_marker() == "o"
    )
    row = int(np.nanargmin(np.linalg.norm(fixed - centre, axis=1)))
    np.testing.assert_allclose(fixed[row], centre, atol=1e-9)
    np.testing.assert_allclose(moving[row], centre, atol=1e-6)
    # they roll on each other: one tangent
    ways = [line[row + 1] - line[row - 1] for line in (fixed, moving)]
    cosine = abs(float(ways[0] @ ways[1])) / math.prod(float(np.linalg.norm(way)) for way in ways)
    assert cosine == pytest.approx(1, abs=1e-3)


def test_the_transmission_angle_is_the_circuits_own() -> None:
    motion = sb.load("planar_4r").motion(samples=72)
    figure = plot.transmission(motion)
    angles = motion.circuits[0].transmission_angle
    assert angles is not None
    np.testing.assert_array_equal(np.asarray(figure.axes[0].lines[0].get_ydata())[:-1], np.degrees(angles))
    with pytest.raises(
        RequestError, match="transmission: no circuit of this linkage has a transmission angle"
    ):
        plot.transmission(sb.load("bennett").motion(samples=36))


def test_figures_and_films_are_drawn_as_options_say(tmp_path: Path) -> None:
    words = ["--circuit", "1", "--view", "xz", "--size", "85x70mm", "--style", "paper", "--figures", "svg"]
    result = sevenbar(
        "analyze", "rssr", "--out", str(tmp_path / "a"), *words, "--animate", str(tmp_path / "a.html")
    )
    assert result.returncode == 0, result.stderr
    root = ET.parse(tmp_path / "a" / "configuration.svg").getroot()
    assert float(root.get("width", "").removesuffix("pt")) == pytest.approx(85 / 25.4 * 72, abs=0.01)
    assert "circuit 1" in (tmp_path / "a" / "configuration.svg").read_text()
    assert film_of((tmp_path / "a.html").read_text())["linkage"]["flat"]
    assert sevenbar("plot", "planar_4r", "--kind", "axodes", "--out", str(tmp_path / "p")).returncode == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--view", "30,-60"], "--view: no figure is drawn; give --out, --animate, or both"),
        (["--size", "9", "--out", "o"], "--size: '9' is not a size; give width and height of 13 to 1524 mm"),
        (["--style", "ieeee", "--out", "o"], "--style: 'ieeee' is not a style; did you mean 'ieee'?"),
        (["--view", "front", "--out", "o"], "--view: 'front' is not a view; give one of plane, space, xy"),
        (["--seconds", "3", "--out", "o"], "--seconds: a film is missing; give --animate"),
        (["--circuit", "7", "--out", "o"], "circuit: 7 is not a circuit of this motion; give 0 to 1"),
        (["--animate", "a.gif", "--fps", "99"], "fps: 99.0 is not offered; give 0.1 to 50 for a .gif file"),
    ],
)
def test_a_wrong_option_of_figures_gets_one_message_and_no_file(
    words: list[str], message: str, tmp_path: Path
) -> None:
    result = sevenbar("analyze", "rssr", *words, cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr.count("\n") == 1
    assert message in result.stderr
    assert not list(tmp_path.iterdir())


# --- the linkage alone


@pytest.mark.parametrize("name", ["planar_4r", "rssr", "spherical_4r", "seven_r", "engine"])
@pytest.mark.parametrize("size", [None, (1.0, 1.0)])
def test_a_skeleton_has_links_and_joints_and_neither_numbers_nor_words(name, size) -> None:
    figure = plot.skeleton(sb.load(name).motion(samples=36), figsize=size)
    (axes,) = figure.axes
    assert not axes.axison
    assert not figure.legends
    assert not figure.texts
    assert not [text for text in axes.texts if text.get_text().strip()]
    assert axes.get_title() == ""
    assert len(axes.lines) >= 3


def test_a_skeleton_is_drawn_in_the_drawn_pose_or_at_a_value_of_the_input() -> None:
    drawn = sb.from_axes(SLIDER_CRANK).motion(samples=36)
    links = plot.skeleton(drawn).axes[0].lines
    places = np.concatenate([np.column_stack(line.get_data()) for line in links])
    pin = SLIDER_CRANK[1]["at"]
    assert np.abs(places - pin[:2]).max(axis=1).min() < 1e-6
    turned = plot.skeleton(drawn, at="90 deg").axes[0].lines
    moved = np.concatenate([np.column_stack(line.get_data()) for line in turned])
    assert np.abs(moved - pin[:2]).max(axis=1).min() > 1.0
    named = plot.skeleton(drawn, names=True).axes[0]
    assert {text.get_text() for text in named.texts} >= {"crank", "crank pin"}


def test_a_skeleton_on_a_small_page_has_thinner_lines() -> None:
    motion = sb.load("planar_4r").motion(samples=36)
    widths = [
        max(line.get_linewidth() for line in plot.skeleton(motion, figsize=(s, s)).axes[0].lines)
        for s in (3, 1)
    ]
    assert widths[1] < 0.5 * widths[0]


def test_pages_that_are_too_small_are_refused_with_what_to_draw_instead() -> None:
    motion = sb.load("planar_4r").motion(samples=36)
    with pytest.raises(RequestError, match="size: 40 x 40 mm is too small for 3 panels"):
        plot.curves(motion, figsize=(40 / 25.4, 40 / 25.4))
    with pytest.raises(
        RequestError, match=r"size: 40 x 40 mm is too small for this picture .*--kind skeleton"
    ):
        plot.configuration(motion, figsize=(40 / 25.4, 40 / 25.4))


def test_a_skeleton_is_drawn_from_the_command_line(tmp_path: Path) -> None:
    sevenbar(
        "plot",
        "planar_4r",
        "--kind",
        "skeleton",
        "--size",
        "25x25mm",
        "--out",
        "out",
        "--figures",
        "svg",
        cwd=tmp_path,
    )
    text = (tmp_path / "out" / "skeleton.svg").read_text(encoding="utf-8")
    assert "<text" not in text


def test_a_circuit_far_away_is_named_and_not_drawn_to_scale() -> None:
    joints = [
        {"name": name, "kind": kind, "at": at, "axis": axis}
        for name, kind, at, axis in (
            ("crank", "R", [0, 0, 0], [0, 0, 1]),
            ("pin", "R", [50, 0, 0], [0, 0, 1]),
            ("wrist", "R", [0, -397, 0], [0, 0, 1]),
            ("ram", "P", [0, -397, 0], [0, 1, 0]),
        )
    ]
    figure = plot.curves(sb.from_axes(joints).motion(samples=36), "input", quantities=["angle"])
    (axes,) = figure.axes
    low, high = axes.get_ylim()
    assert 100 < high - low < 150
    (said,) = [text.get_text() for text in axes.texts]
    assert said.startswith("circuit 1: 74")
    assert said.endswith("not shown")
