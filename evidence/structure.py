"""How large Sevenbar is and how its parts lie: lines, and the rooms and floors of what knows what.

python -m evidence.structure [ROOT], of another checkout where one is given

A *room* is a folder or module that lies directly in the package (or in the core's `src`), an *arrow* is that
one room imports from another, type-only imports counted; a room's *floor* is the longest chain of arrows
below it. An arrow goes *up* against the order of pyproject.toml. A *circle* is a set of siblings, at any
depth, that reach one another.
"""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path

from evidence import ROOT

#: What is counted, and where it lies; evidence had no folder of its own once.
PARTS = {
    "product, Python": ("python/sevenbar", "*.py"),
    "core, Rust": ("crates/sevenbar-core/src", "*.rs"),
    "binding, Rust": ("crates/sevenbar-python/src", "*.rs"),
    "evidence": ("{evidence,accuracy,benches,fuzz}", "*.py"),
    "tests": ("tests", "*.py"),
}

#: What a module knows; names are in parts from the root down, as ("loops", "chain").
Name = tuple[str, ...]
Graph = Mapping[Name, set[Name]]


def lines(root: Path) -> dict[str, tuple[int, int]]:
    """Files and lines of each part."""
    counted = {}
    for part, (folder, pattern) in PARTS.items():
        names = folder.strip("{}").split(",")
        files = [file for name in names for file in sorted((root / name).rglob(pattern))]
        counted[part] = len(files), sum(len(file.read_text("utf-8").splitlines()) for file in files)
    return counted


def python_graph(root: Path) -> Graph:
    """The package's modules, without its face: that knows all, and commands may ask it."""
    import grimp

    sys.path.insert(0, str(root / "python"))
    try:
        found = grimp.build_graph("sevenbar", exclude_type_checking_imports=False, cache_dir=None)
    finally:
        sys.path.pop(0)
    below = {module: tuple(module.split(".")[1:]) for module in found.modules}
    return {
        name: {below[known] for known in found.find_modules_directly_imported_by(module)} - {(), name}
        for module, name in below.items()
        if name
    }


#: Comments and texts of Rust, which hold no paths.
_NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"', re.DOTALL)
_USE = re.compile(r"\buse\s+([^;]+);")
_RE_EXPORT = re.compile(r"\bpub(\([^)]*\))?\s+use\s+[^;]+;")
_PATH = re.compile(r"\b(?:crate|super)(?:::\w+)+")


def rust_graph(root: Path) -> Graph:
    """The core's modules by the paths that begin at `crate` or `super`; re-exports and tests left out."""
    source = root / PARTS["core, Rust"][0]
    files = {_rust_name(file, source): file for file in sorted(source.rglob("*.rs"))}
    files = {name: file for name, file in files.items() if name and name[-1] != "tests"}
    graph = {}
    for name, file in files.items():
        code = _NO_CODE.sub(" ", file.read_text("utf-8")).partition("#[cfg(test)]\nmod tests {")[0]
        code = _RE_EXPORT.sub(" ", code)
        used = chain.from_iterable(_expanded(tree) for tree in _USE.findall(code))
        paths = {_absolute(path, name) for path in chain(used, _PATH.findall(_USE.sub(" ", code)))}
        graph[name] = {_module(path, files) for path in paths} - {(), name}
    return graph


def _rust_name(file: Path, source: Path) -> Name:
    parts = file.relative_to(source).with_suffix("").parts
    return parts[:-1] if parts[-1] in ("mod", "lib") else parts


def _expanded(tree: str) -> Iterator[str]:
    """The paths of a `use`: a::{b, c::{d}} is a::b and a::c::d."""
    head, brace, inner = tree.strip().partition("{")
    if not brace:
        yield head.split(" as ")[0].strip()
        return
    depth, begin = 0, 0
    inner = inner.rpartition("}")[0] + ","
    for place, letter in enumerate(inner):
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            for path in _expanded(inner[begin:place]) if inner[begin:place].strip() else ():
                yield head.strip() + path
            begin = place + 1


def _absolute(path: str, name: Name) -> Name:
    words = tuple(path.split("::"))
    if words[0] == "crate":
        return words[1:]
    ups = next((place for place, word in enumerate(words) if word != "super"), len(words))
    return (*name[:-ups], *words[ups:]) if ups else ()


def _module(path: Name, files: Mapping[Name, Path]) -> Name:
    """The module that holds what a path names."""
    return next((path[:end] for end in range(len(path), 0, -1) if path[:end] in files), ())


