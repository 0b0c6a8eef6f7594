"""Headless Chromium, its pages, and what their 3D canvas draws."""

import io
import shutil
import time
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest
from matplotlib.colors import rgb_to_hsv, to_rgb
from PIL import Image

#: Chromium as Debian, Ubuntu and Google call it.
NAMES = ("chromium", "chromium-browser", "google-chrome")
#: WebGL drawn by the processor, so that no graphics card is needed.
FLAGS = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-background-networking",
    "--no-first-run",
)
SIZE = {"width": 1000, "height": 640}
#: Most of what a page costs is its 3D picture, drawn by the processor: ten a second serve as well as sixty.
TEN_A_SECOND = """
{
    const frame = window.requestAnimationFrame.bind(window), asked = new Set();
    let count = 0;
    window.requestAnimationFrame = draw => {
        const id = ++count;
        asked.add(id);
        setTimeout(() => frame(now => { if (asked.delete(id)) draw(now); }), 85);
        return id;
    };
    window.cancelAnimationFrame = id => { asked.delete(id); };
}
"""
#: From one look at the canvas to the next [ms]: what a page is told is drawn two pictures later.
LOOK = 300
#: What anything on a page may take [s]: a guard against hanging, long enough for a machine with other work.
PATIENCE = 600.0
#: Where pictures of pages are kept; ignored by git, removed by `make clean`.
SCREENSHOTS = Path(__file__).parents[1] / "build" / "screenshots"
#: Below this spread between the channels (of 1) a pixel is grey.
CHROMA = 0.15
#: What may lie over the canvas: windows that float, and notices.
OVER = "[data-floating-window], .mantine-Notifications-root { visibility: hidden !important }"


def chromium():
    """Chromium's path; whoever asks without one fails, with the command that installs it."""
    for path in filter(None, map(shutil.which, NAMES)):
        return path
    return pytest.fail("no Chromium found; install it: apt-get install chromium", pytrace=False)


@contextmanager
def launched():
    """A headless browser."""
    path = chromium()
    # here, since every test run loads this module
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(FLAGS), timeout=PATIENCE * 1e3)
        yield browser
        browser.close()


def person(browser, **options):
    """Pages of a browser as if another person had opened it."""
    context = browser.new_context(**options)
    context.set_default_timeout(PATIENCE * 1e3)
    context.add_init_script(TEN_A_SECOND)
    return context


class Pages:
    """The pages of one test, each as if another person had opened it, and what went wrong on them."""

    def __init__(self, browser):
        self.browser = browser
        self.contexts = []
        self.wrong = []

    def __call__(self, url, *, tolerated=()):
        """The page at an address, connected; what holds one of the words tolerated is not wrong."""
        context = person(self.browser, viewport=SIZE)
        self.contexts.append(context)
        page = context.new_page()

        def note(words):
            if not any(word in words for word in tolerated):
                self.wrong.append(words)

        def asked(request):
            address = urlsplit(request.url)
            if address.scheme not in ("blob", "data") and address.netloc != urlsplit(url).netloc:
                note(f"asked elsewhere: {request.url}")

        page.on("pageerror", lambda error: note(f"raised: {error}"))
        page.on("console", lambda said: note(f"console: {said.text}") if said.type == "error" else None)
        page.on("request", asked)
        page.goto(url)
        page.locator(".tabler-icon-cloud-check").filter(visible=True).wait_for()
        # viser's notice that the processor draws lies over the canvas
        notice = page.locator(".mantine-Notification-root", has_text="Software WebGL")
        notice.wait_for()
        # a click is lost where the page is still being put together
        end = time.monotonic() + PATIENCE
        while notice.count() and time.monotonic() < end:
            notice.get_by_role("button").evaluate_all("buttons => buttons.forEach(button => button.click())")
            page.wait_for_timeout(100)
        notice.wait_for(state="detached")
        return page

    def close(self):
        """Close them all."""
        for context in self.contexts:
            context.close()
        self.contexts.clear()


def keep(page, name):
    """The page as it looks now, in build/screenshots/NAME.png; its path."""
    path = SCREENSHOTS / f"{name}.png"
    page.screenshot(path=path)
    return path


def canvas_colours(page):
    """What the 3D canvas shows now, without what lies over it: (height, width, 3), 0 to 255."""
    png = page.locator("canvas[data-engine]").screenshot(style=OVER)
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def settled(page, *, within=PATIENCE):
    """What the 3D canvas shows once it stands still: twice the same."""
    end = time.monotonic() + within
    before = canvas_colours(page)
    while time.monotonic() < end:
        page.wait_for_timeout(LOOK)
        after = canvas_colours(page)
        if np.array_equal(before, after):
            return after
        before = after
    return pytest.fail(f"the canvas still moves after {within:g} s", pytrace=False)


def drawn(image, colour, tolerance=24):
    """How many pixels are within a tolerance (of 255, in each channel) of a colour as matplotlib names it."""
    wanted = 255 * np.array(to_rgb(colour))
    return int((np.abs(image - wanted).max(axis=2) <= tolerance).sum())


def tinted(image, colour, within=20.0):
    """How many pixels have the hue of a colour to some degrees, whatever light falls on them; greys have none."""
    hue, saturation, value = np.moveaxis(rgb_to_hsv(image / 255), 2, 0)
    off = (360 * (hue - rgb_to_hsv(to_rgb(colour))[0]) + 180) % 360 - 180
    return int(((np.abs(off) <= within) & (saturation * value > CHROMA)).sum())


def differs(before, after, tolerance=8):
    """In how many pixels two pictures of one size differ by more than a tolerance (of 255, in any channel)."""
    return int((np.abs(before.astype(int) - after).max(axis=2) > tolerance).sum())
