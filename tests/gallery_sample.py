"""A part of the gallery for tests that are long: every joint kind, form of file and overconstrained motion once.

The whole gallery is in `make proof`.
"""

import pytest

from sevenbar.description.gallery import loops

SAMPLE = (
    *("rssr", "seven_r", "planar_4r", "bennett", "rscr", "rsur", "rssp", "swash_plate"),
    *("screw_drill", "rccc"),
)


#: Of these one of each kind of joint, where a test takes seconds for each.
FEW = ("rssr", "planar_4r", "rsur", "rssp", "swash_plate", "screw_drill")


def sampled(sample=SAMPLE):
    """The names of the gallery; those outside the sample are proofs."""
    return [pytest.param(name, marks=() if name in sample else pytest.mark.proof) for name in loops()]
