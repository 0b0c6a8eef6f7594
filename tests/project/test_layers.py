"""Who may know whom, where import-linter cannot see it: the extension module, and the Rust side."""

import ast
import re
import tomllib
from pathlib import Path

import pytest

from places import PACKAGE, ROOT

CORE = ROOT / "crates" / "sevenbar-core"

PYTHON_FILES = sorted(PACKAGE.rglob("*.py"))
RUST_FILES = sorted((ROOT / "crates").rglob("*.rs"))
CORE_FILES = sorted((CORE / "src").rglob("*.rs"))

CORE_IMPORTERS = {
    "curves/along",
    "forces/free_motion/driven",
    "__init__",
    *(
        f"kinematics/{name}"
        for name in (
            "circuits/from_core",
            "dynamics/forces",
            "loop/no_length",
            "numbers/sensitivity",
            "numbers/word",
            "nets/order",
            "nets/tree",
            "solvers/batches",
            "solvers/closed_form",
            "solvers/general",
        )
    ),
    # to stop it
    "studio/worker",
    "sweep/run",
}

#: Who knows in which order the joints of a loop follow each other; docs/design.md says why these. All others
#: take links and joints as a graph.
ORDER_KNOWN_TO = {
    # takes a row of numbers for each joint; `forms`, which makes their fixed transforms, needs none of these
    "description/constructors",
    # the loop as a value, its graph, and the poses of its links
    "kinematics/loop/geometry",
    "kinematics/loop/graph",
    "kinematics/circuits/poses",
    # the loop by its numbers
    "kinematics/numbers/lengths",
    "kinematics/numbers/word",
    # the joints as the core takes them
    "kinematics/solvers/general",
}

#: Joints counted, a joint by its neighbour's number, what is fixed between joints by a link's number; `links`
#: of a four-bar, a pose and a must are others, by name or number.
ORDER_OF_JOINTS = re.compile(
    r"\blen\((?!reason\.)[^()]*\bjoints\)"
    r"|\bjoints\[[^\],]*[-+%:][^\],]*\]"
    r"|(?<!\bbar)(?<!\bpose)(?<!\bmust)(?<!\})\.links\["
    r"|\.transforms\b(?! import)"
)

NOT_IN_THE_CORE = re.compile(
    r"\b(pyo3|numpy)\b"
    r"|\bstd::(fs|io|time|env|net|process)\b"
    r"|\bstd::\{[^;]*\b(fs|io|time|env|net|process)\b"
    r"|\b(e?print(ln)?|dbg)!"
    r"|\bstatic\s+mut\b"
    r"|\bthread_local!"
)
UNSAFE = re.compile(r"\bunsafe\b")

RUST_COMMENT_OR_TEXT = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | b?r(?P<hashes>\#*)".*?"(?P=hashes)
      | b?"(?:\\.|[^"\\])*"
      | b?'(?:\\[^']+|\\'|[^'\\])'""",
    re.DOTALL | re.VERBOSE,
)


def code_of(rust: str) -> str:
    """Rust without comments, and with every string empty."""
    return RUST_COMMENT_OR_TEXT.sub(lambda match: " " if match["comment"] else '""', rust)


def found(pattern: re.Pattern[str], files: list[Path]) -> list[str]:
    """`file: text` for each match outside comments and strings."""
    return [
        f"{file.relative_to(ROOT).as_posix()}: {match[0]}"
        for file in files
        for match in pattern.finditer(code_of(file.read_text(encoding="utf-8")))
    ]


def imported_from_core(python: str) -> set[str]:
    """What a module of the package takes from `_core`: names, or `_core` itself."""
    names = set()
    for node in ast.walk(ast.parse(python)):
        if isinstance(node, ast.Import) and any(alias.name == "sevenbar._core" for alias in node.names):
            names.add("_core")
        elif isinstance(node, ast.ImportFrom):
            source = "." * node.level + (node.module or "")
            if source in {"sevenbar._core", "._core"}:
                names.update(alias.name for alias in node.names)
            elif source in {"sevenbar", "."} and any(alias.name == "_core" for alias in node.names):
                names.add("_core")
    return names


