"""Nets of several loops: a tree of links closed by the rows of chords, and the order of solving."""
