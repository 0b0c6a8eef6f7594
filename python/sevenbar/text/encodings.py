"""Which encoding a text has, seen from its first bytes."""

from __future__ import annotations

#: What of a file shows its encoding [bytes].
HEAD = 2000


def wide_text(content: bytes) -> str:
    """The kind of UTF-16 of a text; empty for another. Without a mark plain letters have a zero byte each."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    head = content[:HEAD]
    for first, name in ((1, "utf-16-le"), (0, "utf-16-be")):
        zeros, others = head[first::2], head[1 - first :: 2]
        if zeros and not any(zeros) and all(others):
            return name
    return ""
