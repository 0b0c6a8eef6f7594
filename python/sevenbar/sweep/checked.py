"""What lets a file of a sweep be known again: a checksum of its bytes; for a part its number and linkages."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from io import BytesIO
from typing import Any

#: Keys of a part's metadata: the mark of its sweep; its number with its first and last linkage; its checksum.
MARK, PART, CHECKSUM = b"sevenbar.sweep", b"sevenbar.part", b"sevenbar.checksum"

#: What begins a checksum, and the letters of one; as long as it is not known they are zeros.
_KIND, _LETTERS = b"sha256:", 64
_UNKNOWN = b"0" * _LETTERS

#: The key of the checksum of a description.
OWN = "checksum"


def part_words(part: int, linkages: range) -> bytes:
    """A part's number with its first and last linkage, as its metadata has them."""
    return b"%d: %d to %d" % (part, linkages.start, linkages.stop - 1)


def to_seal(part: int, linkages: range) -> dict[bytes, bytes]:
    """What a part's file must hold to be sealed."""
    return {PART: part_words(part, linkages), CHECKSUM: _KIND + _UNKNOWN}


def sealed(content: bytes) -> bytes:
    """A part's file with the checksum of all its other bytes in it."""
    at = content.rfind(_KIND + _UNKNOWN) + len(_KIND)
    return content[:at] + hashlib.sha256(content).hexdigest().encode() + content[at + _LETTERS :]


def flaw(content: bytes, mark: str, part: int, linkages: range) -> str:
    """Why a file is not a part of the sweep with a mark; "" where it is."""
    at = content.rfind(_KIND) + len(_KIND)
    own = content[at : at + _LETTERS]
    bare = content[:at] + _UNKNOWN + content[at + _LETTERS :]
    if at < len(_KIND) or hashlib.sha256(bare).hexdigest().encode() != own:
        return "is damaged or was changed: its checksum is that of other bytes"
    import pyarrow.parquet as pq

    result: Mapping[bytes, bytes] = pq.read_metadata(BytesIO(content)).metadata
    if result.get(MARK) != mark.encode():
        return "is no part of this sweep"
    if result.get(PART) != part_words(part, linkages):
        number = result.get(PART, b"").partition(b":")[0].decode()
        return f"is part {number} of this sweep, not part {part}"
    return ""


def checksum(description: Mapping[str, Any]) -> str:
    """The checksum of a description without its own."""
    text = json.dumps({key: value for key, value in description.items() if key != OWN}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()
