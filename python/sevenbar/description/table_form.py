"""The model of a table of a file: its keys, each with its meaning and the unit of its numbers."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class TableForm(BaseModel):
    """A table whose keys are known."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


def key(meaning: str, unit: str = "") -> Any:
    """What a key means, and the unit of its numbers in words: for the JSON schema and the page."""
    return Field(description=meaning, json_schema_extra={"unit": unit} if unit else None)
