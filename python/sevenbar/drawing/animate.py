"""Films of a motion: the linkage moving, and the curve of its output with it, as GIF, MP4 or HTML page."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, cast

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.transforms import Bbox
from PIL import Image

from sevenbar.arrays import Floats, is_number, whole_number
from sevenbar.drawing import output_curves, scene
from sevenbar.drawing.figure import new_figure, shown_value, slides, title_of, title_text, written_whole
from sevenbar.drawing.film_page import film_page
from sevenbar.drawing.lettering import write_names
from sevenbar.drawing.names import shown_name
from sevenbar.drawing.page import own_axes, prepare, write_legend, write_title
from sevenbar.drawing.skeleton import Skeleton, skeleton
from sevenbar.drawing.space import ViewAxes
from sevenbar.drawing.style import INK, checked_size, letters, page_size, stroke, styled
from sevenbar.drawing.view import Asked, Projection, view_of
from sevenbar.errors import MissingExtraError, OutputError, RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, chosen_circuit
from sevenbar.kinematics.circuits.poses import Walk, walk
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.ranges.reach import used_reach
from sevenbar.text.progress import Progress, silent
from sevenbar.text.words import say

Picture = npt.NDArray[np.uint8]

#: Size of a picture [inch] and its resolution; the pixels come out even, as video wants them.
SIZE, DPI = (11.2, 6.4), 100
MOST_FRAMES = 10_000
#: Colours of a GIF from here on are white, lest Pillow, which looks colours up in steps of 4, tint the page.
NEARLY_WHITE = 247
#: The greatest frame rates [1/s]: browsers slow down GIF pictures shorter than 20 ms.
FASTEST = {".gif": 50.0, ".mp4": 240.0, ".html": 240.0}
#: Pictures of a film where neither their number nor its length is given, and their rate [1/s].
FRAMES, RATE = 120, 25.0
#: Poses for which the names of joints are placed, and their distances [points]: names move with their joints.
NAMED_POSES, NEAR = 24, (6.0, 9.0)


def animate(
    motion: Motion,
    path: str | os.PathLike[str],
    *,
    circuit: int = 0,
    frames: int | None = None,
    fps: float = RATE,
    seconds: float | None = None,
    view: Asked = None,
    figsize: Sequence[float] | None = None,
    style: str | None = None,
    title: bool | str = True,
    progress: Progress | None = None,
) -> Path:
    """Writes one cycle of a circuit, evenly in time, as GIF, MP4 or HTML by the path's ending; returns it.

    The film shows `frames` pictures at `fps` [1/s], or takes `seconds`; 120 pictures where neither is given.
    A rocking circuit goes forth and back; the last picture leads over to the first, save where a law drives:
    then the law is run once. Stops of the linkage end the way: it goes from stop to stop and back, where
    there are several stretches on that of the drawn pose, else of the first row. An HTML page plays by itself
    in any browser: it can be stopped, and a spatial linkage turned with the mouse. `view`, `figsize`, `style`
    and `title` are those of `plot.configuration`.
    `progress(done, total)` is called after each picture.

    Raises `RequestError` for a circuit, count, rate or view that is not offered, `OutputError` for another
    ending and where the file cannot be written (then nothing is left behind), `MissingExtraError` for MP4
    without ffmpeg.

        >>> import sevenbar as sb, tempfile, pathlib
        >>> folder = pathlib.Path(tempfile.mkdtemp())
        >>> animate(sb.load("planar_4r").motion(), folder / "film.html", seconds=2).name
        'film.html'
    """
    target = Path(path)
    ffmpeg = check_target(target)
    ending = target.suffix.lower()
    chosen = chosen_circuit(motion, circuit)
    frames = check_film(target, frames=frames, fps=fps, seconds=seconds)
    size = _even(page_size(style, None if figsize is None else checked_size(figsize), SIZE, wide=True))
    with written_whole(target) as file, styled(style):
        frame = skeleton(motion, chosen)
        seen = view_of(view, motion.linkage, scene.shown_places(frame))
        usual = f"{title_of(motion)}\n{say('circuit {number}', number=chosen.index)}"
        heading = title_text(title, usual)
        if ending == ".html":
            rows, times = _course(motion, chosen, frames)
            text = film_page(motion, chosen, frame, seen, rows, times, fps=float(fps), title=heading)
            file.write_text(text, encoding="utf-8")
            return target
        shown_as = _pictures(motion, chosen, frame, seen, frames, size, heading)
        pictures = _reported(shown_as, frames, progress)
        if ending == ".gif":
            _write_gif(pictures, file, frames, float(fps))
        else:
            _write_mp4(pictures, file, float(fps), ffmpeg, target, size)
    return target


def _even(size: tuple[float, float]) -> tuple[float, float]:
    """The size [inch] with even pixels, as video wants them."""
    width, height = (2 * max(1, round(side * DPI / 2)) / DPI for side in size)
    return width, height


def check_film(
    target: Path, *, frames: int | None = None, fps: float = RATE, seconds: float | None = None
) -> int:
    """How many pictures a film has; raises `RequestError` for a count, a rate or a length not offered."""
    most = FASTEST[target.suffix.lower()]
    if not is_number(fps) or not 0.1 <= fps <= most:
        raise RequestError(
            f"fps: {shown(fps)} is not offered; give 0.1 to {most:g} for a {target.suffix.lower()} file"
        )
    if seconds is not None:
        if frames is not None:
            raise RequestError("seconds: frames and fps give the length of the film; leave one of them out")
        if not (is_number(seconds) and 2 <= seconds * fps <= MOST_FRAMES):
            raise RequestError(
                f"seconds: {shown(seconds)} is not offered; at {fps:g} pictures a second "
                f"give {2 / fps:g} to {MOST_FRAMES / fps:g}"
            )
        return round(float(seconds * fps))
    if frames is None:
        return FRAMES
    return whole_number("frames", frames, 2, MOST_FRAMES, "a count")


def check_target(target: Path) -> str:
    """The ffmpeg program that the path's ending needs, or none; raises as `animate` does for a bad path."""
    ffmpeg = check_ending(target)
    with written_whole(target, keep=False) as file:
        file.touch()
    return ffmpeg


