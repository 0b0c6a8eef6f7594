"""Hard use: random linkages through the whole analysis, mutated files through the loader, each call watched.

`python -m fuzz run` draws and judges, `python -m fuzz replay FILE` does one finding again. What is drawn
follows from a seed alone; the tests draw from the same families.
"""

from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
