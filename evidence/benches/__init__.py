"""Sevenbar beside its peers: the same work in the same process, in turns, on one page.

`python -m evidence.benches` runs all cases and writes `results.json` and docs/benchmarks.md, `--only CASE ..`
some.
"""
