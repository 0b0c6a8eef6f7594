"""The controls of a page as a person finds them: by the words beside them.

`where` is a page, or a part of it, for a label that stands on the page twice: `panel(page, "Verdict")`,
`folder(page, "Point 1")`.
"""

import re

from playwright.sync_api import Locator

#: From one act of a hand to the next [ms]. viser sends one change of a panel in 50 ms: of two that are faster,
#: be it in two controls, the first is lost.
PAUSE = 60


def page_of(where):
    """The page that a part of it belongs to."""
    return where.page if isinstance(where, Locator) else where


def rest(where):
    """Do nothing for a moment, by the clock of the page, which may lag."""
    page_of(where).evaluate(f"() => new Promise(done => setTimeout(done, {PAUSE}))")


def whole(words):
    """A pattern of these words and no more."""
    return re.compile(rf"^\s*{re.escape(words)}\s*$")


def row(where, label):
    """A label with its control."""
    named = where.locator("label").filter(has_text=whole(label)).filter(visible=True)
    return named.locator("xpath=ancestor::*[3]")


def box(where, label, part=0):
    """The box for typing beside a label: a number, a text, a choice, a slider's number, a part of a vector."""
    return row(where, label).locator("input:visible, textarea:visible").nth(part)


def shown(where, label, part=0):
    """What stands in a box."""
    return box(where, label, part).input_value()


def type_into(where, label, text, *, part=0, end="leave"):
    """Type over what stands in a box, then leave it, press a key ("Enter" commits a form), or stay in it ("")."""
    entry = box(where, label, part)
    entry.click()
    entry.press("ControlOrMeta+A")
    entry.press_sequentially(text, delay=PAUSE) if text else entry.press("Delete")
    rest(where)
    if end == "leave":
        # not by Tab, which would open a dropdown that comes next
        entry.blur()
    elif end:
        entry.press(end)
    rest(where)


def slider(where, label):
    """The thumb of a slider; its attribute aria-valuenow is the value."""
    return row(where, label).get_by_role("slider")


def drag(where, label, *fractions, steps=8):
    """Hold a slider's thumb and pull it to fractions of its way, one after another, then let go."""
    page = page_of(where)
    # waits until the panel stands still: before it does, the boxes are where the slider was
    slider(where, label).hover()
    track = row(where, label).locator(".mantine-Slider-track").bounding_box()
    page.mouse.down()
    for fraction in fractions:
        page.mouse.move(track["x"] + fraction * track["width"], track["y"] + track["height"] / 2, steps=steps)
    rest(page)
    page.mouse.up()


def button(where, words):
    """A button by the words on it."""
    return where.get_by_role("button").filter(has_text=whole(words)).filter(visible=True)


def click_button(where, words):
    """Click it."""
    button(where, words).click()
    rest(where)


def options(where, label):
    """What a dropdown offers."""
    box(where, label).click()
    offered = page_of(where).get_by_role("option").filter(visible=True)
    offered.first.wait_for()
    words = offered.all_inner_texts()
    page_of(where).keyboard.press("Escape")
    return words


def choose(where, label, option):
    """Choose from a dropdown."""
    box(where, label).click()
    page_of(where).get_by_role("option", name=option, exact=True).filter(visible=True).click()
    rest(where)


def toggle(where, label):
    """Click a checkbox; whether it is ticked then."""
    box(where, label).click()
    rest(where)
    return box(where, label).is_checked()


def open_tab(where, label):
    """Bring a tab to the front."""
    where.get_by_role("tab", name=label, exact=True).filter(visible=True).click()


def panel(page, tab):
    """The panel, or the group of tabs, that has a tab of this name."""
    tabs = page.get_by_role("tab", name=tab, exact=True)
    return page.locator("[data-dock-group]").filter(has=tabs).last


def head(where, label):
    """The line of a folder or form that opens and shuts it; a form that waits for Enter has a star there."""
    words = re.compile(rf"^\s*{re.escape(label)}\s*\*?\s*$")
    return (
        where.locator(".mantine-Paper-root .mantine-Paper-root").filter(has_text=words).filter(visible=True)
    )


def folder(where, label):
    """A folder or form with all in it."""
    return head(where, label).locator("xpath=..")


def open_folder(where, label):
    """Open a folder that is shut."""
    if head(where, label).locator(".tabler-icon-chevron-down").count():
        head(where, label).click()


def upload(where, words, path):
    """Give a file to an upload button."""
    with page_of(where).expect_file_chooser() as chosen:
        button(where, words).click()
    chosen.value.set_files(path)
    rest(where)


def download(where, words, into):
    """Click a button and keep the file that comes in a folder, under the name it comes with; its path."""
    with page_of(where).expect_download() as coming:
        click_button(where, words)
    path = into / coming.value.suggested_filename
    coming.value.save_as(path)
    return path
