"""A studio with a page open at it, as a person sees it."""

import re
import time

import sevenbar as sb
from browser import PATIENCE, keep
from controls import type_into

#: After a text is typed it is taken, and after any change the page is sent anew [ms].
TAKEN, SHOWN = 1300, 400


#: The innermost part of the page that begins as a reading does; a locator would ask for the text of every part.
READING = r"""() => [...document.querySelectorAll("div")]
    .findLast(part => /^\s*input -?[\d.]+/.test(part.textContent)).innerText"""


class Desk:
    """A studio with a page open at it."""

    def __init__(self, name, page, studio):
        self.name, self.page, self.studio = name, page, studio
        self.linkage = sb.load(name)
        self.motion = self.linkage.motion()

    def wait(self, time=SHOWN):
        self.page.wait_for_timeout(time)

    def until(self, found, wanted=None):
        """Waits until something is found on the page, or is what is wanted; what it is then."""
        end = time.monotonic() + PATIENCE
        while True:
            value = found()
            if (value if wanted is None else value == wanted) or time.monotonic() > end:
                assert value if wanted is None else value == wanted, (value, wanted)
                return value
            self.wait(100)

    def near(self, place, wanted, within=1e-3):
        """Waits until a part of the reading is near what is wanted."""
        self.until(lambda: abs((self.reading()[place] - wanted + 180) % 360 - 180) <= within, True)

    def says(self, words):
        """Waits for words on the page."""
        self.page.get_by_text(words).filter(visible=True).first.wait_for()

    def type(self, label, text):
        type_into(self.page, label, text)
        self.wait(TAKEN)

    def reading(self):
        """Input and output [deg], and the mode and their number, as the page shows them."""
        words = self.page.evaluate(READING)
        found = re.search(r"input ([-\d.]+)°.*output ([-\d.]+)°.*mode (\d+) of (\d+)", words, re.DOTALL)
        return float(found[1]), float(found[2]), int(found[3]), int(found[4])

    def verdict(self):
        """The facts of the verdict, by name; those of the circuit after those of the motion."""
        rows = self.page.locator("tr").filter(visible=True).all_inner_texts()
        return dict(line.split("\t", 1) for line in rows if "\t" in line)

    def pictures(self):
        """The curves on the page."""
        return self.page.locator("svg[role=img]").filter(visible=True)

    def keep(self, what):
        keep(self.page, f"{self.name}_{what}")
