"""What a release says of itself is the same everywhere."""

import re
import tomllib

import sevenbar
from oldest_versions import oldest_versions
from places import ROOT


def test_one_version_stands_in_the_crates_the_package_the_citation_and_the_changelog():
    version = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    cited = re.search(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(), flags=re.MULTILINE)
    newest = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), flags=re.MULTILINE)
    assert sevenbar.__version__ == version == cited.group(1) == newest.group(1)


def test_the_citation_has_what_its_format_asks_for_and_the_licence_of_the_package():
    lines = (ROOT / "CITATION.cff").read_text().splitlines()
    keys = {line.split(":")[0] for line in lines if re.match(r"\S+:", line)}
    assert {"cff-version", "message", "title", "authors", "type"} <= keys
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert f"license: {project['license']}" in lines


def test_each_dependency_has_one_lower_bound_over_all_extras():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    names = [line.split("==")[0] for line in oldest_versions(project)]
    assert names == sorted(set(names))
    assert {"numpy", "matplotlib", "scipy", "viser"} <= set(names)
