"""The notices of others are those of the crates that a wheel links, with their texts."""

import tomllib

from places import ROOT

NOTICES = (ROOT / "THIRD-PARTY-NOTICES").read_text(encoding="utf-8")


def test_each_foreign_crate_of_the_lock_file_has_its_notice_and_no_other_has_one():
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text(encoding="utf-8"))
    wanted = {f"{one['name']} {one['version']}" for one in lock["package"] if "source" in one}
    there = {line.partition(" (")[0] for line in NOTICES.splitlines() if line.endswith(")") and " (" in line}
    assert wanted <= there, "python crates/notices.py writes them anew"
    heads = NOTICES.split("=" * 80)[1::2]
    assert {line.partition(" (")[0] for head in heads for line in head.split("\n") if line} == wanted


def test_licences_that_ask_for_their_text_in_binaries_have_it():
    blocks = NOTICES.split("=" * 80)
    texts = dict(zip(blocks[1::2], blocks[2::2], strict=True))
    (numpy,) = [text for head, text in texts.items() if "\nnumpy " in head]
    assert "Redistributions in binary form must reproduce the above copyright" in numpy
    assert all(len(text) > 500 for text in texts.values())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["license-files"] == ["LICENSE", "THIRD-PARTY-NOTICES"]
