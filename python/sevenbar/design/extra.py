"""The extra 'design', without which nothing is searched."""

from __future__ import annotations

from sevenbar.errors import of_extra


def need_scipy() -> None:
    """Raises `MissingExtraError` where scipy is not installed."""
    with of_extra("design", "design needs scipy and tomlkit"):
        import scipy.optimize
        import scipy.stats  # noqa: F401
