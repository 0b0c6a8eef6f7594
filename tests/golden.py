"""What commands print, and what figures show, of the whole gallery: the record, and how it is compared.

A change of the code that changes no answer changes nothing here. Where an answer is meant to change, write
the record anew with `make golden`, read what `git diff` shows of it, and name it in the changelog.
"""

import math
import os
import re
import sys
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl
import numpy as np
import trimesh

import golden_tasks
import sevenbar as sb
from command_runs import sevenbar
from places import ROOT, TESTS
from sevenbar.description.gallery import loops
from sevenbar.drawing import plot
from sevenbar.export.tables import write_csv

#: The record, a file a case.
FOLDER = TESTS / "golden_record"


#: At most so many lines of a table are kept, spread over it.
ROWS = 12

#: A curve is kept at so many points, spread over it.
POINTS = 7

#: Numbers of results agree to this, relative to themselves or to 1: other processors round otherwise.
AGREE = 1e-9

NUMBER = re.compile(r"(?<![A-Za-z_\d.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")

#: Searches whose end is flat, and the vector unit that each record is made with: rounding decides where they end,
#: and other units round otherwise.
FLAT = {"task.path": "avx512", "task.straight": "avx512", "task.front": "avx2", "commands.function": "avx512"}

#: Linkages whose files say what acts on them.
LOADED = ("engine", "rssr_press", "seven_r_bodies")

#: Commands that are run on one linkage.
SINGLE = {
    "analyze_rocker": ("analyze", "rssr", "--input", "rocker", "--json"),
    "analyze_ranges": ("analyze", "seven_r", "--ranges"),
    "analyze_net": ("analyze", "watt"),
    "analyze_net_json": ("analyze", "watt", "--json"),
    "modes_net": ("modes", "watt", "--at", "10deg"),
    "analyze_chinese": ("analyze", "planar_4r", "--lang", "zh"),
    "modes_slider": ("modes", "rssp", "--input", "slider", "--at=-20mm"),
    "axodes_between": ("axodes", "planar_4r", "--link", "2", "--relative-to", "1"),
    "forces_speed": ("forces", "rssr_press", "--speed", "90 rpm", "--unevenness", "0.02", "--json"),
    "forces_pose": ("forces", "engine", "--at", "45deg"),
    "free": ("free", "rssr_press", "--time", "1s", "--from", "30deg", "--json"),
    "compare": ("compare", "rssr", "examples/rssr_table1.csv"),
    "calibrate": (
        *("calibrate", "rssr", "examples/rssr_bench.csv", "--hold", "D", "--offset", "input,output"),
        "--json",
    ),
    "tolerance": ("tolerance", "rssr", "--tolerance", "L*=0.5mm", "--tolerance", "M=1", "--json"),
    "map": ("map", "rssr", "--over", "L1=100:400", "--over", "L3=300:800"),
    "swing": ("design", "swing", "--swing", "60deg", "--time-ratio", "1.2", "--json"),
    "point": ("design", "point", "seven_r", "--link", "4", "--box=-200:200,-200:200,-200:200", "--json"),
    "inertia": ("design", "inertia", "seven_r", "--mass", "P=2.5", "--json"),
    "function": ("design", "function", "--y", "log10(x)", "--x", "1:2", "--points", "5", "--designs", "2"),
    "path": (
        *("design", "path", "planar_4r", "--path", "examples/coupler_curve.csv", "--link", "2"),
        *("--at", "0,-50,20", "--vary", "length_*", "--designs", "1", "--starts", "2"),
    ),
    "survey": (
        *("design", "survey", "--output-range", "0:23.75deg", "--ball-angle", "15deg"),
        *("--count", "2000", "--seed", "1"),
    ),
    "sweep": ("sweep", "rssr", "--over", "L1=200:600:5", "--over", "L3=400,450", "--json"),
}

#: Tables of exact tasks, and how each is asked.
EXACT = {
    "planar": ("x [mm],y [mm],turn_z [rad]\n0,0,0\n4,1,0.4\n7,4,0.9\n9,8,1.3\n", ()),
    "spherical": (
        "turn_x [deg],turn_y [deg],turn_z [deg]\n0,0,0\n10,4,9\n-6,23,40\n",
        ("--moving", "0,0,1", "--moving", "1,0,1"),
    ),
    "pairs": (
        "input [deg],output [deg]\n0,0\n40,20\n80,50\n",
        ("--twist", "90deg", "--zeros", "30deg,90deg"),
    ),
}

#: Files that are written from a linkage: the linkage, the ending, and what else is asked.
FILES = {
    "mjcf": ("rssr", ".xml", ("--at", "40")),
    "mjcf_motor": ("rscr", ".xml", ("--drive", "motor")),
    "urdf": ("rsur", ".urdf", ()),
    "adams": ("planar_4r", ".cmd", ("--at", "0.5rad")),
    "table_si": ("rssp", ".csv", ("--units", "si", "--samples", "12")),
    "glb": ("planar_4r", ".glb", ()),
}


def cases():
    """Each case by name: a function that gives its text."""
    found = {}
    for name in loops():
        found[f"{name}.analyze"] = partial(printed, "analyze", name)
        found[f"{name}.analyze.json"] = partial(printed, "analyze", name, "--json")
        found[f"{name}.modes"] = partial(printed, "modes", name, "--at", where(name))
        found[f"{name}.modes.json"] = partial(printed, "modes", name, "--at", where(name), "--json")
        found[f"{name}.axodes.json"] = partial(printed, "axodes", name, "--json")
        found[f"{name}.csv"] = partial(exported, name)
        found[f"{name}.figures"] = partial(drawn, name)
    for name in LOADED:
        found[f"{name}.forces"] = partial(printed, "forces", name)
        found[f"{name}.forces.json"] = partial(printed, "forces", name, "--json")
    for name, (table, words) in EXACT.items():
        found[f"exact.{name}"] = partial(solved, table, words)
    for name, (linkage, ending, words) in FILES.items():
        found[f"export.{name}"] = partial(written, linkage, ending, words)
    found |= golden_tasks.cases()
    return found | {f"commands.{name}": partial(printed, *words) for name, words in SINGLE.items()}


