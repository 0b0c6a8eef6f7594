"""Running the motion: play, step, scrub along the input, and the choice of circuit and mode."""

from __future__ import annotations

import math
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from sevenbar.kinematics.circuits.poses import at_row
from sevenbar.kinematics.loop.joint_text import joint_value
from sevenbar.kinematics.ranges.reach import Reach, stopped_by
from sevenbar.reporting.shown import value_text
from sevenbar.studio.panels.controls import PAUSE, Alert, on_change, put, settle
from sevenbar.studio.state.session import Session
from sevenbar.studio.state.verdict import heading
from sevenbar.studio.state.view import View
from sevenbar.studio.worker import Worker

#: A cycle takes so long [s] at the speed "1 x".
CYCLE = 6.0
SPEEDS = {"1/8 x": 0.125, "1/4 x": 0.25, "1/2 x": 0.5, "1 x": 1.0, "2 x": 2.0, "4 x": 4.0}
#: Values below this share of the linkage's size are 0.
ZERO = 1e-12
STEPS = {"-10": -10, "-1": -1, "+1": 1, "+10": 10}


class Transport:
    """The controls that move the linkage, above all others."""

    def __init__(self, gui: viser.GuiApi, worker: Worker, session: Session) -> None:
        self._worker, self._session = worker, session
        self._heading = gui.add_html("")
        self._play = gui.add_button("Play", icon=viser.Icon.PLAYER_PLAY_FILLED, hint="the space bar, too")
        self._steps = gui.add_button_group("step samples", tuple(STEPS))
        self._travel = gui.add_slider("input", min=0.0, max=360.0, step=0.5, initial_value=0.0)
        self._goto = gui.add_text("go to input", "", hint="a value of the input, as in 30, 30deg or 0.5rad")
        self._alert = Alert(gui)
        self._reading = gui.add_html("")
        self._circuit = gui.add_dropdown("circuit", ("0",))
        self._next = gui.add_button("Next mode at this input", color="gray", icon=viser.Icon.ARROWS_SHUFFLE)
        self._speed = gui.add_dropdown(
            "speed", tuple(SPEEDS), initial_value="1 x", hint="at 1 x a cycle takes six seconds"
        )
        self._held = gui.add_checkbox(
            "halt at stops",
            True,
            hint="ranges of joints, cones of balls and radii of rods that the file gives",
        )
        command = gui.add_command("Play or pause", hotkey="space")
        command.on_trigger(lambda _: worker.ask("play", self._toggle))
        self._play.on_click(lambda _: worker.ask("play", self._toggle))
        self._next.on_click(lambda _: worker.ask("mode", session.next_mode))
        self._steps.on_click(self._stepped)
        on_change(self._travel, worker, "scrub", lambda to: self._halt_and(lambda: self._seek(float(to))))
        on_change(
            self._goto, worker, "goto", lambda text: self._halt_and(lambda: self._go(text)), delay=PAUSE
        )
        on_change(self._circuit, worker, "circuit", lambda text: session.choose(int(text.partition(":")[0])))
        on_change(self._held, worker, "held", session.hold)
        self._shown: tuple[object, ...] = ()

    def tick(self, seconds: float) -> None:
        """Lets the linkage run for seconds of a person's time."""
        view = self._session.view
        if view is not None:
            self._session.advance(seconds * view.period / CYCLE * SPEEDS[self._speed.value])

    def _toggle(self) -> None:
        self._worker.playing = not self._worker.playing and self._session.view is not None
        pause, play = ("Pause", viser.Icon.PLAYER_PAUSE_FILLED), ("Play", viser.Icon.PLAYER_PLAY_FILLED)
        self._play.label, self._play.icon = pause if self._worker.playing else play

    def pause(self) -> None:
        """Ends what plays."""
        if self._worker.playing:
            self._toggle()

    def _stepped(self, event: viser.GuiEvent[Any]) -> None:
        rows = STEPS[event.target.value]
        self._worker.ask(("step", object()), lambda: self._halt_and(lambda: self._session.step(rows)))

    def _halt_and(self, action: Callable[[], None]) -> None:
        self.pause()
        action()

    def _seek(self, travel: float) -> None:
        view, reach = self._session.view, self._session.reach
        if view is not None:
            time = travel / abs(_shown_speed(view))
            if reach is not None:
                # the slider's own ends are rounded
                ends = {self._travel.min: reach.times[0], self._travel.max: reach.times[1]}
                self._session.seek(reach.row_at(ends.get(travel, time)))
                return
            last = len(view.path.rows) - 1
            self._session.seek(last if time >= view.period else view.row_at(max(time, 0.0)))

    def _go(self, text: str) -> None:
        view = self._session.view
        if view is None or not text.strip():
            self._alert.clear()
            return
        linkage, column = view.linkage, view.circuit.input_column
        self._alert.tried(lambda: self._session.seek_input(joint_value(text, "input", linkage, column)))

    def show(self) -> None:
        """Shows the session as it is."""
        session, view, reach = self._session, self._session.view, self._session.reach
        shown = (view, session.draft, session.problem, reach)
        if any(a is not b for a, b in zip(shown, self._shown, strict=False)) or not self._shown:
            self._shown = shown
            settle(self._heading, content=heading(session))
            self._offer(view, reach)
        if view is None:
            self._reading.content = ""
            return
        time = view.time_at(session.row) if reach is None else reach.time_at(reach.unrolled(session.row))
        travel = time * abs(_shown_speed(view))
        if abs(travel - self._travel.value) > 1e-6 and not self._worker.awaits("scrub"):
            put(self._travel, min(max(travel, self._travel.min), self._travel.max))
        self._reading.content = _reading(session, view)

    def _offer(self, view: View | None, reach: Reach | None) -> None:
        """What can be chosen of the motion on view, up to its stops."""
        for control in (self._play, self._travel, self._goto, self._circuit, self._next):
            settle(control, disabled=view is None)
        if view is None:
            self.pause()
            return
        options = tuple(f"{c.index}: {c.motion_type}" for c in view.motion)
        settle(self._circuit, options=options)
        put(self._circuit, options[view.circuit.index])
        settle(self._held, visible=bool(view.linkage.stops.stops))
        first, last = (0.0, view.period) if reach is None else reach.times
        low, high = (time * abs(_shown_speed(view)) for time in (first, last))
        high = high if high > low else low + 1.0
        if reach is not None:
            # the ends are written below the slider, and stops seldom are at round values
            low, high = (round(end, 3 - math.floor(math.log10(high - low))) for end in (low, high))
        unit = view.linkage.length_unit if _slides(view) else "deg"
        there = "" if view.circuit.goes_round else ", there and back"
        between = "" if reach is None else ", between stops"
        label = f"input{there}{between} [{unit}]"
        settle(self._travel, min=low, max=high, step=(high - low) / 720, label=label)


