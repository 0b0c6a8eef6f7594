"""Linkages that come with Sevenbar, each a TOML file that names its source."""

from __future__ import annotations

from importlib import resources


def names() -> tuple[str, ...]:
    """The names of all linkages of the gallery, in alphabetic order."""
    folder = resources.files(__package__ or "sevenbar") / "gallery"
    return tuple(sorted(f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith(".toml")))


def text(name: str) -> str:
    """The TOML text of a linkage of the gallery."""
    return (resources.files(__package__ or "sevenbar") / "gallery" / f"{name}.toml").read_text(
        encoding="utf-8"
    )
