"""Modules that stand above those which need them, by name; imported at their first use."""

from __future__ import annotations

#: Folders of results, and the module that says what is printed of them.
SAID_IN: dict[str, str] = {}

#: The module whose `drawn_bodies(linkage, circuit)` gives what exports draw, as "bodies".
DRAWN_IN: dict[str, str] = {}
