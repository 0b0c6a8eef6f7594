"""Hard use: random linkages through the whole analysis, mutated files through the loader, each call watched.

`python -m fuzz run` draws and judges, `python -m fuzz replay FILE` does one finding again. What is drawn
follows from a seed alone, and the families of linkages are those of the tests.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# what the tests draw, and their second way to close a loop, are used here too
sys.path.append(str(ROOT / "tests"))
