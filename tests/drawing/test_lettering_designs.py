"""Letters keep apart in the figures of designs, too: maps, tolerances, syntheses and points, in every style and language."""

from functools import cache

import numpy as np
import pytest

import sevenbar as sb
from lettered import collisions
from sevenbar.description.draft import Draft
from sevenbar.design.maps import atlas
from sevenbar.design.maps.atlas import motion_map
from sevenbar.design.maps.figures import draw
from sevenbar.design.maps.heights import measure_heights, with_contours
from sevenbar.design.points import inertia, least_point, nearest_path_point
from sevenbar.design.points.figures import inertia_figure, least_figure, nearest_figure
from sevenbar.design.points.poles import poles_of
from sevenbar.design.synthesis import function_generation, swing_generation
from sevenbar.design.synthesis.function.figures import function_figure, swing_figure
from sevenbar.design.synthesis.path.figures import path_figure
from sevenbar.design.synthesis.path.generation import generated, path_task
from sevenbar.design.tolerance.figures import deviation_figure, shares_figure
from sevenbar.design.tolerance.linear import linear_estimate
from sevenbar.design.tolerance.samples import monte_carlo
from sevenbar.design.tolerance.sensitivities import sensitivities
from sevenbar.drawing.asked import drawn_as
from sevenbar.text.words import language

TOLERANCES = {
    "rssr": {"*": 0.5},
    "rscr": {"*": 0.1},
    "seven_r": {"length_*": 0.1, "twist_*": "0.1deg"},
}


@cache
def map_of(name):
    over = {"rssr": {"L1": "100:400", "L3": "300:800"}}.get(
        name, {"length_1": "20:120", "length_3": "20:120"}
    )
    with pytest.MonkeyPatch.context() as patch:
        # boundaries less smooth, which have the same letters
        patch.setattr(atlas, "LOOP", atlas.LOOP._replace(tolerance=1e-2))
        return motion_map(sb.load(name), over, grid=13 if name == "rssr" else 5)


@cache
def heights_of(name):
    return measure_heights(map_of(name), with_contours(["transmission_lowest"]))[0]


@cache
def tolerance_of(name):
    linear = linear_estimate(sensitivities(sb.load(name), samples=36), TOLERANCES[name])
    return linear, monte_carlo(linear.found, linear, 40)


@cache
def path_of(name):
    draft = Draft.of_linkage(sb.load(name)).with_point("Q", 2, (30.0, 12.0, -8.0))
    wanted = draft.linkage.motion(24)[0].point("Q").position[:9]
    task = path_task(draft, wanted, "Q", vary=["Q.*"])
    return task, generated(task, count=1, starts=2, seed=0).designs[0]


@cache
def nearest_of(name):
    motion = sb.load(name).motion(48)
    wanted = motion[0].point(2, (20.0, 30.0, 0.0)).position[::6] + 1
    return nearest_path_point(motion, 2, wanted, [(-200, 200)] * 3)


@cache
def least():
    found = least_point(sb.load("seven_r").motion(72), 4, [(-200, 200)] * 3)
    return found, poles_of(found.cycle, found.at)


@cache
def function():
    return function_generation(function=lambda x: x**2, x_range=(0.0, 1.0), count=1)


@cache
def swing():
    return swing_generation(np.pi / 3, 1.2, count=1)


#: Every kind of figure of a design.
FIGURES = {
    "map, rssr": lambda: draw(map_of("rssr")),
    "map without key": lambda: draw(map_of("rssr"), side=False),
    "map, planar": lambda: draw(map_of("planar_4r")),
    "contours, rssr": lambda: draw(map_of("rssr"), heights_of("rssr")),
    "contours, planar": lambda: draw(map_of("planar_4r"), heights_of("planar_4r")),
    **{f"shares, {n}": lambda n=n: shares_figure(tolerance_of(n)[0]) for n in TOLERANCES},
    **{f"deviation, {n}": lambda n=n: deviation_figure(*tolerance_of(n)) for n in TOLERANCES},
    "path, planar": lambda: path_figure(*path_of("planar_4r")),
    "path, rssr": lambda: path_figure(*path_of("rssr")),
    "nearest, rssr": lambda: nearest_figure(nearest_of("rssr"), "nearest"),
    "nearest, planar": lambda: nearest_figure(nearest_of("planar_4r"), "nearest"),
    "least": lambda: least_figure(*least(), "least_acceleration"),
    "inertia": lambda: inertia_figure(inertia(sb.load("seven_r").motion(72), {"P": 2.5})),
    "function": lambda: function_figure(function().candidates[0], function().wish),
    "swing": lambda: swing_figure(swing().candidates[0]),
}


@pytest.mark.usefixtures("fonts_of_matplotlib")
@pytest.mark.parametrize(
    ("name", "style"),
    [(name, style) for name in FIGURES for style in ("screen", "paper", "ieee")],
)
def test_no_text_of_a_design_s_figure_lies_on_another_or_leaves_the_page(name, style, monkeypatch):
    with drawn_as(style=style):
        assert collisions(FIGURES[name](), monkeypatch) == []


@pytest.mark.usefixtures("chinese_font")
@pytest.mark.parametrize("name", FIGURES)
def test_nor_does_it_in_chinese(name, monkeypatch):
    with drawn_as(style="paper"), language("zh"):
        assert collisions(FIGURES[name](), monkeypatch) == []


def test_a_style_makes_the_page_as_wide_as_its_columns():
    for style, widths in (("paper", (85, 170)), ("ieee", (88.9, 181.864))):
        with drawn_as(style=style):
            assert shares_figure(tolerance_of("rssr")[0]).get_figwidth() * 25.4 == pytest.approx(widths[0])
            assert draw(map_of("rssr")).get_figwidth() * 25.4 == pytest.approx(widths[1])
            assert draw(map_of("rssr"), size="A3").get_figwidth() == 16.54
