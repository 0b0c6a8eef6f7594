"""Design: maps, tolerances, linkages for a wanted motion, and points of links with wanted paths."""
