"""All answers to a task whose number theory counts: how many there are, and what each of them does."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.design.candidates import CHECK_SAMPLES, Candidate, Claim, Refusal, analysed, checked
from sevenbar.design.exact.dyads import Dyad
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.printing import Printed

#: Inputs of a full turn among which the wanted poses are sought, until they are found. A long crank moves by
#: a hundredth of a turn or less: few inputs of a turn are near its poses.
CHECKED_AT = (CHECK_SAMPLES, 16 * CHECK_SAMPLES, 256 * CHECK_SAMPLES)

#: Range of the claimed inputs [rad] from which on poses are not sought among the most.
LITTLE = 0.2


@dataclass(frozen=True, eq=False)
class ExactAnswer:
    """One linkage that meets a task: its draft, what is claimed of it, and what its circuits say.

    `claim.errors` are the closure errors at the wanted poses by substitution [length]. `verdict` is a
    `Candidate` where all poses lie on one pass of one circuit in their order, and else a `Refusal` that names
    the defect ("circuit", "dead centre", "order"); `None` where a loop has two freedoms, and no circuits.
    """

    draft: Draft
    claim: Claim
    verdict: Candidate | Refusal | None
    #: `None` for what is no linkage.
    motion_type: str | None
    #: All joints' values at the wanted poses (n, columns); `None` where only input and output are wanted.
    poses: Floats | None = None

    @property
    def linkage(self) -> Linkage:
        """The linkage."""
        return self.draft.linkage

    @property
    def fault(self) -> str | None:
        """The kind of defect; `None` without one."""
        return self.verdict.fault if isinstance(self.verdict, Refusal) else None

    @property
    def error(self) -> float:
        """The greatest closure error at the wanted poses, relative to the size of the linkage."""
        return self.claim.figures["closure_error"]

    @property
    def defect(self) -> str:
        """Why the circuits do not take the wanted poses in order: "none", a fault, or "two freedoms"."""
        if self.verdict is None:
            return "two freedoms"
        return self.fault or "none"

    @cached_property
    def columns(self) -> dict[str, float | str | int | None]:
        """What is reported of it, column by column; each number's name ends in its unit."""
        free = self.verdict if isinstance(self.verdict, Candidate) else None
        # that of other linkages than the RSSR is of the whole circuit, not of the wanted poses
        lowest = None if free is None or self.linkage.form != "rssr" else free.transmission_lowest
        return {
            "defect": self.defect,
            "motion_type": self.motion_type,
            "transmission_lowest_deg": None if lowest is None else math.degrees(lowest),
            **self.claim.figures,
            **{d.column: d.value for d in self.draft.dimensions if d.kind != "speed"},
        }


@dataclass(frozen=True, eq=False, repr=False)
class ExactAnswers(Printed):
    """All answers to a task: their number by theory, over the complex numbers, and the real ones.

    `counted` names what theory counts ("dyads", "linkages"); `theory` is their number over the complex
    numbers and `found` how many were found, with multiplicity (`None` where the answers are a family, of
    which `answers` are members). `real` of these are real numbers, all different. `answers` are the
    linkages that they make: one for each way to drive each.
    """

    task: str
    counted: str
    theory: int | None
    found: int | None
    real: int
    answers: tuple[ExactAnswer, ...]
    #: How the number was found, and what was left out.
    how: str
    #: The real dyads themselves, in ground coordinates.
    dyads: tuple[Dyad, ...] = ()

    @cached_property
    def candidates(self) -> tuple[ExactAnswer, ...]:
        """The answers, those without defects first."""
        return tuple(sorted(self.answers, key=lambda answer: isinstance(answer.verdict, Refusal)))

    @property
    def assemblable(self) -> tuple[ExactAnswer, ...]:
        """The answers whose circuits hold all wanted poses, whatever lies between them."""
        return tuple(a for a in self.answers if a.fault != "assembly")

    @property
    def defect_free(self) -> tuple[ExactAnswer, ...]:
        """The answers that take all wanted poses in order on one pass of one circuit."""
        return tuple(a for a in self.answers if isinstance(a.verdict, Candidate))

    @property
    def complete(self) -> bool:
        """Whether as many were found as theory counts."""
        return self.found is not None and self.found == self.theory

    @property
    def sliders(self) -> int:
        """How many real dyads have a slider in place of a crank: a point at infinity."""
        return sum("P" in dyad.kind for dyad in self.dyads)

    @property
    def faults(self) -> dict[str, int]:
        """How many answers have each kind of defect."""
        return dict(Counter(a.fault for a in self.answers if a.fault is not None))


def judged(draft: Draft, claim: Claim, poses: Floats | None = None) -> ExactAnswer:
    """An answer with what its circuits say; `poses` (n, columns) as `checked` takes them."""
    little = float(np.ptp(claim.inputs)) < LITTLE
    for samples in CHECKED_AT if little else CHECKED_AT[:-1]:
        motion = analysed(draft, samples)
        if isinstance(motion, Refusal):
            return ExactAnswer(draft, claim, motion, None, poses)
        verdict = checked(draft, claim, poses=poses, motion=motion)
        answer = ExactAnswer(draft, claim, verdict, motion.motion_type, poses)
        if not isinstance(verdict, Refusal) or verdict.fault != "assembly":
            break
    return answer
