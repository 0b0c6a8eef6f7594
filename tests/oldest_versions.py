"""The oldest version of each dependency that pyproject.toml allows, as a list for pip.

Tools of the developers stay the newest. build123d (extra `cad`) is left out, since it does not install beside the
oldest NumPy. Run: `python tests/oldest_versions.py`
"""

import sys
import tomllib
from pathlib import Path

PYPROJECT = Path(__file__).parent.parent / "pyproject.toml"

#: Extras that only developers install.
OF_DEVELOPERS = {"dev", "docs", "peers"}
APART = {"cad"}


def oldest_versions(project):
    """Lines such as `numpy==1.26.*`, sorted, from the lower bounds of the project's table."""
    lines = set(project["dependencies"])
    for extra, needed in project["optional-dependencies"].items():
        if extra not in OF_DEVELOPERS | APART:
            lines |= set(needed)
    return sorted(f"{name}=={bound}.*" for name, bound in (line.split(">=") for line in lines))


if __name__ == "__main__":
    project = tomllib.loads(PYPROJECT.read_text(encoding="utf-8"))["project"]
    sys.stdout.write("\n".join(oldest_versions(project)) + "\n")
