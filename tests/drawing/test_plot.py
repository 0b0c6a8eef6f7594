"""Figures and animations: real files of each kind, and curves that hold the motion's own numbers."""

from __future__ import annotations

import json
import math
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from matplotlib import rcParams
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

import sevenbar as sb
from places import EXAMPLES
from sevenbar.description.draft import Draft
from sevenbar.drawing import animate as animation
from sevenbar.drawing import output_curves, plot, scene, skeleton
from sevenbar.drawing.animate import animate
from sevenbar.drawing.style import COUPLER, GROUND, INPUT, OUTPUT, paler
from sevenbar.errors import MissingExtraError, OutputError, RequestError
from sevenbar.kinematics.circuits.poses import walk

AXES = EXAMPLES / "rssr_axes.toml"


def joints(
    a0: tuple[float, ...],
    a: tuple[float, ...],
    b: tuple[float, ...],
    b0: tuple[float, ...],
    last: tuple[float, ...],
) -> list[dict[str, Any]]:
    return [
        {"kind": "R", "at": a0, "axis": (0, 0, 1)},
        {"kind": "S", "at": a},
        {"kind": "S", "at": b},
        {"kind": "R", "at": b0, "axis": last},
    ]


MOTIONS: dict[str, Callable[[], sb.Motion]] = {
    "crank-rocker": lambda: sb.load("rssr").motion(),
    "rocker-crank": lambda: sb.load("rssr").motion(input="rocker"),
    "as drawn": lambda: sb.load(AXES).motion(),
    "double-rocker": lambda: sb.rssr(M=700, N=700, L1=500, L3=550, D=100).motion(),
    "double-crank": lambda: sb.from_axes(
        joints((0, 0, 0), (100, 0, 0), (120, 90, 10), (30, 0, 0), (0.05, 0, 1))
    ).motion(),
    "parallelogram": lambda: sb.from_axes(
        joints((0, 0, 0), (0, 100, 0), (200, 100, 0), (200, 0, 0), (0, 0, 1))
    ).motion(),
    "tiny crank": lambda: sb.rssr(M=700, N=700, L1=1, L3=550, D=0).motion(),
    "backwards": lambda: sb.load("rssr").motion(speed=-10),
    "coarse": lambda: sb.load("rssr").motion(samples=4),
}
ROCKING = ["rocker-crank", "double-rocker"]


@pytest.fixture(scope="module")
def crank_rocker() -> sb.Motion:
    return sb.load("rssr").motion()


@pytest.fixture(scope="module")
def figure(crank_rocker: sb.Motion) -> Figure:
    return plot.curves(crank_rocker)


def lines(figure: Figure, panel: int, label: str) -> list[Any]:
    return [line for line in figure.axes[panel].lines if line.get_label() == label]


# --- figures as files


def test_each_ending_gives_a_file_of_its_kind(figure: Figure, tmp_path: Path) -> None:
    png, svg, pdf, eps = (plot.save(figure, tmp_path / f"curves.{ending}") for ending in plot.FORMATS)
    assert png.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    width, height = figure.get_size_inches() * 200
    with Image.open(png) as image:
        assert image.size == (round(width), round(height))
    assert ET.parse(svg).getroot().tag.endswith("svg")
    assert pdf.read_bytes().startswith(b"%PDF-")
    assert eps.read_bytes().startswith(b"%!PS-Adobe-3.0 EPSF")


@pytest.mark.parametrize("ending", plot.FORMATS)
def test_the_same_figure_gives_the_same_bytes(crank_rocker: sb.Motion, tmp_path: Path, ending: str) -> None:
    first, second = (
        plot.save(plot.configuration(crank_rocker), tmp_path / f"{name}.{ending}").read_bytes()
        for name in "ab"
    )
    assert first == second


def test_an_unknown_ending_names_those_allowed(figure: Figure, tmp_path: Path) -> None:
    with pytest.raises(
        OutputError, match=r"curves\.bmp: '\.bmp' is not a figure format; give \.png, \.svg, \.pdf or \.eps"
    ):
        plot.save(figure, tmp_path / "curves.bmp")
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_told(figure: Figure, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"none.curves\.png: cannot be written: no such file"):
        plot.save(figure, tmp_path / "none" / "curves.png")


