"""`python crates/notices.py`: writes THIRD-PARTY-NOTICES, the licences of the crates that a wheel may link.

They are those of `Cargo.lock`; their texts come from the sources that cargo has fetched.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[1]

HEAD = """Third-party notices

The binary wheels of Sevenbar contain code of the Rust crates below, or were built with it. Where a crate
may be used under the Apache License, Version 2.0, among others, its text is that of the file LICENSE.
"""

#: Begins the Apache License in all its layouts, and the exception that LLVM adds to it.
APACHE, EXCEPTION = "apache license", "llvm exceptions"


def crates() -> list[dict[str, str]]:
    """The foreign crates of `Cargo.lock`, by name: version, licence, folder of the source."""
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--offline", "--all-features"]
    found = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout)
    foreign = [one for one in found["packages"] if one["source"] is not None]
    return sorted(foreign, key=lambda one: (one["name"], one["version"]))


def texts(folder: Path) -> list[str]:
    """The licences and notices of a crate, without the Apache License where it has another."""
    names = ("licen", "copying", "notice")
    files = [one for one in sorted(folder.iterdir()) if one.name.lower().startswith(names) and one.is_file()]
    found = [file.read_text(encoding="utf-8").strip() for file in files]
    own = [text for text in found if APACHE not in text[:400].lower() or EXCEPTION in text.lower()]
    return own or found


def notices() -> str:
    """The whole file: crates with one text together."""
    together: dict[str, list[str]] = {}
    for one in crates():
        line = f"{one['name']} {one['version']} ({one['license']})"
        own = texts(Path(one["manifest_path"]).parent)
        together.setdefault("\n\n".join(own) or "(no text in its source)", []).append(line)
    rule = "=" * 80
    blocks = ("\n".join([rule, *lines, rule, "", text, ""]) for text, lines in together.items())
    return "\n".join([HEAD, *blocks])


if __name__ == "__main__":
    (ROOT / "THIRD-PARTY-NOTICES").write_text(notices(), encoding="utf-8")