def _slides(view: View) -> bool:
    return not view.linkage.turns(view.circuit.input_column)


def _shown_speed(view: View) -> float:
    """The input's speed in the unit in which the page shows it: deg/s, or length/s."""
    return view.motion.speed if _slides(view) else math.degrees(view.motion.speed)


def _reading(session: Session, view: View) -> str:
    """Where the linkage stands: input, output, time and mode."""
    circuit = view.circuit
    second = float(at_row(view.path.output, session.row)) + view.whole_turns(circuit.output_column)
    # a slide at zero is so up to rounding only
    second = 0.0 if abs(second) < ZERO * circuit.size else second
    way = ""
    if not circuit.goes_round:
        way = " rising" if view.path.sign[int(session.row)] * view.motion.speed > 0 else " falling"
    modes, reach = session.modes(), session.reach
    lines = [
        f"{view.motion.input} {view.input_text(session.row)}{way}",
        f"{view.motion.output} {value_text(view.linkage, circuit.output_column, second)}",
        f"t = {view.time_at(session.row):.4g} s",
    ]
    if modes:
        lines.append(f"mode {session.mode(modes) + 1} of {len(modes)} at this input")
    if view.linkage.stops.stops:
        beyond = stopped_by(view, session.row)
        if reach is not None and (stop := reach.stop_at(session.row)):
            lines.append(f"at the stop: {stop}")
        elif reach is None and beyond:
            lines.append(f"beyond the stop: {beyond}")
    text = " &nbsp; ".join(escape(line) for line in lines)
    return f'<div style="padding:2px 12px 8px;font-size:12.5px;color:#333">{text}</div>'