def test_a_failed_write_leaves_the_old_file_and_nothing_else(
    figure: Figure, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "curves.png"
    target.write_text("old")

    def half(_: Figure, file: Path, **__: object) -> None:
        file.write_text("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Figure, "savefig", half)
    with pytest.raises(OutputError, match="no space left on device"):
        plot.save(figure, target)
    assert [p.name for p in tmp_path.iterdir()] == ["curves.png"]
    assert target.read_text() == "old"


def test_a_folder_in_the_way_is_told(figure: Figure, tmp_path: Path) -> None:
    (tmp_path / "curves.png").mkdir()
    with pytest.raises(OutputError, match="it is a folder"):
        plot.save(figure, tmp_path / "curves.png")
    assert len(list(tmp_path.iterdir())) == 1


def test_drawing_leaves_matplotlib_as_it_was(crank_rocker: sb.Motion) -> None:
    before = dict(rcParams)
    plot.configuration(crank_rocker)
    plot.curves(crank_rocker)
    assert dict(rcParams) == before


# --- the configuration


@pytest.mark.parametrize("name", MOTIONS)
def test_a_length_is_as_long_along_each_axis_and_all_is_inside(name: str) -> None:
    motion = MOTIONS[name]()
    axes: Any = plot.configuration(motion, circuit=len(motion.circuits) - 1, view="space").axes[0]
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    ranges = np.ptp(limits, axis=1)
    aspect = np.array(axes.get_box_aspect())
    np.testing.assert_allclose(ranges / aspect, (ranges / aspect)[0], rtol=1e-12)
    frame = skeleton.skeleton(motion, motion.circuits[-1])
    places = frame.places.reshape(-1, 3)
    assert (places >= limits[:, 0]).all()
    assert (places <= limits[:, 1]).all()


@pytest.mark.parametrize("name", MOTIONS)
def test_every_drawn_pose_is_an_assembled_pose(name: str) -> None:
    motion = MOTIONS[name]()
    circuit, positions = motion.circuits[0], 5
    frame = skeleton.skeleton(motion, circuit)
    axes: Any = plot.configuration(motion, positions=positions, view="space").axes[0]
    crank, coupler, rocker = motion.linkage.lengths
    bars = [np.array(line.get_data_3d()).T for line in axes.lines if len(line.get_data_3d()[0]) == 2]
    rows = {tuple(np.round(row.ravel(), 6)) for row in frame.places[:, list(frame.inner.values())]}
    couplers = [bar for bar in bars if tuple(np.round(bar.ravel(), 6)) in rows]
    assert len(couplers) >= positions
    for bar in couplers:
        assert np.linalg.norm(bar[0] - bar[1]) == pytest.approx(coupler, rel=1e-9)
    # arms from the joints' axes, on which they may be drawn anywhere
    axes = {joint: ends for joint, word, ends in frame.marks if word == "axis"}
    for joint, ball, length in ((0, frame.inner[1], crank), (3, frame.inner[2], rocker)):
        start, end = np.moveaxis(frame.places[:, list(axes[joint])], 1, 0)
        across = np.cross(frame.places[:, ball] - start, end - start)
        found = np.linalg.norm(across, axis=1) / np.linalg.norm(end - start, axis=1)
        np.testing.assert_allclose(found, length, rtol=1e-9)


def test_centres_are_those_of_the_paper(crank_rocker: sb.Motion) -> None:
    frame = skeleton.skeleton(crank_rocker, crank_rocker.circuits[0])
    np.testing.assert_allclose(frame.pose(0)[frame.joints[0]], [0, 0, 700], atol=1e-9)
    np.testing.assert_allclose(frame.pose(0)[frame.joints[-1]], [700, 0, 0], atol=1e-9)
    axes = [frame.pose(0)[list(places)] for _, word, places in frame.marks if word == "axis"]
    ways = [np.abs(np.diff(ends, axis=0)[0]) / np.linalg.norm(ends[1] - ends[0]) for ends in axes]
    np.testing.assert_allclose(ways, [[0, 0, 1], [1, 0, 0]], atol=1e-12)


def test_a_named_point_gets_its_path_and_its_entry() -> None:
    motion = sb.load(AXES).motion()
    figure = plot.configuration(motion)
    entries = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "path of middle" in entries
    middle = motion.circuits[0].point(2, (475, 275, 350)).position
    axes: Any = figure.axes[0]
    drawn = [np.array(line.get_data_3d()).T for line in axes.lines]
    # the line goes through every row, and may have more places between them
    missed = [
        max(np.abs(path - row).max(axis=1).min() for row in middle) for path in drawn if len(path) > 360
    ]
    assert min(missed) < 1e-9


def test_a_named_point_is_tied_to_its_link_in_that_links_colour() -> None:
    """Of the crank blue, of the coupler green, of the output orange, of the ground grey."""
    draft = Draft.of_linkage(sb.load("planar_4r"))
    for link, name in ((3, "O"), (1, "I"), (2, "K"), (4, "G")):
        draft = draft.with_point(name, link, (10.0, 20.0, 0.0))
    motion = draft.linkage.motion(12)
    drawn = scene.stays(skeleton.skeleton(motion, motion.circuits[0]), ("theta_1", "theta_4"))
    assert [colour for _, colour in drawn] == [OUTPUT, INPUT, COUPLER, to_hex(paler(GROUND, 0.35))]


def test_names_are_shown_as_they_are_written() -> None:
    form = joints((0, 0, 0), (0, 50, 0), (200, 100, 0), (200, 0, 0), (0, 0, 1))
    form[0]["name"], form[3]["name"] = "_in$x_$", "\\frac"
    figure = plot.configuration(sb.from_axes(form, name="a $\\frac b").motion())
    entries = [text.get_text() for text in figure.legends[0].get_texts()]
    assert entries[0] == "input: _in$x_$"
    figure.canvas.draw()


# --- the curves


@pytest.mark.parametrize("name", MOTIONS)
def test_curves_are_the_circuits_numbers(name: str) -> None:
    motion = MOTIONS[name]()
    figure = plot.curves(motion, "input")
    for circuit in motion:
        for panel, values in enumerate(
            (
                np.degrees(circuit.output),
                circuit.dq[:, circuit.output_column],
                circuit.ddq[:, circuit.output_column],
            )
        ):
            drawn = [
                line
                for line in figure.axes[panel].lines
                if line.get_label().startswith(f"circuit {circuit.index}")
            ]
            x = np.concatenate([line.get_xdata()[:-1] for line in drawn])
            y = np.concatenate([line.get_ydata()[:-1] for line in drawn])
            np.testing.assert_array_equal(x, np.degrees(circuit.input))
            if panel == 1:
                y, values = np.abs(y), np.abs(values)
            # of what varies by rounding only, the mean is drawn
            flat = np.nanmax(values) - np.nanmin(values) < 1e-9
            np.testing.assert_allclose(y, values, rtol=0, atol=1e-9 if flat else 0)


@pytest.mark.parametrize("name", ROCKING)
def test_a_rocking_velocity_is_the_slope_over_time(name: str) -> None:
    linkage = MOTIONS[name]().linkage
    motion = linkage.motion(samples=3600, input="rocker" if name == "rocker-crank" else None)
    for line in output_curves.passes(motion):
        slope = np.gradient(np.radians(line.values("angle")), line.across("time"))
        inner = slice(len(slope) // 4, -len(slope) // 4)
        np.testing.assert_allclose(
            line.values("velocity")[inner], slope[inner], rtol=1e-2, atol=1e-3 * abs(motion.speed)
        )


@pytest.mark.parametrize("name", MOTIONS)
def test_a_cycle_closes_in_angle_and_time(name: str) -> None:
    motion = MOTIONS[name]()
    for circuit in motion:
        path = walk(circuit)
        assert math.remainder(path.input[-1] - path.input[0], math.tau) == pytest.approx(0, abs=1e-9)
        assert math.remainder(path.output[-1] - path.output[0], math.tau) == pytest.approx(0, abs=1e-9)
        travelled = np.abs(np.diff(path.input)).sum()
        assert path.time[-1] == pytest.approx(travelled / abs(motion.speed), rel=1e-12)
        step = np.abs(np.diff(path.output))
        assert step[-1] < math.pi


def test_extremes_are_marked_at_the_papers_numbers(figure: Figure) -> None:
    table = ((-0.1222, 1.189), (-5.445, 7.96), (-137.6, 56.92))
    for panel, (low, high) in enumerate(table):
        _, y = lines(figure, panel, output_curves.EXTREME)[0].get_data()
        values = np.radians(y) if panel == 0 else np.asarray(y)
        np.testing.assert_allclose(values, [low, high], rtol=5e-4)


def test_any_quantity_of_the_list_is_drawn_by_its_name_and_lines_are_one_where_all_of_them_are() -> None:
    motion = sb.load("seven_r").motion(36)
    labels = [line.get_label() for line in plot.curves(motion, "input").axes[0].lines]
    assert sum(label.startswith("circuits") for label in labels) == 4
    _, lower = plot.curves(motion, "input", quantities=["angle", "theta_3 velocity"]).axes
    assert lower.get_ylabel() == "θ₃ velocity [rad/s]"
    values = [line.get_ydata()[:-1] for line in lower.lines]
    np.testing.assert_array_equal(values, [circuit.dq[:, 2] for circuit in motion])
    with pytest.raises(RequestError, match="quantities: 'theta_3 speed' is not drawn; did you mean"):
        plot.curves(motion, quantities=["theta_3 speed"])


def test_one_quantity_may_be_a_word() -> None:
    (axes,) = plot.curves(sb.load("rssr").motion(36), "input", quantities="velocity").axes
    assert axes.get_ylabel() == "rocker velocity [rad/s]"


@pytest.mark.parametrize("over", ["input", "time"])
def test_extremes_lie_on_their_curves(over: str) -> None:
    for name in ("crank-rocker", "double-rocker", "backwards"):
        motion = MOTIONS[name]()
        figure = plot.curves(motion, over)  # type: ignore[arg-type]
        for mark in lines(figure, 0, output_curves.EXTREME):
            curve = [
                np.asarray(line.get_data()).T
                for line in figure.axes[0].lines
                if line.get_label().startswith("circuit") and line.get_color() == mark.get_markeredgecolor()
            ]
            for place in np.asarray(mark.get_data()).T:
                scale = np.ptp(np.concatenate(curve), axis=0)
                assert min(np.abs((c - place) / scale).max(axis=1).min() for c in curve) < 0.01


@pytest.mark.parametrize("name", ROCKING)
def test_limits_are_marked_and_no_other_inputs(name: str) -> None:
    motion = MOTIONS[name]()
    figure = plot.curves(motion)
    marked = np.array([line.get_xdata()[0] for line in lines(figure, 0, output_curves.LIMIT)])
    np.testing.assert_allclose(np.sort(np.radians(marked) % math.tau), motion.limits, atol=1e-12)
    low, high = figure.axes[0].get_xlim()
    assert ((marked > low) & (marked < high)).all()
    ends = np.degrees([end for circuit in motion for end in circuit.input_range or ()])
    np.testing.assert_allclose(np.sort(marked), np.sort(ends), atol=1e-9)


def test_endless_rates_are_cut_and_the_note_says_so(crank_rocker: sb.Motion) -> None:
    motion = MOTIONS["double-rocker"]()
    figure = plot.curves(motion, "input")
    largest = np.nanmax(np.abs(motion.circuits[0].dq[:, motion.circuits[0].output_column]))
    assert figure.axes[1].get_ylim()[1] < largest / 3
    assert "axes cut" in figure.legends[0].get_title().get_text()
    assert "axes cut" not in plot.curves(crank_rocker).legends[0].get_title().get_text()


def test_bounded_rates_at_a_change_point_are_not_cut() -> None:
    motion = MOTIONS["parallelogram"]()
    figure = plot.curves(motion, "input")
    for circuit in motion:
        low, high = figure.axes[2].get_ylim()
        values = circuit.ddq[:, circuit.output_column]
        assert low <= np.nanmin(values) <= np.nanmax(values) <= high
    marked = [line.get_xdata()[0] for line in lines(figure, 0, output_curves.CHANGE_POINT)]
    np.testing.assert_allclose(marked, np.degrees(motion.change_point_inputs))


def test_time_runs_above_a_turning_input_and_beside_a_rocking_one(crank_rocker: sb.Motion) -> None:
    assert len(plot.curves(crank_rocker).axes) == 3
    (above,) = plot.curves(crank_rocker).axes[0].child_axes
    assert above.get_xlabel() == "time [s]"
    beside = plot.curves(MOTIONS["rocker-crank"]())
    assert [axes.get_xlabel() for axes in beside.axes[-2:]] == ["rocker angle [deg]", "time [s]"]


def test_a_law_is_drawn_as_it_runs(crank_rocker: sb.Motion, tmp_path: Path) -> None:
    t = np.linspace(0, 1, 30)
    motion = crank_rocker.linkage.motion(law=sb.Law.of(t, 2 + t**2, 2 * t, 2.0))
    figure = plot.curves(motion, "time")
    line = lines(figure, 1, "circuit 0")[0]
    np.testing.assert_array_equal(line.get_xdata(), t)
    np.testing.assert_array_equal(
        line.get_ydata(), motion.circuits[0].dq[:, motion.circuits[0].output_column]
    )
    plot.configuration(motion)
    with Image.open(animate(motion, tmp_path / "law.gif", frames=3)) as image:
        assert image.n_frames == 3  # type: ignore[attr-defined]


# --- requests that cannot be met


def test_without_a_circuit_there_is_nothing_to_draw(tmp_path: Path) -> None:
    motion = sb.rssr(M=700, N=700, L1=10, L3=10, D=0, L2=10).motion()
    for draw in (plot.configuration, plot.curves, lambda m: animate(m, tmp_path / "a.gif")):
        with pytest.raises(
            RequestError, match="cannot-assemble, the loop closes at no input; 'sevenbar analyze' says why"
        ):
            draw(motion)
    assert not list(tmp_path.iterdir())


def test_wrong_requests_say_what_is_allowed(crank_rocker: sb.Motion, tmp_path: Path) -> None:
    requests: list[tuple[str, Callable[[], object]]] = [
        (
            "circuit: 2 is not a circuit of this motion; give 0 to 1",
            lambda: plot.configuration(crank_rocker, 2),
        ),
        ("positions: 0 is not a count; give 1 to 100", lambda: plot.configuration(crank_rocker, positions=0)),
        ("against: 'x' is not offered; give both", lambda: plot.curves(crank_rocker, "x")),  # type: ignore[arg-type]
        ("frames: 1 is not a count; give 2", lambda: animate(crank_rocker, tmp_path / "a.gif", frames=1)),
        (
            "fps: 60 is not offered; give 0.1 to 50 for a .gif",
            lambda: animate(crank_rocker, tmp_path / "a.gif", fps=60),
        ),
    ]
    for message, request in requests:
        with pytest.raises(RequestError, match=message):
            request()


# --- animations


def test_a_gif_has_its_pictures_its_pace_and_no_end(crank_rocker: sb.Motion, tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    path = animate(
        crank_rocker,
        tmp_path / "a.gif",
        frames=24,
        fps=30,
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen == [(k, 24) for k in range(1, 25)]
    with Image.open(path) as image:
        assert image.n_frames == 24  # type: ignore[attr-defined]
        assert image.info["loop"] == 0
        pictures, durations = [], []
        for k in range(24):
            image.seek(k)
            durations.append(image.info["duration"])
            pictures.append(np.asarray(image.convert("RGB"), dtype=int))
    assert sum(durations) == 800
    assert (pictures[0][2, 2] == 255).all()
    steps = [np.abs(a - b).mean() for a, b in zip(pictures, [*pictures[1:], pictures[0]], strict=True)]
    assert 0 < steps[-1] < 1.5 * max(steps[:-1])
    assert [p.name for p in tmp_path.iterdir()] == ["a.gif"]


@pytest.mark.parametrize("name", MOTIONS)
def test_the_picture_after_the_last_is_the_first(name: str) -> None:
    motion = MOTIONS[name]()
    circuit = motion.circuits[0]
    path, frame = walk(circuit), skeleton.skeleton(motion, circuit)
    frames = 50
    rows = animation._rows(motion, path, frames)
    times = np.interp(rows, np.arange(len(path.time)), path.time)
    np.testing.assert_allclose(np.diff(times), path.time[-1] / frames, rtol=1e-9)
    assert times[-1] + path.time[-1] / frames == pytest.approx(path.time[-1])
    np.testing.assert_allclose(frame.pose(len(path.time) - 1), frame.pose(0), atol=1e-9 * frame.span)


@pytest.mark.parametrize("name", ROCKING)
def test_a_rocking_input_goes_forth_and_back(name: str) -> None:
    motion = MOTIONS[name]()
    path = walk(motion.circuits[0])
    inputs = np.interp(animation._rows(motion, path, 100), np.arange(len(path.time)), path.input)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(inputs))))
    assert len(turns) == 1
    assert np.ptp(inputs) == pytest.approx(np.ptp(motion.circuits[0].input), rel=0.03)


@pytest.mark.parametrize("frames", [60, 61])
def test_a_film_of_a_linkage_with_stops_goes_from_stop_to_stop_and_back(tmp_path: Path, frames: int) -> None:
    stops = '[[stop]]\njoint = "rocker"\nrange = [0, 30]\n'
    text = "format = 1\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL3 = 550\nD = 0\n" + stops
    motion = sb.loads(text).motion(72)
    page = animate(motion, tmp_path / "film.html", frames=frames).read_text()
    film = json.JSONDecoder().raw_decode(page, page.index('{"fps"'))[0]
    output, times = np.array(film["curves"][0]["y"]), np.array(film["reading"])
    # the turn may lie between two pictures
    assert output.min() == pytest.approx(0, abs=1)
    assert output.max() == pytest.approx(30, abs=1)
    assert (np.diff(times) > 0).all()
    # of an odd number two pictures next to the turn are alike
    steps = np.diff(output)
    assert len(np.flatnonzero(np.diff(np.sign(steps[steps != 0])))) == 1


def test_an_mp4_holds_every_picture(tmp_path: Path) -> None:
    path = animate(MOTIONS["double-rocker"](), tmp_path / "a.mp4", frames=20, fps=25)
    assert imageio_ffmpeg.count_frames_and_secs(str(path)) == (20, pytest.approx(0.8))
    raw = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    decoded = np.frombuffer(subprocess.run(raw, capture_output=True, check=True).stdout, dtype=np.uint8)
    pictures = decoded.reshape(20, 640, 1120, 3).astype(int)
    assert (pictures[0][:4, :4] > 250).all()
    assert all(np.abs(a - b).max() > 100 for a, b in pairwise(pictures))
    assert [p.name for p in tmp_path.iterdir()] == ["a.mp4"]


def test_an_unknown_animation_ending_names_those_allowed(crank_rocker: sb.Motion, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"'\.avi' is not an animation format; give \.gif, \.mp4 or \.html"):
        animate(crank_rocker, tmp_path / "a.avi")


def test_without_ffmpeg_an_mp4_says_what_to_install(
    crank_rocker: sb.Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(animation.shutil, "which", lambda _: None)
    monkeypatch.setattr(animation.importlib, "import_module", missing)
    with pytest.raises(
        MissingExtraError, match=r"install ffmpeg, or pip install 'sevenbar\[movie\]', or give a \.gif"
    ):
        animate(crank_rocker, tmp_path / "a.mp4")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("ending", ["gif", "mp4"])
def test_an_interrupted_animation_leaves_nothing(
    crank_rocker: sb.Motion, tmp_path: Path, ending: str
) -> None:
    def interrupt(done: int, _: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animate(crank_rocker, tmp_path / f"a.{ending}", frames=10, progress=interrupt)
    assert not list(tmp_path.iterdir())


def test_ffmpegs_own_words_are_passed_on(
    crank_rocker: sb.Motion, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "ffmpeg"
    program.write_text("#!/bin/sh\necho 'no such encoder' >&2\nexit 3\n")
    program.chmod(0o755)
    monkeypatch.setattr(animation, "_ffmpeg", lambda: str(program))
    with pytest.raises(OutputError, match="ffmpeg failed: no such encoder"):
        animate(crank_rocker, tmp_path / "a.mp4", frames=10)
    assert [p.name for p in tmp_path.iterdir()] == ["ffmpeg"]


def test_a_coupler_curve_can_be_had_alone_without_a_title_in_a_small_size() -> None:
    motion = sb.load("planar_4r").motion(72)
    at = (2, (50.0, 60.0, 0.0))
    figure = plot.point_path(motion, at, parts=["path"], title=False, figsize=(3.35, 2.36), style="ieee")
    assert len(figure.axes) == 1
    assert [text.get_text() for text in figure.texts if text.get_text()] == []
    with pytest.raises(
        RequestError, match=r"size: 85.1 x 59.9 mm is too small for 3 panels; .*--kind coupler"
    ):
        plot.point_path(motion, at, figsize=(3.35, 2.36), style="ieee")


def test_a_legend_names_circuits_where_it_cannot_name_every_branch(monkeypatch):
    motion = sb.load("stephenson").motion(72)
    assert len(sb.plot.curves(motion, against="input").legends[0].get_texts()) == 6
    monkeypatch.setattr("sevenbar.drawing.output_curves.MOST_NAMED", 3)
    figure = sb.plot.curves(motion, against="input")
    entries = {line.get_label(): line for line in figure.legends[0].legend_handles}
    circuits = [f"circuit {number}" for number in range(3)]
    assert list(entries) == [*circuits, "input rising", "input falling", "extreme", "input limit"]
    assert [entries[word].get_linestyle() for word in list(entries)[:5]] == ["-"] * 4 + ["--"]
    lines = [line for line in figure.axes[0].lines if line.get_label() in circuits]
    for line in lines:
        inputs = line.get_xdata()
        assert line.get_linestyle() == ("--" if inputs[-1] < inputs[0] else "-")
    assert {line.get_linestyle() for line in lines} == {"-", "--"}
