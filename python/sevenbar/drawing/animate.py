"""Animations of a motion: the linkage moving in space beside the curve of its output, as GIF or MP4."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, cast

import numpy as np
import numpy.typing as npt
from matplotlib import rc_context
from matplotlib.artist import Artist
from PIL import Image

from sevenbar.arrays import Floats
from sevenbar.drawing import plot, scene
from sevenbar.drawing.figure import STYLE, new_figure, shown_value, slides, title, written_whole
from sevenbar.drawing.skeleton import skeleton
from sevenbar.errors import MissingExtraError, OutputError, RequestError, shown
from sevenbar.kinematics.circuits import Circuit
from sevenbar.kinematics.motion import Motion, chosen_circuit
from sevenbar.kinematics.poses import Walk, walk

Picture = npt.NDArray[np.uint8]

#: Size of a picture [inch] and its resolution; the pixels come out even, as video wants them.
SIZE, DPI = (11.2, 6.4), 100
MOST_FRAMES = 10_000
#: Colours of a GIF from here on are white, lest Pillow, which looks colours up in steps of 4, tint the page.
NEARLY_WHITE = 249
#: The greatest frame rates [1/s]: browsers slow down GIF pictures shorter than 20 ms.
FASTEST = {".gif": 50.0, ".mp4": 240.0}


def animate(
    motion: Motion,
    path: str | os.PathLike[str],
    *,
    circuit: int = 0,
    frames: int = 120,
    fps: float = 25,
    progress: Callable[[int, int], object] | None = None,
) -> Path:
    """Writes one cycle of a circuit, evenly in time, as GIF or MP4 by the path's ending; returns the path.

    `frames` pictures are shown at `fps` [1/s]. A rocking circuit goes forth and back; the last picture leads
    over to the first, save where a law drives: then the law is run once. `progress(done, total)` is called
    after each picture.

    Raises `RequestError` for a circuit, count or rate that is not offered, `OutputError` for another ending
    and where the file cannot be written (then nothing is left behind), `MissingExtraError` for MP4 without
    ffmpeg.
    """
    target = Path(path)
    ffmpeg = check_target(target)
    ending = target.suffix.lower()
    chosen = chosen_circuit(motion, circuit)
    if (
        isinstance(frames, bool)
        or not isinstance(frames, (int, np.integer))
        or not 2 <= frames <= MOST_FRAMES
    ):
        raise RequestError(f"frames: {shown(frames)} is not a count; give 2 to {MOST_FRAMES}")
    if (
        isinstance(fps, bool)
        or not isinstance(fps, (int, float, np.number))
        or not 0.1 <= fps <= FASTEST[ending]
    ):
        raise RequestError(
            f"fps: {shown(fps)} is not offered; give 0.1 to {FASTEST[ending]:g} for a {ending} file"
        )
    with written_whole(target) as file, rc_context(STYLE):
        pictures = _reported(_pictures(motion, chosen, int(frames)), int(frames), progress)
        if ending == ".gif":
            _write_gif(pictures, file, int(frames), float(fps))
        else:
            _write_mp4(pictures, file, float(fps), ffmpeg, target)
    return target


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
        raise OutputError(f"{target}: {shown(target.suffix)} is not an animation format; give .gif or .mp4")
    return _ffmpeg() if ending == ".mp4" else ""


def _reported(
    pictures: Iterator[Picture], total: int, progress: Callable[[int, int], object] | None
) -> Iterator[Picture]:
    for done, picture in enumerate(pictures, start=1):
        yield picture
        if progress is not None:
            progress(done, total)


def _rows(motion: Motion, path: Walk, frames: int) -> Floats:
    """Where on the walk each picture stands: rows, with shares of the way to the next, (frames,)."""
    if motion.law is None:
        times = path.time[0] + (path.time[-1] - path.time[0]) * np.arange(frames) / frames
        return np.asarray(np.interp(times, path.time, np.arange(len(path.time))))
    once = path.time[path.passes[0]]
    return np.asarray(np.interp(np.linspace(once[0], once[-1], frames), once, np.arange(len(once))))


def _pictures(motion: Motion, circuit: Circuit, frames: int) -> Iterator[Picture]:
    """The pictures (height, width, 3), one after the other; only what moves is drawn anew."""
    path, frame = walk(circuit), skeleton(motion, circuit)
    ends = motion.input, motion.output
    figure = new_figure(*SIZE)
    figure.set_dpi(DPI)
    space = figure.add_axes((0.0, 0.02, SIZE[1] / SIZE[0], 1.0), projection="3d")
    scene.stage(space, frame, ends)
    scene.label(space, frame, frame.pose(0), frame.standing)
    curve = figure.add_axes((0.65, 0.3, 0.32, 0.5))
    drawn = [line for line in plot.passes(motion) if line.circuit is circuit]
    plot.panel(curve, motion, drawn, "angle", "input")
    figure.suptitle(f"{title(motion)}\ncircuit {circuit.index}", fontsize=11)
    figure.legend(handles=scene.keys(frame, ends), loc="lower left", ncols=4, frameon=False)
    keys = plot.curve_keys([curve], drawn)
    figure.legend(handles=keys, loc="upper center", bbox_to_anchor=(0.81, 0.2), ncols=2, frameon=False)

    bars = scene.bars(space, frame, ends)
    (cursor,) = curve.plot([], [], color="#303030", lw=1.0, zorder=5)
    (dot,) = curve.plot([], [], "o", color="#303030", ms=7, zorder=6)
    reading = figure.text(0.65, 0.83, "", fontsize=10)
    moving: list[tuple[Callable[[Artist], None], Artist]] = [
        *((space.draw_artist, artist) for artist, _ in bars),
        (curve.draw_artist, cursor),
        (curve.draw_artist, dot),
        (figure.draw_artist, reading),
    ]
    for _, artist in moving:
        artist.set_animated(True)
    canvas: Any = figure.canvas
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    count = np.arange(len(path.time))
    courses = ((motion.input, path.input), (motion.output, path.output))
    units = [f" {motion.linkage.length_unit}" if slides(motion, c) else "°" for c in ends]
    for row in _rows(motion, path, frames):
        angle, output = (
            float(shown_value(motion, column, np.interp(row, count, values))) for column, values in courses
        )
        scene.put(bars, frame.pose(float(row)))
        cursor.set_data([angle, angle], curve.get_ylim())
        dot.set_data([angle], [output])
        time = float(np.interp(row, count, path.time))
        reading.set_text(f"t = {time:.3f} s    input {angle:.1f}{units[0]}    output {output:.1f}{units[1]}")
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
    found = shutil.which("ffmpeg")
    if found is not None:
        return found
    try:
        return str(importlib.import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise MissingExtraError(
            "an .mp4 needs ffmpeg; install ffmpeg, or pip install 'sevenbar[movie]', or give a .gif"
        ) from None


def _write_mp4(pictures: Iterator[Picture], file: Path, fps: float, ffmpeg: str, target: Path) -> None:
    width, height = (round(side * DPI) for side in SIZE)
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