def check_ending(target: Path) -> str:
    """The same of the ending alone, where the folder may still have to be made."""
    ending = target.suffix.lower()
    if ending not in FASTEST:
        raise OutputError(
            f"{target}: {shown(target.suffix)} is not an animation format; give .gif, .mp4 or .html"
        )
    return _ffmpeg() if ending == ".mp4" else ""


def _reported(pictures: Iterator[Picture], total: int, progress: Progress | None) -> Iterator[Picture]:
    report = progress or silent
    for done, picture in enumerate(pictures, start=1):
        yield picture
        report(done, total)


def _course(motion: Motion, circuit: Circuit, frames: int) -> tuple[Floats, Floats]:
    """Where on the walk each picture is (frames,), and its time [s]; between stops where there are some."""
    path = walk(circuit)
    result = used_reach(TimedWalk(motion, circuit)) if motion.law is None else None
    if result is not None:
        return result.forth_and_back(frames)
    rows = _rows(motion, path, frames)
    return rows, np.interp(rows, np.arange(len(path.time)), path.time)


def _rows(motion: Motion, path: Walk, frames: int) -> Floats:
    """Where on the walk each picture stands: rows, with shares of the way to the next, (frames,)."""
    if motion.law is None:
        times = path.time[0] + (path.time[-1] - path.time[0]) * np.arange(frames) / frames
        return np.asarray(np.interp(times, path.time, np.arange(len(path.time))))
    once = path.time[path.passes[0]]
    return np.asarray(np.interp(np.linspace(once[0], once[-1], frames), once, np.arange(len(once))))


