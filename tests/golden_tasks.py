"""Design tasks whose designs are in the golden record: all kinds of wants and musts, in few starts."""

import io
import json
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from places import EXAMPLES
from sevenbar.description.gallery import text as gallery_text
from sevenbar.description.schema import TomlSchema, json_schema
from sevenbar.design.task.along import DesignAlong
from sevenbar.design.task.figures import musts_figure, want_figure
from sevenbar.design.task.file.reader import task_file
from sevenbar.design.task.file.schema import TaskForm
from sevenbar.design.task.front import pareto
from sevenbar.design.task.front_report import FrontFound, front_figure, front_report
from sevenbar.design.task.report import TaskDesigns, task_report
from sevenbar.design.task.search import designed
from sevenbar.errors import SevenbarError

DESIGN_EXAMPLES = EXAMPLES / "design"

#: A point of the coupler of the gallery's planar four-bar.
POINT = '[[point]]\nname = "P"\nlink = 2\nat = [-50, 0, 20]\n'

#: Tasks by name, of the file planar.toml; and how many starts each has.
TASKS = {
    "path": (
        2,
        """placement = "free"
[free]
"length_*" = "20:150"
"P.u" = "-90:0"
"P.v" = "-30:30"
[[want]]
kind = "path"
point = "P"
places = [[0, 100, 0], [20, 110, 0], [40, 108, 0], [55, 90, 0]]
weight = 2
[[must]]
kind = "range"
joint = "theta_2"
range = "-170:170deg"
[[must]]
kind = "most"
want = 1
most = "20mm"
""",
    ),
    "timed": (
        0,
        """goal = "minimax"
[free]
length_1 = "20:80"
length_2 = "60:150"
length_3 = "60:150"
"P.u" = "-90:0"
[[want]]
kind = "path"
point = "P"
places = [[-8, 10, 20], [-20, 14, 20], [-32, 8, 20]]
timing = [0, 20, 40]
phase = true
[[must]]
kind = "box"
low = [-200, -200, -100]
high = [200, 200, 100]
names = ["P"]
""",
    ),
    "dwell": (
        1,
        """[free]
length_1 = "30:60"
length_2 = "80:120"
length_3 = "60:95"
[[want]]
kind = "dwell"
range = "100:140deg"
[[want]]
kind = "figure"
name = "swing"
value = 50
unit = 10
[[must]]
kind = "figure"
name = "time_ratio"
most = 1.5
[[must]]
kind = "apart"
links = [1, 3]
least = "1mm"
""",
    ),
    "straight": (
        0,
        """[free]
length_1 = "30:60"
length_2 = "80:120"
"P.u" = "-90:0"
"P.v" = "-30:30"
[[want]]
kind = "straight"
point = "P"
range = "90:140deg"
length = 30
[[want]]
kind = "function"
pairs = [[0, 0], [20, 10], [40, 22]]
weight = 0.2
""",
    ),
    "poses": (
        1,
        """[free]
length_1 = "30:60"
length_2 = "80:120"
length_4 = "70:110"
[[want]]
kind = "poses"
link = 2
arm = 30
poses = [{ at = [95, 40, 0], angle = 95 }, { at = [80, 42, 0], angle = 105 }]
timing = [20, 40]
phase = true
exact = false
""",
    ),
    "cone": (
        0,
        """linkage = "rssr"
[free]
L1 = "240:260"
M = "640:760"
[[want]]
kind = "function"
pairs = [[0, 0], [20, 3], [40, 9]]
[[must]]
kind = "cone"
joint = "ball_a"
angle = "80deg"
[[must]]
kind = "cone"
joint = "ball_b"
angle = 75
""",
    ),
    "measure": (
        1,
        """[free]
length_1 = "30:60"
length_2 = "80:120"
[[want]]
kind = "measure"
name = "swing"
value = "great"
[[must]]
kind = "measure"
name = "transmission_lowest"
least = "30deg"
""",
    ),
}

FRONT = """[free]
length_1 = "35:45"
length_3 = "70:90"
[[want]]
kind = "function"
pairs = [[20, 60], [60, 90], [100, 130]]
[[want]]
kind = "figure"
name = "swing"
value = "small"
unit = 60
"""

#: Wrong tasks, each with mistakes of several kinds.
WRONG = {
    "kinds": "[free]\nlength_1 = '30:80'\n[[want]]\nkind = 'pth'\n[[must]]\nkind = 'conee'\n",
    "keys": """[free]
length_1 = "30:80"
[[want]]
kind = "dwell"
rang = "0:20"
[[want]]
kind = "poses"
link = 2
arm = -1
[[must]]
kind = "box"
low = [0, 0]
""",
    "values": """placement = "free"
[free]
length_1 = "30:80"
"P.u" = "-90:0"
[[want]]
kind = "dwell"
range = "20:0"
samples = 3
[[want]]
kind = "straight"
point = "Q"
range = "0:400"
[[want]]
kind = "figure"
name = "swng"
value = 3
[[want]]
kind = "function"
pairs = [[0, 0], [20, 10], [10, 22]]
exact = true
[[must]]
kind = "range"
joint = "theta_3"
range = "20:10"
[[must]]
kind = "cone"
joint = "theta_1"
angle = 10
[[must]]
kind = "box"
low = [0, 0, 0]
high = [10, 0, 10]
names = ["P", "R"]
[[must]]
kind = "apart"
links = [1, 2]
least = 4
[[must]]
kind = "figure"
name = "swing"
least = 20
most = 10
[[must]]
kind = "most"
want = 3
most = 4
""",
}