def test_the_order_of_joints_is_known_to_the_modules_listed_only():
    knowing = {
        file.relative_to(PACKAGE).with_suffix("").as_posix()
        for file in PYTHON_FILES
        if ORDER_OF_JOINTS.search(file.read_text(encoding="utf-8"))
    }
    assert knowing == ORDER_KNOWN_TO
    assert len(ORDER_KNOWN_TO) <= 8


@pytest.mark.parametrize(
    "line",
    [
        "count = len(self.linkage.joints)",
        "after = loop.joints[(i + 1) % count]",
        "last = linkage.joints[-1]",
        "for joint in linkage.joints[:-1]:",
        "frame = linkage.links[link - 1]",
        "way = motion.linkage.links[0]",
        "size = loop.transforms[:, :3, 3]",
    ],
)
def test_a_reading_of_the_order_of_joints_is_seen(line):
    assert ORDER_OF_JOINTS.search(line)


@pytest.mark.parametrize(
    "line",
    [
        "bar.links[name]",
        "pose.links[link]",
        "len(reason.joints)",
        "linkage.joints[joint].name",
        "graph.joints",
    ],
)
def test_what_is_no_order_of_joints_is_none(line):
    assert not ORDER_OF_JOINTS.search(line)


def test_the_core_is_imported_by_the_modules_listed_only():
    taken = {
        file.relative_to(PACKAGE).with_suffix("").as_posix(): imported_from_core(
            file.read_text(encoding="utf-8")
        )
        for file in PYTHON_FILES
    }
    importers = {module for module, names in taken.items() if names}
    assert importers == CORE_IMPORTERS
    assert taken["__init__"] <= {"__version__"}


def test_the_rust_core_knows_no_python_no_files_no_clock_and_no_global_state():
    assert CORE_FILES
    # who may stop the work of a thread
    own = [f"{CORE.relative_to(ROOT).as_posix()}/src/stopping.rs: thread_local!"]
    assert found(NOT_IN_THE_CORE, CORE_FILES) == own


def test_the_rust_core_depends_on_no_python_crate():
    manifest = tomllib.loads((CORE / "Cargo.toml").read_text(encoding="utf-8"))
    tables = [manifest, *manifest.get("target", {}).values()]
    kinds = ("dependencies", "dev-dependencies", "build-dependencies")
    crates = {crate for table in tables for kind in kinds for crate in table.get(kind, {})}
    assert not crates & {"pyo3", "numpy"}


def test_unsafe_stands_in_the_vector_dispatch_only():
    places = {place.partition(":")[0] for place in found(UNSAFE, RUST_FILES)}
    assert places == {"crates/sevenbar-core/src/simd.rs", "crates/sevenbar-core/src/vectors.rs"}


@pytest.mark.parametrize(
    "line",
    [
        "use numpy::PyArray1;",
        "let t = std::time::Instant::now();",
        "use std::{fmt, io::Read};",
        'eprintln!("{x}");',
        "static mut COUNT: usize = 0;",
        "let quote = '\"'; println!();",
        "fn f<'a>(x: &'a str) { print!() } // 'a",
    ],
)
def test_a_breach_of_the_core_is_seen(line):
    assert NOT_IN_THE_CORE.search(code_of(line))


@pytest.mark.parametrize(
    "line",
    [
        "// println! is not used here",
        "/* std::fs\n unsafe */ let x = 1;",
        'let text = "say \\"std::io\\" // unsafe";',
        'let text = r#"unsafe "println!" "#;',
        "#[allow(unsafe_code)]",
        "static LIMITS: [f64; 2] = [0.0, 1.0];",
    ],
)
def test_comments_and_strings_are_no_breach(line):
    assert not NOT_IN_THE_CORE.search(code_of(line))
    assert not UNSAFE.search(code_of(line))


@pytest.mark.parametrize(
    "line",
    ["import sevenbar._core", "from sevenbar import _core", "from . import _core", "from ._core import Rssr"],
)
def test_each_way_to_import_the_core_is_seen(line):
    assert imported_from_core(line)
