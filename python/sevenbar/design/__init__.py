"""Design: maps, tolerances, linkages for a wanted motion, and points of links with wanted paths."""

from sevenbar.design import maps, points, synthesis, tolerance

__all__ = ["maps", "points", "synthesis", "tolerance"]
