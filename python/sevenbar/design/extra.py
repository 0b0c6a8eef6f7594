"""The extra 'design', without which nothing is searched."""

from __future__ import annotations

from sevenbar.errors import MissingExtraError


def need_scipy() -> None:
    """Raises `MissingExtraError` where scipy is not installed."""
    try:
        import scipy.optimize
        import scipy.stats  # noqa: F401
    except ImportError:
        raise MissingExtraError(
            "design needs scipy and tomlkit; install them with: pip install 'sevenbar[design]'"
        ) from None