def where(name):
    """An input within the first circuit's range, on no grid."""
    linkage = sb.load(name)
    ends = linkage.motion(24).circuits[0].pass_range(0) or (0.0, 2.0)
    unit = linkage.unit_of(linkage.input_column(None))
    value = ends[0] + 0.37 * (ends[1] - ends[0])
    return f"{value:.4f}rad" if unit == "rad" else f"{value:.4f}{linkage.length_unit}"


def printed(*words):
    """How a command ends, and what it prints."""
    os.environ["COLUMNS"] = "80"
    run = sevenbar(*words, cwd=ROOT)
    text = f"exit {run.returncode}\n{run.stdout}{run.stderr}".replace(sb.__version__, "VERSION")
    text = re.sub(r'"simd_level": "\w+"', '"simd_level": "OF THE MACHINE"', text)
    # parts of sweeps hold the version, so their checksums do
    return re.sub(r'"checksum": "[0-9a-f]+"', '"checksum": "OF VERSION"', text)


def solved(table, words):
    """All answers to a table of pairs or poses."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "task.csv"
        file.write_text(table, encoding="utf-8")
        return printed("design", "exact", str(file), *words).replace(folder, "")


def written(linkage, ending, words):
    """The files that an export writes; of a binary one the bodies, with where they lie and their volume."""
    lines = []
    with TemporaryDirectory() as folder:
        run = sevenbar("export", linkage, "--out", Path(folder) / f"out{ending}", *words)
        lines.append(f"exit {run.returncode}\n{run.stdout}{run.stderr}".replace(folder, "").rstrip())
        for file in sorted(Path(folder).iterdir()):
            lines.append(f"-- {file.name}")
            lines += bodies(file) if file.suffix == ".glb" else file.read_text("utf-8").splitlines()
    return "\n".join(lines) + "\n"


def bodies(file):
    """Each body of a GLB: name, corners of its box, volume."""
    for name, mesh in sorted(trimesh.load(file, force="scene").geometry.items()):
        corners = " ".join(f"{number + 0.0:.6f}" for number in mesh.bounds.ravel())
        yield f"{name}: {corners}; {mesh.volume:.6g}"


def exported(name):
    """The motion as a table: its columns, and rows of it."""
    motion = sb.load(name).motion(72)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "motion.csv"
        write_csv(motion, file, "file")
        lines = file.read_text("utf-8").splitlines()
    rows = lines[1:]
    return "\n".join([lines[0], *rows[:: max(1, len(rows) // ROWS)]]) + "\n"


def drawn(name):
    """What the figures of a motion show: titles, labels, legends, and points of each curve."""
    motion = sb.load(name).motion(72)
    draw = {"curves": plot.curves, "joints": plot.joints, "configuration": plot.configuration}
    if motion.circuits[0].transmission_angle is not None:
        draw["transmission"] = plot.transmission
    lines = []
    with mpl.rc_context():
        for kind, function in draw.items():
            figure = function(motion)
            for axes in figure.axes:
                lines.append(f"{kind}: {axes.get_title()!r} {axes.get_xlabel()!r} {axes.get_ylabel()!r}")
                legend = axes.get_legend()
                lines.append(f"  legend {[text.get_text() for text in legend.get_texts()] if legend else []}")
                lines += [f"  {line}" for line in sorted(map(_curve, axes.get_lines()))]
    return "\n".join(lines) + "\n"


def _curve(line):
    points = line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()
    values = np.array([np.asarray(part, dtype=float) for part in points]).T
    spread = np.linspace(0, max(len(values) - 1, 0), min(POINTS, len(values)))
    chosen = values[spread.round().astype(int)]
    return f"{line.get_label()!r} {len(values)}: " + "; ".join(
        " ".join(f"{number + 0.0:.7g}" for number in point) for point in chosen
    )


def difference(text, record):
    """The first line that says something else, as a message; empty where none does."""
    lines, kept = text.splitlines(), record.splitlines()
    for i, (line, other) in enumerate(zip(lines, kept, strict=False), 1):
        if line != other and not _agree(line, other):
            return f"line {i}:\n  now    {line}\n  record {other}"
    if len(lines) != len(kept):
        return f"{len(lines)} lines, not {len(kept)}"
    return ""


def _agree(line, other):
    """Whether two lines say the same, but for rounding in the last digit that is printed."""
    if "".join(NUMBER.sub("#", line).split()) != "".join(NUMBER.sub("#", other).split()):
        return False
    return all(map(_near, NUMBER.findall(line), NUMBER.findall(other)))


def _near(word, other):
    value, kept = float(word), float(other)
    digits = other.lower().partition("e")[0].partition(".")[2]
    scale = 10.0 ** int(other.lower().partition("e")[2] or 0)
    last = 1.5 * 10.0 ** -len(digits) * scale if digits else 0.0
    # errors of closing are rounding itself
    return math.isclose(value, kept, rel_tol=AGREE, abs_tol=max(AGREE, last if len(digits) < 9 else 0.0))


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    wanted = cases()
    for old in FOLDER.glob("*.txt"):
        if old.stem not in wanted:
            old.unlink()
    for case, told in wanted.items():
        if not sys.argv[1:] or any(part in case for part in sys.argv[1:]):
            (FOLDER / f"{case}.txt").write_text(told(), encoding="utf-8")
