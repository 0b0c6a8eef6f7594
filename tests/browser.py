"""Headless Chromium, its pages, and what their 3D canvas draws."""

import io
import shutil
import time
from base64 import b64decode
from contextlib import contextmanager
from urllib.parse import urlsplit

import numpy as np
import pytest
from matplotlib.colors import rgb_to_hsv, to_rgb
from PIL import Image

from places import ROOT

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
#: Most of what a page costs is its 3D picture, drawn by the processor: ten a second serve as well as sixty where
#: anything happens, and one a second where nothing does. `wake` says that something does: a hand on the page, a word
#: of the server, a look at the canvas.
SPARED = """
{
    const frame = window.requestAnimationFrame.bind(window), asked = new Map();
    const often = 85, seldom = 1000, awake = 1500;
    let count = 0, woken = 0;
    const draw = id => frame(now => {
        const one = asked.get(id);
        if (asked.delete(id)) one.draw(now);
    });
    const calm = () => performance.now() - woken > awake;
    window.requestAnimationFrame = draw_it => {
        const id = ++count;
        asked.set(id, { draw: draw_it, timer: setTimeout(draw, calm() ? seldom : often, id) });
        return id;
    };
    window.cancelAnimationFrame = id => {
        clearTimeout(asked.get(id)?.timer);
        asked.delete(id);
    };
    window.wake = () => {
        if (calm())
            for (const [id, one] of asked) {
                clearTimeout(one.timer);
                one.timer = setTimeout(draw, 0, id);
            }
        woken = performance.now();
    };
    for (const kind of ["pointerdown", "pointermove", "pointerup", "wheel", "keydown", "input"])
        window.addEventListener(kind, window.wake, { capture: true, passive: true });
    // viser's socket is in a worker
    window.Worker = class extends window.Worker {
        constructor(...given) {
            super(...given);
            this.addEventListener("message", window.wake);
        }
    };
    // what was drawn can be read at any time, which takes a tenth of a screenshot; smooth edges double what it costs
    const context = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, given) {
        const own = { preserveDrawingBuffer: true, antialias: SMOOTH };
        return context.call(this, kind, String(kind).startsWith("webgl") ? { ...given, ...own } : given);
    };
}
"""
#: What the 3D canvas shows after some more pictures are drawn, in its size on the page, as a PNG.
LOOKED = """
async ({ pictures }) => {
    for (let i = 0; i < pictures; i++) {
        window.wake();
        await new Promise(done => requestAnimationFrame(done));
    }
    const canvas = document.querySelector("canvas[data-engine]"), copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.clientWidth, canvas.clientHeight];
    const flat = copy.getContext("2d");
    flat.fillStyle = "white";
    flat.fillRect(0, 0, copy.width, copy.height);
    flat.drawImage(canvas, 0, 0, copy.width, copy.height);
    return copy.toDataURL();
}
"""
#: What a page is sent is drawn two pictures later.
PICTURES = 3
#: From one look at the canvas to the next [ms].
LOOK = 300
#: What anything on a page may take [s]: a guard against hanging, long enough for a machine with other work.
PATIENCE = 600.0
#: Where pictures of pages are kept; ignored by git, removed by `make clean`.
SCREENSHOTS = ROOT / "build" / "screenshots"
#: Below this spread between the channels (of 1) a pixel is grey.
CHROMA = 0.15


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


def person(browser, *, smooth=False, **options):
    """Pages of a browser as if another person had opened it; with `smooth` edges for pictures that people see."""
    context = browser.new_context(**options)
    context.set_default_timeout(PATIENCE * 1e3)
    context.add_init_script(SPARED.replace("SMOOTH", str(smooth).lower()))
    return context


class Pages:
    """The pages of one test, each as if another person had opened it, and what went wrong on them."""

    def __init__(self, browser):
        self.browser = browser
        self.contexts = []
        self.wrong = []

    def __call__(self, url, *, tolerated=(), smooth=False):
        """The page at an address, connected; what holds one of the words tolerated is not wrong."""
        context = person(self.browser, smooth=smooth, viewport=SIZE)
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


def canvas_colours(page, pictures=PICTURES):
    """What the 3D canvas shows after so many pictures, without what lies over it: (height, width, 3), 0 to 255.

    Of a page, or of a frame in it.
    """
    png = page.evaluate(LOOKED, {"pictures": pictures}).partition(",")[2]
    return np.asarray(Image.open(io.BytesIO(b64decode(png))).convert("RGB"))


def settled(page, wanted=None, *, still=True, within=PATIENCE):
    """What the 3D canvas shows once it is still, twice the same, and is as wanted, if that is given.

    Of a film, which is never `still`, what is wanted must be met alone.
    """
    end = time.monotonic() + within
    # a film goes on by itself
    pictures = PICTURES if still else 0
    before = canvas_colours(page, pictures)
    while time.monotonic() < end:
        page.wait_for_timeout(LOOK)
        after = canvas_colours(page, pictures)
        if (not still or np.array_equal(before, after)) and (wanted is None or wanted(after)):
            return after
        before = after
    return pytest.fail(f"the canvas still moves, or is not as wanted, after {within:g} s", pytrace=False)


def changed(page, before, least):
    """What the 3D canvas shows once it is still and differs from a picture in more pixels than so many."""
    return settled(page, lambda after: differs(before, after) > least)


def drawn(image, colour, tolerance=24):
    """How many pixels are within a tolerance (of 255, in each channel) of a colour as matplotlib names it."""
    wanted = 255 * np.array(to_rgb(colour))
    return int((np.abs(image - wanted).max(axis=2) <= tolerance).sum())


def of_hue(image, colour, within=20.0):
    """Which pixels have the hue of a colour to some degrees, whatever light falls on them; greys have none."""
    hue, saturation, value = np.moveaxis(rgb_to_hsv(image / 255), 2, 0)
    off = (360 * (hue - rgb_to_hsv(to_rgb(colour))[0]) + 180) % 360 - 180
    return (np.abs(off) <= within) & (saturation * value > CHROMA)


def tinted(image, colour, within=20.0):
    """How many pixels have the hue of a colour."""
    return int(of_hue(image, colour, within).sum())


def extent(image, colour):
    """Where the pixels of a colour's hue begin and end, across and down, as shares of the picture."""
    seen = of_hue(image, colour)
    across, down = (np.flatnonzero(seen.any(axis=axis)) for axis in (0, 1))
    return across[[0, -1]] / seen.shape[1], down[[0, -1]] / seen.shape[0]


def differs(before, after, tolerance=8):
    """In how many pixels two pictures of one size differ by more than a tolerance (of 255, in any channel)."""
    return int((np.abs(before.astype(int) - after).max(axis=2) > tolerance).sum())
