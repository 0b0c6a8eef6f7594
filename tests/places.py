"""Where things lie: the repository, its documentation and examples, the package, the tests and their published answers."""

from pathlib import Path

import sevenbar

#: The folder of the tests, and of the published answers that they are held against.
TESTS = Path(__file__).parent
REFERENCES = TESTS / "references"
#: The repository, and folders in it.
ROOT = TESTS.parent
DOCS, EXAMPLES = ROOT / "docs", ROOT / "examples"
#: The package as it is imported.
PACKAGE = Path(sevenbar.__file__).parent