def _pictures(
    motion: Motion,
    circuit: Circuit,
    frame: Skeleton,
    seen: Projection,
    frames: int,
    size: tuple[float, float],
    heading: str,
) -> Iterator[Picture]:
    """The pictures (height, width, 3), one after the other; only what moves is drawn anew."""
    path = walk(circuit)
    ends = motion.input, motion.output
    figure = new_figure(*size)
    figure.set_dpi(DPI)
    width, height = size
    top = write_title(figure, heading)
    # two parts of the page: the linkage, and the curve of its output
    part = 0.6 * width
    foot = write_legend(figure, scene.keys(frame, ends, seen), centre=part / 2, width=part)
    space = ViewAxes(own_axes(figure, seen), seen)
    prepare(space, frame, (0.0, foot, part, height - top - foot))
    scene.stage(space, frame, ends)
    curve = figure.add_axes((0.1, 0.1, 0.1, 0.1))
    drawn = [line for line in output_curves.passes(motion) if line.circuit is circuit]
    output_curves.panel(curve, motion, drawn, "angle", "input")
    keys = output_curves.curve_keys([curve], drawn)
    keys_height = write_legend(figure, keys, centre=(part + width) / 2, width=width - part)
    em = letters() / 72
    room = (part + 6 * em, keys_height + 4 * em, width - part - 7.5 * em, height - top - keys_height - 8 * em)
    tall = min(room[3], 0.8 * room[2])
    bottom = room[1] + (room[3] - tall) / 2
    curve.set_position((room[0] / width, bottom / height, room[2] / width, tall / height))

    bars = scene.bars(space, frame, ends)
    named = frame.places[np.linspace(0, len(frame.places) - 1, NAMED_POSES).astype(int)]
    known = named[~np.isnan(named[:, : frame.solid]).any(axis=(1, 2))]
    page = Bbox.from_extents(0, foot * DPI, part * DPI, (height - top) * DPI)
    names = []
    if len(known):
        names = write_names(space, frame, known, within=page, distances=NEAR)
    (cursor,) = curve.plot([], [], color=INK, lw=1.0 * stroke(), zorder=5)
    (dot,) = curve.plot([], [], "o", color=INK, ms=7 * stroke(), zorder=6)
    place = room[0] / width, (bottom + tall + 0.7 * em) / height
    reading = figure.text(*place, "", fontsize=letters())
    moving: list[tuple[Callable[[Artist], None], Artist]] = [
        *((space.axes.draw_artist, artist) for artist, _ in bars),
        *((space.axes.draw_artist, text) for text, _ in names),
        (curve.draw_artist, cursor),
        (curve.draw_artist, dot),
        (figure.draw_artist, reading),
    ]
    # what is on top is drawn last
    moving.sort(key=lambda one: one[1].get_zorder() if one[1].axes is space.axes else 100)
    for _, artist in moving:
        artist.set_animated(True)
    canvas: Any = figure.canvas
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    count = np.arange(len(path.time))
    courses = ((motion.input, path.input), (motion.output, path.output))
    units = [f" {motion.linkage.length_unit}" if slides(motion, c) else "°" for c in ends]
    said = [shown_name(name, 14) for name in ends]
    for row, time in zip(*_course(motion, circuit, frames), strict=True):
        angle, output = (
            float(shown_value(motion, column, np.interp(row, count, values))) for column, values in courses
        )
        pose = frame.pose(float(row))
        scene.put(space, bars, pose)
        for text, where in names:
            if np.isfinite(pose[where]).all():
                text.xy = tuple(space.anchor(pose[where][None])[0])
        cursor.set_data([angle, angle], curve.get_ylim())
        dot.set_data([angle], [output])
        reading.set_text(
            f"t = {time:.3f} s   {said[0]} {_tenths(angle)}{units[0]}   {said[1]} {_tenths(output)}{units[1]}"
        )
        canvas.restore_region(still)
        for draw, artist in moving:
            draw(artist)
        yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()


def _write_gif(pictures: Iterator[Picture], file: Path, frames: int, fps: float) -> None:
    """A GIF that loops for ever; its clock ticks in 10 ms, so what is rounded off goes to the next one."""
    first = Image.fromarray(next(pictures)).quantize(dither=Image.Dither.NONE)
    colours = np.array(first.getpalette(), dtype=np.uint8).reshape(-1, 3)
    colours[(colours >= NEARLY_WHITE).all(axis=1)] = 255
    first.putpalette(colours.tobytes())
    others = (Image.fromarray(p).quantize(palette=first, dither=Image.Dither.NONE) for p in pictures)
    ticks = np.round(np.arange(frames + 1) * 100 / fps)
    durations = [int(step) * 10 for step in np.diff(ticks)]
    with file.open("wb") as out:
        first.save(out, format="GIF", save_all=True, append_images=others, duration=durations, loop=0)


def _ffmpeg() -> str:
    """The ffmpeg program: on the path, else the one that imageio-ffmpeg brings."""
    result = shutil.which("ffmpeg")
    if result is not None:
        return result
    try:
        return str(importlib.import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise MissingExtraError(
            "an .mp4 needs ffmpeg; install ffmpeg, or pip install 'sevenbar[movie]', or give a .gif"
        ) from None


def _write_mp4(
    pictures: Iterator[Picture], file: Path, fps: float, ffmpeg: str, target: Path, size: tuple[float, float]
) -> None:
    width, height = (round(side * DPI) for side in size)
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-"]
    result = ["-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", str(file)]
    command = [ffmpeg, "-y", "-loglevel", "error", *source, *result]
    with tempfile.TemporaryFile() as words:
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=words, stderr=words)
        feed = cast("IO[bytes]", process.stdin)
        try:
            for picture in pictures:
                try:
                    feed.write(picture.tobytes())
                except BrokenPipeError:  # ffmpeg has given up; its words say why
                    break
            with suppress(BrokenPipeError):
                feed.close()
            process.wait()
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
            with suppress(BrokenPipeError):
                feed.close()
        if process.returncode != 0:
            words.seek(0)
            last = words.read().decode(errors="replace").strip().splitlines()[-1:]
            raise OutputError(f"{target}: ffmpeg failed: {''.join(last) or process.returncode}")


def _tenths(value: float) -> str:
    """A number to one decimal, without a minus on 0."""
    return f"{round(value, 1) + 0.0:.1f}"
