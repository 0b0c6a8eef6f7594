"""Measured values beside computed ones: what they say of a linkage, and which dimensions explain them.

The way there: a text table becomes `measured` values, which `compare` (rows) and `extremes` set beside a
motion and `calibrate` explains, by the exact `sensitivity` of the closure; then `figures`, `findings` and
`rewrite` tell and keep what was found.
"""
