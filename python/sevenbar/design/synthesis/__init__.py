"""Linkages for a wanted motion: a function, a path, a swing with its time ratio."""