def squeezed(graph: Graph, parent: Name = ()) -> Graph:
    """What the children of a parent know of one another, each with all that lies in it."""
    depth = len(parent) + 1
    inner = {
        name: known for name, known in graph.items() if name[: depth - 1] == parent and len(name) >= depth
    }
    rooms: dict[Name, set[Name]] = {name[:depth]: set() for name in inner}
    for name, known in inner.items():
        rooms[name[:depth]] |= {other[:depth] for other in known if other in inner} - {name[:depth]}
    return rooms


def circles(graph: Graph) -> list[list[Name]]:
    """The sets of siblings, at any depth, that reach one another."""
    parents = sorted({name[:end] for name in graph for end in range(len(name))})
    return [circle for parent in parents for circle in _circles(squeezed(graph, parent))]


def _reached(graph: Graph, start: Name) -> set[Name]:
    seen: set[Name] = set()
    ahead = [start]
    while ahead:
        new = graph[ahead.pop()] - seen
        seen |= new
        ahead += new
    return seen


def _circles(graph: Graph) -> list[list[Name]]:
    reached = {name: _reached(graph, name) for name in graph}
    found = {
        tuple(sorted(other for other in reached[name] if name in reached[other]))
        for name in graph
        if name in reached[name]
    }
    return [list(circle) for circle in sorted(found)]


def floors(graph: Graph) -> int:
    """The rooms of the longest chain; those of a circle lie on one floor."""
    circle_of = {name: tuple(circle) for circle in _circles(graph) for name in circle}
    merged: dict[tuple[Name, ...], set[tuple[Name, ...]]] = {}
    for name, known in graph.items():
        own = circle_of.get(name, (name,))
        merged.setdefault(own, set()).update({circle_of.get(other, (other,)) for other in known} - {own})
    height: dict[tuple[Name, ...], int] = {}

    def of(room: tuple[Name, ...]) -> int:
        if room not in height:
            height[room] = 1 + max(map(of, merged[room]), default=0)
        return height[room]

    return max(map(of, merged))


def arrows(graph: Graph) -> list[tuple[Name, Name]]:
    """Who knows whom."""
    return sorted((name, other) for name, known in graph.items() for other in known)


def folders(root: Path, graph: Graph, parent: Name) -> list[list[str]]:
    """Files, lines and arrows of the folders of a folder of the core: each below those that know it."""
    rooms = squeezed(graph, parent)
    rows = []
    for room in sorted(rooms, key=lambda room: (len(_reached(rooms, room)), room)):
        files = sorted((root / PARTS["core, Rust"][0]).joinpath(*room).rglob("*.rs"))
        count = sum(len(file.read_text("utf-8").splitlines()) for file in files)
        known = ", ".join(sorted(other[-1] for other in rooms[room]))
        rows.append([_dotted(room), str(len(files)), f"{count:,}", known])
    return rows


def upward(rooms: Graph, root: Path) -> list[tuple[Name, Name]]:
    """The arrows against the order of pyproject.toml, or between two rooms that it lists as independent."""
    linter = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    layers = next(
        contract["layers"] for contract in linter["contracts"] if contract.get("containers") == ["sevenbar"]
    )
    depth = {
        word.strip(" ()"): place for place, layer in enumerate(layers) for word in re.split("[|:]", layer)
    }
    return [(a, b) for a, b in arrows(rooms) if depth.get(b[0], len(layers)) <= depth.get(a[0], -1)]


def text(root: Path) -> str:
    """What is printed."""
    graphs = {"Python": python_graph(root), "Rust": rust_graph(root)}
    # it imports the package of this checkout, which would stand for that of the other one
    from evidence.markdown import table

    counted = [[part, f"{files:,}", f"{count:,}"] for part, (files, count) in lines(root).items()]
    parts = [table(["part", "files", "lines"], counted)]
    rows, told = [], []
    for language, graph in graphs.items():
        rooms = squeezed(graph)
        # the order of the Rust modules stands nowhere
        up = upward(rooms, root) if language == "Python" else None
        found = circles(graph)
        counts = (len(graph), len(rooms), floors(rooms), len(arrows(rooms)))
        rows.append([language, *map(str, counts), "-" if up is None else str(len(up)), str(len(found))])
        told += [f"{language}, up: {_dotted(a)} -> {_dotted(b)}" for a, b in up or ()]
        told += [f"{language}, circle: {', '.join(map(_dotted, circle))}" for circle in found]
    heads = ["", "modules", "rooms", "floors", "arrows", "arrows up", "circles"]
    loops = table(["the core's loops", "files", "lines", "knows"], folders(root, graphs["Rust"], ("loops",)))
    return "\n\n".join([*parts, table(heads, rows), loops, *(["\n".join(told)] if told else [])])


def _dotted(name: Name) -> str:
    return ".".join(name)


if __name__ == "__main__":
    print(text(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT))
