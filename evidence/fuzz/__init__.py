"""Hard use: random linkages through the whole analysis, mutated files through the loader, each call watched.

`python -m evidence.fuzz run` draws and judges, `python -m evidence.fuzz replay FILE` does one finding
again. What is drawn follows from a seed alone; the tests draw from the same families.
"""
