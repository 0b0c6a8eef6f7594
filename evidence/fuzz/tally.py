"""Counts of a run that add up: what was seen, the slowest call, the findings, memory."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

#: Families of messages that are distinguished; a file's own words in one would make no end of them.
MOST_KEYS = 300

#: Findings of one kind that are kept; the others are counted.
MOST_ALIKE = 5


@dataclass
class Finding:
    """A case that broke something: enough to do it again."""

    way: str
    index: int
    what: str
    detail: str
    content: str

    @property
    def kind(self) -> str:
        """What findings of one kind have in common: the words before any number."""
        words = self.what.split()
        return " ".join(word for word in words if not any(c.isdigit() for c in word))[:80]


@dataclass
class Tally:
    """What the cases of one way came to."""

    cases: int = 0
    seen: Counter[str] = field(default_factory=Counter)
    #: Seconds of processor time, and the index, of the slowest call.
    slowest: tuple[float, int] = (0.0, -1)
    seconds: float = 0.0
    findings: list[Finding] = field(default_factory=list)
    found: Counter[str] = field(default_factory=Counter)

    def timed(self, seconds: float, index: int) -> None:
        """Notes how long a call took."""
        self.seconds += seconds
        self.slowest = max(self.slowest, (seconds, index))

    def add(self, finding: Finding) -> None:
        """Notes a finding; of many alike the first few are kept."""
        self.found[finding.kind] += 1
        if self.found[finding.kind] <= MOST_ALIKE:
            self.findings.append(finding)

    def plain(self) -> dict[str, Any]:
        """As JSON can hold it."""
        return {
            "cases": self.cases,
            "seen": dict(self.seen.most_common(MOST_KEYS)),
            "slowest": list(self.slowest),
            "seconds": self.seconds,
            "findings": [vars(finding) for finding in self.findings],
            "found": dict(self.found),
        }

    def merge(self, plain: dict[str, Any]) -> None:
        """Adds what `plain` holds."""
        self.cases += plain["cases"]
        self.seen.update(plain["seen"])
        seconds, index = plain["slowest"]
        self.slowest = max(self.slowest, (seconds, index))
        self.seconds += plain["seconds"]
        for finding in plain["findings"]:
            self.add(Finding(**finding))
        counted = Counter(f["what"] and Finding(**f).kind for f in plain["findings"])
        self.found.update(Counter(plain["found"]) - counted)