def cases():
    """Each case by name: a function that gives its text."""
    found = {f"task.{name}": partial(of_text, text, starts) for name, (starts, text) in TASKS.items()}
    found |= {f"task.{name}": partial(of_example, name) for name in ("steering",)}
    found |= {f"task.wrong_{name}": partial(wrong, text) for name, text in WRONG.items()}
    return found | {"task.front": front, "task.schema": task_schema, "linkage.schema": linkage_schema}


def linkage_schema():
    """The schema of a linkage file."""
    return json.dumps(_plain(json_schema()), indent=1) + "\n"


def task_schema():
    """The schema of a task file."""
    return json.dumps(_plain(TaskForm.model_json_schema(schema_generator=TomlSchema)), indent=1) + "\n"


def _plain(value):
    """A schema as newer pydantic writes it: 2.8 puts a reference with a description into allOf."""
    if isinstance(value, list):
        return [_plain(one) for one in value]
    if not isinstance(value, dict):
        return value
    (only,) = value["allOf"] if len(value.get("allOf", ())) == 1 else ({},)
    return {key: _plain(one) for key, one in sorted({**only, **value}.items()) if key != "allOf" or not only}


def _read(folder, text):
    (folder / "planar.toml").write_text(gallery_text("planar_4r") + POINT)
    head = "" if text.startswith("linkage") else 'linkage = "planar.toml"\n'
    (folder / "task.toml").write_text(head + text)
    return task_file(folder / "task.toml")


def wrong(text):
    """What is said of a wrong task."""
    with TemporaryDirectory() as folder:
        try:
            _read(Path(folder), text)
        except SevenbarError as error:
            return f"{error}\n".replace(folder, "folder")
    return "nothing is wrong\n"


def of_text(text, starts):
    """The designs of a task on the planar four-bar."""
    with TemporaryDirectory() as folder:
        return _designs(_read(Path(folder), text), starts).replace(folder, "folder")


def of_example(name):
    """The designs of a documented task, begun at its linkage alone."""
    return _designs(task_file(DESIGN_EXAMPLES / f"{name}_task.toml"), 0).replace(f"{DESIGN_EXAMPLES}/", "")


def _designs(read, starts):
    search = designed(read.task, count=1, starts=starts)
    found = TaskDesigns(search, read.name, read.source, starts, 0)
    report = task_report(read.task, 1, "sevenbar design task", ())
    said = _said(report, found)
    for design in search.designs[:1]:
        along = DesignAlong(read.task, design)
        figures = [want_figure(along, number) for number in range(len(read.task.sampled))]
        said += "".join(map(figure_text, [*figures, musts_figure(along)]))
    return said


def front():
    """A front of two wants."""
    with TemporaryDirectory() as folder:
        read = _read(Path(folder), FRONT)
        made = pareto(read.task, 1, "swing", points=3, starts=0)
        whole = FrontFound(made.found, read.name, read.source, 0, 0, front=made)
        report = front_report(read.task, 3, "sevenbar design task", ("svg",))
        files = {name: write for name, write in report.files.items() if name == "front.csv"}
        files["front.csv"](whole, Path(folder) / "front.csv")
        said = _said(report, whole) + (Path(folder) / "front.csv").read_text("utf-8")
        return (said + figure_text(front_figure(whole))).replace(folder, "folder")


def _said(report, found):
    out = io.StringIO()
    report.print(found, Console(file=out, width=110, color_system=None))
    with TemporaryDirectory() as folder:
        (Path(folder) / "out").mkdir()
        texts = []
        for name in ("design_1.toml", "summary.csv"):
            path = Path(folder) / name
            report.files[name](found, path)
            texts.append(path.read_text("utf-8") if path.exists() else "none\n")
    return f"{out.getvalue()}\n{report.json(found)}\n" + "".join(texts)


def figure_text(figure):
    """What a figure shows: its words, and the ends and the middle of each curve."""
    if figure is None:
        return "no figure\n"
    lines = [f"figure {[text.get_text() for text in figure.texts]} {figure.get_suptitle()!r}"]
    for axes in figure.axes:
        lines.append(f"{axes.get_title()!r} {axes.get_xlabel()!r} {axes.get_ylabel()!r}")
        for line in axes.get_lines():
            points = line.get_data_3d() if hasattr(line, "get_data_3d") else line.get_data()
            columns = [[float(value) for value in part] for part in points]
            rows = list(zip(*columns, strict=True))
            some = [rows[0], rows[len(rows) // 2], rows[-1]] if rows else []
            looks = f"{line.get_label()!r} {line.get_color()} {len(rows)}"
            lines.append(f"  {looks}: " + "; ".join(" ".join(f"{x + 0.0:.5g}" for x in row) for row in some))
    return "\n".join(lines) + "\n"
