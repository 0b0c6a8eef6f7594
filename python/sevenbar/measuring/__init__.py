"""Measured values compared with computed ones: what they show, and which dimensions explain them.

A text table becomes `measured` values. `compare` (rows) and `extremes` compare them with a motion;
`calibrate` explains them by the exact `sensitivity` of the closure. `figures`, `report` and `rewrite` show
and write the results.
"""
