"""The dimensions on the page: each a slider and a box, with what is wrong with a value below them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import viser

from sevenbar.errors import SevenbarError
from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.studio.panels.controls import PAUSE, Alert, on_change, put
from sevenbar.studio.worker import Worker
from sevenbar.text.units import ANGLES

#: Steps of a slider over its range, at most.
STEPS = 1000
#: A slider that could be so many times shorter is too wide to be of use.
MUCH = 6.0
#: Least room on a slider; steps of a smaller one would round to nothing.
LEAST = 1e-290


class DimensionRow:
    """A slider and a box for one dimension."""

    def __init__(
        self,
        gui: viser.GuiApi,
        worker: Worker,
        dimension: Dimension,
        size: float,
        shape: Callable[[Dimension, float], None],
    ) -> None:
        """`shape` changes a dimension, or raises `SevenbarError`; `size` is the linkage's greatest length."""
        self.dimension, self._worker, self._size, self._shape = dimension, worker, size, shape
        low, high, step = slider_range(dimension, size)
        label = f"{dimension.label} [{dimension.unit}]" if dimension.unit else dimension.label
        hint = f"{dimension.key}; it follows from the others until it is given" if dimension.follows else None
        self._box = gui.add_text(label, number_text(dimension.value), hint=hint)
        self._slider = gui.add_slider("", min=low, max=high, step=step, initial_value=dimension.value)
        self._alert = Alert(gui)
        on_change(self._slider, worker, dimension.place, lambda value: self._take(lambda: float(value)))
        on_change(
            self._box,
            worker,
            ("typed", dimension.place),
            lambda text: self._take(lambda: self.dimension.read(text)),
            delay=PAUSE,
        )

    def _take(self, read: Callable[[], float]) -> None:
        def change() -> None:
            value = read()
            if value != self.dimension.value:
                self._shape(self.dimension, value)
            else:
                # nothing follows, which would clear the box of what was refused
                self._written(value)

        if not self._alert.tried(change):
            put(self._slider, self.dimension.value)

    def show(self, dimension: Dimension) -> None:
        """Shows the value that the description has now."""
        self.dimension = dimension
        self._within(dimension.value)
        # while a person drags, the slider is ahead of the description
        if not self._worker.awaits(dimension.place):
            put(self._slider, dimension.value)
        # nor is a box set in which a person writes
        if not self._worker.awaits(("typed", dimension.place)):
            self._written(dimension.value)

    def _written(self, value: float) -> None:
        """Has the box say a value; what a person wrote stays as it is written."""
        try:
            written = self.dimension.read(self._box.value)
        except SevenbarError:
            written = math.nan
        if written != value:
            put(self._box, number_text(value))
            self._alert.clear()

    def _within(self, value: float) -> None:
        """Widens the slider until it holds a value, or narrows one that is far too wide."""
        wide = self._slider.max > MUCH * slider_range(self.dimension, self._size)[1]
        if wide or not self._slider.min <= value <= self._slider.max:
            self._slider.min, self._slider.max, self._slider.step = slider_range(self.dimension, self._size)


def number_text(value: float) -> str:
    """A number as people write it, without digits that only rounding has made."""
    return f"{value:.12g}"


def slider_range(dimension: Dimension, size: float) -> tuple[float, float, float]:
    """Least value, greatest value and step of a slider that holds the value in its middle, or near it.

    `size` is the greatest length of the linkage; dimensions much smaller than it get room to grow.
    """
    value = abs(dimension.value)
    if dimension.unit in ANGLES:
        most = 180.0 if dimension.unit == "deg" else 3.15
        while value > most:
            most *= 2
        return -most, most, most / 360
    is_length = dimension.unit != "" and "/" not in dimension.unit
    room = max(size / 5, LEAST) if is_length else 1.0
    most = _nice(2 * max(value, room))
    if dimension.positive:
        step = _nice(most / STEPS)
        return min(step, value), most, step
    return -most, most, _nice(2 * most / STEPS)


def _nice(value: float) -> float:
    """The next of 1, 2, 5, 10, 20, .."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= value * (1 - 1e-9))


def largest_length(dimensions: Sequence[Dimension]) -> float:
    """The greatest length among dimensions, 1 where all are 0."""
    lengths = (abs(d.value) for d in dimensions if d.unit and d.unit not in ANGLES and "/" not in d.unit)
    return max(lengths, default=0.0) or 1.0
