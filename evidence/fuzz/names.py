"""`python -m evidence.fuzz.names`: names that are code elsewhere, in every kind of file that is written.

Each name is that of a linkage, its joints and a point. Every file must be read by a program for its kind,
hold the names, and no element, formula or script of theirs; with `--pages` pages that play are opened in
Chromium, where no dialog may open, no script may fail, and the film must play.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import tempfile
import tomllib
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.drawing import plot
from sevenbar.drawing.animate import animate
from sevenbar.errors import DescriptionError
from sevenbar.export import export
from sevenbar.reporting import report
from sevenbar.text.csv_cells import NUMBER
from sevenbar.text.table import NO_NUMBER

#: Names that HTML, scripts, spreadsheets, TeX, shells, XML, ADAMS, rich or format strings read as more.
NAMES = (
    "<svg onload=alert(1)>", "<script>alert(1)</script>", "</script><script>alert(1)</script>",
    "<!--<script>", "<!--", "-->", "]]>", "<![CDATA[<script>alert(1)</script>]]>",
    "<img src=x onerror=alert(1)>", "</title><svg/onload=alert(1)>", "</style><svg/onload=alert(1)>",
    "</textarea><svg/onload=alert(1)>", '"><svg/onload=alert(1)>', "' onmouseover='alert(1)",
    "&lt;svg onload=alert(1)&gt;", "&#60;svg/onload=alert(1)&#62;", "javascript:alert(1)", "${alert(1)}",
    "`${alert(1)}`", "\\u003csvg onload=alert(1)\\u003e", "\\", '\\"', "';alert(1);//", '";alert(1);//',
    "@FILM@", "@HEADING@", "@TITLE@ @PAUSE@", "{quantity}", "{0.__class__}", "%s%n%(x)s", "$&$`$'",
    "=cmd|'/C calc'!A0", "+1+1", "-2+3", "@SUM(1)", "a;=1+1", "'=1", "$\\frac{1}{0}$",
    "\\input{/etc/passwd}", "_a^b", "[red]x[/red]", "[link=file:///etc/passwd]x[/link]", "`rm -rf`; $(id)",
    "../../x", "C:\\x", "CON", "!ADAMS &", "a = 'b'", "__proto__", "constructor", "联杆“”", "é̀", "𝕏", "🦀",
    "null", "NaN", "x" * 200,
)  # fmt: skip

#: Names that no file takes: what is not printed, and too much.
REFUSED = ("a\nb", "\x1b[31mx", "a\x00b", "\u202eabc", "\u2028", "a\tb", "x" * 201, "", " ")


def linkage_of(name: str) -> sb.Linkage:
    """A slider-crank whose own name, joints and point are called so."""
    cut = name[:190]
    places = ((0, 0, 0), (40, 0, 0), (180, 0, 0), (180, 0, 0))
    joints = [
        {
            "name": f"{cut} {i}" if i else cut,
            "kind": "RRRP"[i],
            "at": at,
            "axis": (1, 0, 0) if i == 3 else (0, 0, 1),
        }
        for i, at in enumerate(places)
    ]
    points = [{"name": f"{cut} p", "link": 2, "at": (90, 10, 0)}]
    return sb.from_axes(joints, name=name, points=points)


def _csv(path: Path, _: sb.Linkage) -> None:
    rows = list(csv.reader(path.read_text(encoding="utf-8").splitlines()))
    assert len({len(row) for row in rows}) == 1
    for mark in ",;":
        for row in csv.reader(path.read_text(encoding="utf-8").splitlines(), delimiter=mark):
            assert not [c for c in row if c[:1] in ("=", "+", "-", "@") and not NUMBER.fullmatch(c)]


def _xlsx(path: Path, linkage: sb.Linkage) -> None:
    from openpyxl import load_workbook

    kinds = {cell.data_type for sheet in load_workbook(path) for row in sheet for cell in row}
    assert kinds <= {"s", "n"}
    # "null" and "NaN" are empty cells in every table, and a joint without a name has that of its place
    expected = [
        f"theta_{number}" if name.lower() in NO_NUMBER else name
        for number, name in enumerate(linkage.columns, 1)
    ]
    assert list(sb.load(path).columns) == expected


def _parquet(path: Path, linkage: sb.Linkage) -> None:
    from pyarrow.parquet import read_table

    assert f"{linkage.columns[0]}_deg" in read_table(path).column_names


def _npz(path: Path, linkage: sb.Linkage) -> None:
    assert list(np.load(path, allow_pickle=False)["columns"]) == list(linkage.columns)


def _mat(path: Path, linkage: sb.Linkage) -> None:
    from scipy.io import loadmat

    assert list(loadmat(path, simplify_cells=True)["columns"]) == list(linkage.columns)


def _json(path: Path, linkage: sb.Linkage) -> None:
    assert json.loads(path.read_text(encoding="utf-8"))["linkage"]["name"] == linkage.name


def _xml(path: Path, _: sb.Linkage) -> None:
    tags = {element.tag.rpartition("}")[2] for element in ET.parse(path).iter()}
    assert not tags & {"script", "img", "foreignObject"}


def _text(path: Path, _: sb.Linkage) -> None:
    assert path.read_text(encoding="utf-8").strip()


def _bytes(path: Path, _: sb.Linkage) -> None:
    assert path.read_bytes()


def _page(path: Path, _: sb.Linkage) -> None:
    content = path.read_text(encoding="utf-8").lower()
    assert content.count("<script>") == content.count("</script>") == 1
    assert "<!--" not in content
    assert "<svg" not in content
    assert "<img" not in content


#: The kinds of export, each with what reads it.
EXPORTS: dict[str, Callable[[Path, sb.Linkage], None]] = {
    "csv": _csv, "xlsx": _xlsx, "parquet": _parquet, "npz": _npz, "mat": _mat, "json": _json, "urdf": _xml,
    "mjcf": _xml, "cmd": _text, "glb": _bytes, "stl": _bytes, "step": _bytes,
}  # fmt: skip

#: Kinds of which one file takes a second or more.
SLOW = ("glb", "stl", "step")


def written(name: str, folder: Path, *, slow: bool) -> Iterator[tuple[str, Path]]:
    """Each kind of file with a name in it, read by a program for it; raises what is wrong."""
    linkage = linkage_of(name)
    motion = linkage.motion(36)
    for kind, check in EXPORTS.items():
        if slow or kind not in SLOW:
            for path in export(motion, kind, folder / f"m.{kind}", force=True):
                assert path.resolve().is_relative_to(folder.resolve())
                if path.suffix == f".{kind}" or kind == "mjcf":
                    check(path, linkage)
            yield kind, path
    draft = Draft.of_linkage(linkage).toml()
    assert tomllib.loads(draft)["name"] == name
    assert sb.loads(draft).columns == linkage.columns
    yield "toml", folder
    assert report.markdown(motion)
    assert f"{motion}{linkage}"
    assert "<svg" not in motion.circuits[0]._repr_html_()
    yield "report", folder
    for figure in ("svg", "pdf") if slow else ("svg",):
        path = plot.save(plot.curves(motion), folder / f"curves.{figure}")
        (_xml if figure == "svg" else _bytes)(path, linkage)
        yield figure, path
    yield "html", page_of(name, folder)


def page_of(name: str, folder: Path) -> Path:
    """The page that plays of the linkage of a name."""
    linkage = linkage_of(name)
    path = animate(linkage.motion(36), folder / "film.html", seconds=1, fps=4)
    _page(path, linkage)
    return path


def wrong_on(browser: Any, path: Path) -> list[str]:
    """What goes wrong on a page that plays: dialogs, errors, requests, a film that stands still."""
    found: list[str] = []
    asked: list[str] = []
    page = browser.new_page()
    page.on("dialog", lambda dialog: (found.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    page.on("pageerror", lambda error: found.append(f"error: {error}"))
    page.on(
        "request", lambda asked: None if asked.url == path.as_uri() else found.append(f"request: {asked.url}")
    )
    page.goto(path.as_uri())
    first = page.evaluate("picture")
    try:
        page.wait_for_function(f"picture !== {first}", timeout=10_000)
    except Exception as error:
        found.append(f"stands still: {error}")
    page.close()
    return found + [f"request: {url}" for url in asked if url != path.as_uri()]


def main() -> int:
    """Prints how many files there were of each kind, and what was wrong; 1 where anything was."""
    parser = argparse.ArgumentParser(prog="python -m evidence.fuzz.names", description=__doc__)
    parser.add_argument("--slow", action="store_true", help="CAD and mesh files, too")
    parser.add_argument("--pages", action="store_true", help="open the pages in Chromium")
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    faults: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        pages = []
        for number, name in enumerate(NAMES):
            own = Path(folder) / str(number)
            own.mkdir()
            try:
                for kind, path in written(name, own, slow=given.slow):
                    counts[kind] += 1
                    pages += [path] if kind == "html" else []
            except Exception as error:
                faults.append(f"{name[:40]!r}: {type(error).__name__}: {str(error)[:300]}")
        for name in REFUSED:
            try:
                linkage_of(name)
                faults.append(f"{name!r} is taken")
            except DescriptionError:
                counts["refused"] += 1
        if given.pages:
            sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
            from browser import launched

            with launched() as browser:
                for path in pages:
                    counts["opened"] += 1
                    faults += [
                        f"{NAMES[int(path.parent.name)]!r}: {what}" for what in wrong_on(browser, path)
                    ]
    print(f"{len(NAMES)} names: {dict(counts)}")
    print("\n".join(faults) or "nothing wrong")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
