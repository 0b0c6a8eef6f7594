"""The tutorial's and the quick start's pages as a newcomer reads them: files to write, commands to type, Python to run.

    python tests/tutorial_pages.py        writes what the commands print today, and the pictures
    python tests/tutorial_pages.py quick  the quick start's pages alone

Boxes of both pages are taken in order. A box `toml` begins with the name of its file; a box `console` has commands after `$`,
each with what it prints.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

from command_runs import sevenbar
from places import DOCS

PAGES = (DOCS / "tutorial.md", DOCS / "zh" / "tutorial.md")
QUICK = (DOCS / "quick-start.md", DOCS / "zh" / "quick-start.md")
IMAGES = DOCS / "images"
BOX = re.compile(r"^```(toml|console|python)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
#: Where in the newcomer's folder each picture comes from; that of the studio is taken by tests/docs/test_tutorial.py.
PICTURES = {
    "tutorial_configuration.png": "report/configuration.png",
    "tutorial_map_swing.png": "map/swing.png",
    "tutorial_map_time_ratio.png": "map/time_ratio.png",
    "tutorial_modes.png": "modes.png",
    "tutorial_path.png": "point/path_hose.png",
    "tutorial_tolerance.png": "tolerance/shares.png",
    "tutorial_guard.png": "guard/path_guard.png",
    "tutorial_flap.png": "flap/configuration.png",
    "tutorial_flap_modes.png": "flap/modes.png",
    "tutorial_wishbone.png": "wishbone/skeleton.png",
}
#: Width [pixels] and colours of a picture, so that a page stays light.
WIDTH, COLOURS = 1200, 220
#: What is left of rounding differs between machines; below this a difference is rounding.
ROUNDING = 1e-9
NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


def boxes(page):
    """The kind and the text of each box of a page that is run, in order."""
    return BOX.findall(page.read_text(encoding="utf-8"))


def commands(text):
    """The commands of a box `console`, each with the lines shown below it."""
    found = []
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append((line.removeprefix("$ "), []))
        else:
            found[-1][1].append(line)
    return found


def printed(command, folder):
    """What a command prints in a folder: lines without spaces at their ends; of a refusal the complaint."""
    program, *words = shlex.split(command)
    assert program == "sevenbar", command
    run = sevenbar(*words, cwd=folder)
    assert run.returncode in (0, 2), run.stderr
    text = run.stdout if run.returncode == 0 else run.stderr
    return [line.rstrip() for line in text.strip("\n").splitlines()]


def alike(shown, today):
    """Whether two lines say the same: words equal, numbers to two of their last places, errors to their size."""
    version = re.compile(r"(Exudyn|MuJoCo) [\d.]+")
    shown, today = (version.sub(r"\1", line) for line in (shown, today))
    if [*re.split(NUMBER, shown.replace(" ", ""))] != [*re.split(NUMBER, today.replace(" ", ""))]:
        return False
    if "[" in shown and "e-" in shown:
        # where an error of an engine is greatest depends on its rounding
        shown, today = (re.sub(r"[\d.]+°", "°", line) for line in (shown, today))
    for one, other in zip(re.findall(NUMBER, shown), re.findall(NUMBER, today), strict=True):
        if "e" in one + other:
            first, second = (max(abs(float(text)), ROUNDING) for text in (one, other))
            if not 1 / 10 < first / second < 10:
                return False
        elif abs(float(one) - float(other)) > ("." in one) * 2.01 * 10 ** -len(one.partition(".")[2]):
            return False
    return True


def as_today(text, folder):
    """How many commands a box `console` has, each of which must print in a folder what is shown below it."""
    found = commands(text)
    for command, shown in found:
        today = printed(command, folder)
        while shown and not shown[-1]:
            shown.pop()
        assert len(shown) == len(today), command
        for line, other in zip(shown, today, strict=True):
            assert alike(line, other), f"{command}\nshown {line}\ntoday {other}"
    return len(found)


def spoken(code, folder):
    """What a box `python` prints."""
    run = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True)
    return run.stdout.splitlines()


def write_file(text, folder):
    """Write the file that a box `toml` shows, by the name in its first line."""
    name = re.match(r"# ([a-z]+\.toml)\n", text)[1]
    (folder / name).write_text(text, encoding="utf-8")


def told_today(page, folder):
    """The page as it would be today, its commands run in an empty folder."""

    def today(box):
        kind, text = box.groups()
        if kind == "toml":
            write_file(text, folder)
        if kind != "console":
            return box[0]
        parts = ["\n".join([f"$ {command}", *printed(command, folder)]) for command, _ in commands(text)]
        return "```console\n" + "\n\n".join(parts) + "\n```"

    return BOX.sub(today, page.read_text(encoding="utf-8"))


def make_light(source, target):
    """A picture of the width and colours of the page, from a file that a command drew."""
    picture = Image.open(source).convert("RGB")
    if picture.width > WIDTH:
        picture = picture.resize(
            (WIDTH, round(picture.height * WIDTH / picture.width)), Image.Resampling.LANCZOS
        )
    picture.quantize(COLOURS, dither=Image.Dither.NONE).save(target, optimize=True)


def write_anew(pages, folder):
    """Write a page, its commands run in an empty folder, and the page that shows the same in the other language."""
    first, second = pages
    first.write_text(told_today(first, folder), encoding="utf-8")
    # what stands below its commands is copied
    shown = iter([text for kind, text in boxes(first) if kind == "console"])
    copied = BOX.sub(
        lambda box: f"```console\n{next(shown)}```" if box[1] == "console" else box[0],
        second.read_text(encoding="utf-8"),
    )
    second.write_text(copied, encoding="utf-8")


def main():
    """Write the pages and the pictures anew; with `quick` the quick start's alone."""
    with tempfile.TemporaryDirectory() as name:
        write_anew(QUICK, Path(name))
    if "quick" in sys.argv[1:]:
        return
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_anew(PAGES, folder)
        for picture, source in PICTURES.items():
            make_light(folder / source, IMAGES / picture)


if __name__ == "__main__":
    main()
