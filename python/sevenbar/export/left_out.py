"""What acts on a linkage and has no place in a file, in words."""

from __future__ import annotations

from sevenbar.forces.loading import Loading


def left_out(loading: Loading, *, gravity: bool = False, loads: int = 0, springs: int = 0) -> str:
    """What a file leaves out of a loading: gravity, and so many loads and springs; empty where nothing is.

    >>> import sevenbar as sb
    >>> left_out(sb.Loading(gravity=(0, 0, -9.81)), gravity=True, loads=1, springs=2)
    'gravity, 1 load, 2 springs'
    """
    words = ["gravity"] if gravity and any(loading.gravity) else []
    words += [
        f"{count} {what}{'s' * (count > 1)}"
        for count, what in ((loads, "load"), (springs, "spring"))
        if count
    ]
    return ", ".join(words)
