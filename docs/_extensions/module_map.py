"""The module map: each module of the package and of the core with the first line of its docstring."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

from page_tables import code, table

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "sevenbar"
CORE = ROOT / "crates" / "sevenbar-core" / "src"


def module_map(_pages: Path = ROOT, _argument: str = "") -> str:
    """The map in Markdown: a section for each folder, a row for each module."""
    return "\n".join([*_of_package(), *_of_core()])


def _of_package() -> Iterator[str]:
    yield "## The Python package, from the top"
    for name in _layers():
        folder = PACKAGE / name
        if folder.is_dir():
            files = sorted(path for path in folder.rglob("*.py") if path != folder / "__init__.py")
            rows = [(code(_below(path, folder)), python_line(path)) for path in files]
            yield f"\n**`{name}`** {python_line(folder / '__init__.py')}\n"
            yield table(("module", ""), rows)
        else:
            yield f"\n**`{name}`** {python_line(folder.with_suffix('.py'))}"


def _of_core() -> Iterator[str]:
    yield "\n## The Rust core\n"
    for folder in [CORE, *sorted(path.parent for path in CORE.rglob("mod.rs"))]:
        if folder != CORE:
            own = folder / "mod.rs"
            yield f"\n**`{_below(own, CORE)}`** {rust_line(own)}\n"
        files = sorted(path for path in folder.glob("*.rs") if path.stem not in ("mod", "tests"))
        if files:
            yield table(("module", ""), [(code(_below(path, folder)), rust_line(path)) for path in files])


def _layers() -> list[str]:
    """Folders and modules of the package's root, upper ones first, in the order that import-linter holds."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (contract,) = (
        c for c in settings["tool"]["importlinter"]["contracts"] if c.get("containers") == ["sevenbar"]
    )
    return [name.strip() for layer in contract["layers"] for name in layer.split("|")]


def _below(path: Path, folder: Path) -> str:
    """A module's name from its folder on: `maps.atlas`; a package is its folder."""
    parts = path.relative_to(folder).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] in ("__init__", "mod") else parts)


def python_line(path: Path) -> str:
    """The first line of a module's docstring."""
    return (ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n")[0]


def rust_line(path: Path) -> str:
    """The first line of a Rust module's documentation."""
    first = path.read_text(encoding="utf-8").partition("\n")[0]
    return first.removeprefix("//! ") if first.startswith("//! ") else ""
