"""The 3D picture: a linkage, its paths, ghosts and arrows in a viser scene, moved by their handles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from viser import GridHandle, LineSegmentsHandle, SceneApi, SceneNodeHandle

from sevenbar.arrays import Floats
from sevenbar.drawing.scene import paths, view
from sevenbar.drawing.skeleton import Skeleton
from sevenbar.drawing.style import PATH
from sevenbar.drawing.view import directions
from sevenbar.kinematics.circuits.extents import Flags
from sevenbar.kinematics.loop.rigid import cross, quaternion, rotation_of
from sevenbar.studio.pictures.batches import Batches, Labels
from sevenbar.studio.pictures.poses import Colours, Poses, SolidPlan, poses, stretched
from sevenbar.studio.pictures.solids import plan, rgb

#: Where an axis line has its dashes and the dots between them, as shares of its length.
DASHES = np.array(
    [pair for k in range(7) for pair in ((0.15 * k, 0.15 * k + 0.1), (0.15 * k + 0.12, 0.15 * k + 0.13))][:-1]
)
#: How far an axis is drawn beyond its two places, as a share of the linkage's extent.
OVERHANG = 0.07
#: Thicknesses of lines [pixels].
AXIS_LINE, JOINT_PATH, POINT_PATH = 1.4, 1.8, 2.8
#: The lines of axodes: how thick [pixels], and their colours.
AXODE_LINE, FIXED_AXODE, MOVING_AXODE = 1.0, "#56B4E9", "#CC79A7"
#: How much white is in the path of a joint that has its link's colour.
PALE = 0.4
#: How much white is in a path where a stop keeps the linkage from going, linear in light.
BEYOND = 0.65
#: Opacity of ghosts, and the most there are.
GHOST, MOST_GHOSTS = 0.2, 16
#: Radii of an arrow's shaft and head, and its head's length; a mark's radius [1].
SHAFT, HEAD, HEAD_LENGTH, MARK = 0.011, 0.03, 0.095, 0.022
#: How much thicker arrows of joints are: the force of a rod lies within it, and has to be seen round it.
STOUT = 1.8
#: From a place to its label.
ABOVE = np.array([0.0, 0.0, 0.045])
#: The head's greatest share of a short arrow.
HEAD_MOST = 0.5
#: The camera's field of view from bottom to top [rad], narrow as machines are drawn, that `look` reckons
#: with; how much of it the motion fills; and how wide the picture is taken to be, in heights.
FIELD, FILL, ASPECT = math.radians(30.0), 0.84, 1.2
#: How bright the sky is, and the lights and whence they shine.
SKY = 2.2
LIGHTS = {"key": (2.4, (0.6, -1.0, 1.6)), "fill": (0.8, (-1.4, -0.4, 0.5)), "back": (0.5, (0.3, 1.2, 0.8))}
#: The darkest grey of a state that is out of date, 0 to 255, linear in light.
GREYEST = 95
#: How far the floor lies below the lowest place [1].
FLOOR = 0.14

#: The axes' colour, as lines of one colour take it, and the marks'.
AXIS_COLOUR, MARK_COLOUR = np.array([72, 72, 72], np.uint8), "#303030"

#: An arrow by its origin and vector (3,) [length], its colour and its label.
Arrow = tuple[Floats, Floats, str, str]


class Stage:
    """A linkage in a scene, `server.scene` or `client.scene`.

    The scene has a scale of its own, at which the motion fills a ball of radius 1; only `frame_view` sets
    it, so that dragging a dimension does not. Call `frame_view`, `set` and `pose`, in this order.
    """

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._fresh, self._size = False, 1.0
        self.centre, self.scale = np.zeros(3), 1.0
        #: What is seen as right, up and towards the reader, in columns; as a planar linkage lies, else None.
        self.plane: Floats | None = None
        self._within: Flags | None = None
        self._grey, self._labels_on, self._axes_on, self._paths_on = False, False, True, True
        self._solids, self._ghosts = Batches(scene, "/linkage"), Batches(scene, "/ghosts", opacity=GHOST)
        self._marks = Batches(scene, "/marks")
        self._names = Labels(scene, "/names")
        self._mark_labels = Labels(scene, "/mark_labels")
        self._arrows = {
            "points": (1.0, Batches(scene, "/arrows"), Labels(scene, "/arrow_labels")),
            "joints": (STOUT, Batches(scene, "/force_arrows"), Labels(scene, "/force_labels")),
        }
        self._lines: dict[str, LineSegmentsHandle] = {}
        self._path_colours: dict[str, Colours] = {}
        self._grid: GridHandle | None = None
        self._plan: SolidPlan | None = None
        self._moving: SolidPlan | None = None
        self._frame: Skeleton | None = None
        self._places: Floats | None = None
        scene.set_up_direction("+z")
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map(None)
        sky = scene.add_light_hemisphere(
            "/lights/sky", intensity=SKY, ground_color=(205, 208, 214), position=(0.0, 0.0, 1.0)
        )
        self._lights: list[tuple[SceneNodeHandle, tuple[float, float, float]]] = [(sky, (0.0, 0.0, 1.0))]
        for name, (intensity, place) in LIGHTS.items():
            light = scene.add_light_directional(f"/lights/{name}", intensity=intensity, position=place)
            self._lights.append((light, place))

    @property
    def up(self) -> Floats:
        """The direction (3,) that is up for the camera."""
        return np.array([0.0, 0.0, 1.0]) if self.plane is None else self.plane[:, 1]

    def _lie(self, screen: Floats | None) -> None:
        """Turns the lights to a linkage that is seen in its plane, or back."""
        plane = None if screen is None else np.column_stack([*screen, cross(screen[0], screen[1])])
        same = plane is self.plane or (
            plane is not None and self.plane is not None and np.array_equal(plane, self.plane)
        )
        self.plane = plane
        if same:
            return
        for light, place in self._lights:
            light.position = np.array(place) if plane is None else plane @ place

    def frame_view(self, places: Floats, screen: Floats | None = None) -> None:
        """Fixes scale and centre such that places (..., 3) [length] fill the view; lays the floor below.

        `screen` (2, 3) is what is seen as right and up of a planar linkage; the floor then is behind it.
        """
        self._lie(screen)
        turned = np.eye(3) if self.plane is None else self.plane
        flat = places.reshape(-1, 3)
        flat = flat[np.isfinite(flat).all(axis=1)]
        low, high = flat.min(axis=0), flat.max(axis=0)
        self.centre = (low + high) / 2
        radius = float(np.linalg.norm(flat - self.centre, axis=1).max())
        self.scale = 1.0 / radius if radius > 0 else 1.0
        below = float(((flat - self.centre) @ turned[:, 2]).min()) * self.scale - FLOOR
        if self._grid is None:
            self._grid = self._scene.add_grid(
                "/floor",
                plane="xy",
                width=6.0,
                height=6.0,
                cell_size=0.2,
                section_size=1.0,
                cell_color=(232, 234, 237),
                section_color=(214, 217, 222),
                fade_distance=4.5,
                fade_strength=1.6,
                fade_from="origin",
                position=(0.0, 0.0, below),
            )
        self._grid.position, self._grid.wxyz = below * turned[:, 2], quaternion(turned)

    def in_scene(self, places: Floats) -> Floats:
        """Places (..., 3) [length] in the scene's own frame."""
        return (places - self.centre) * self.scale

    def from_scene(self, places: Floats) -> Floats:
        """Places (..., 3) [length] from those in the scene's own frame."""
        return np.asarray(places / self.scale + self.centre)

    def look(self, aspect: float = ASPECT, also: Floats | None = None) -> tuple[Floats, Floats]:
        """Where the camera stands and what it looks at, in the scene, to see the whole motion well.

        `aspect` is the picture's width over its height; places `also` (n, 3) [length] are to be seen too.
        """
        if self._frame is None:
            return np.array([2.0, -2.0, 1.5]), np.zeros(3)
        seen_as = directions(*view(self._frame)) if self.plane is None else self.plane.T[:2]
        right, above = seen_as
        back = np.cross(right, above)
        axes = np.stack([right, above, back])
        every = self._drawn() if also is None else np.concatenate([self._drawn(), also])
        seen = self.in_scene(every) @ axes.T
        middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
        seen -= middle
        half = math.tan(FIELD / 2) * FILL
        distance = float((seen[:, 2] + np.abs(seen[:, :2] / (aspect, 1.0)).max(axis=1) / half).max())
        target = middle @ axes
        return target + distance * back, target

    def _drawn(self) -> Floats:
        """Places (n, 3) [length] that all that is drawn along the motion lies between."""
        if self._frame is None or self._plan is None:
            return np.empty((0, 3))
        every = self._frame.places
        drawn = [every.reshape(-1, 3)]
        for turn, middle, scale in poses(self._plan, every[:: max(1, len(every) // 24)]).values():
            half = rotation_of(turn)[..., 2] * scale[..., 2:] / 2
            shown = scale[..., 2] > 0
            drawn += [(middle - half)[shown], (middle + half)[shown]]
        places = np.concatenate(drawn)
        return places[np.isfinite(places).all(axis=1)]

    def set(self, frame: Skeleton, ends: tuple[str, str], within: Flags | None = None) -> None:
        """Takes another linkage or circuit, by its frame and the columns of input and output.

        Its paths are drawn at once, pale where rows are not `within` (n,) the stops; its solids, axes and
        names by the `pose` that must follow.
        """
        self._within = within
        self._size = frame.span
        self._plan = plan(frame, ends)
        self._moving, self._frame = self._plan.moving(), frame
        self._places, self._fresh = None, True
        drawn, count = paths(frame, ends), len(frame.points)
        joints = [(place, rgb(colour, 0.0 if colour == PATH else PALE)) for place, colour in drawn[count:]]
        self._draw_path("joints", joints, JOINT_PATH)
        self._draw_path("points", [(place, rgb(colour)) for place, colour in drawn[:count]], POINT_PATH)

    def clear(self) -> None:
        """Takes everything out of the scene; the floor stays."""
        self._plan = self._moving = self._frame = self._places = None
        for of in self._arrows:
            self.arrows([], of)
        for batches in (self._solids, self._ghosts, self._marks):
            batches.clear()
        for labels in (self._names, self._mark_labels):
            labels.put([], np.empty((0, 3)))
        for name in list(self._lines):
            self._lines.pop(name).remove()
        self._path_colours.clear()

    def pose(self, places: Floats) -> None:
        """Moves the linkage to a pose, places (k, 3) [length] as those of the frame."""
        if self._plan is None:
            return
        self._places = places
        colours = self._colours(self._plan) if self._fresh else None
        self._fresh = False
        self._solids.put(self._shown(poses(self._plan, places)), colours)
        self._draw_axes()
        self._draw_names()

    def ghosts(self, shown: Sequence[tuple[Floats, str | None]]) -> None:
        """Faint copies of links and joints at up to 16 poses (k, 3) [length], each in a colour or its own."""
        if not shown or self._moving is None:
            self._ghosts.clear()
            return
        shown = shown[:MOST_GHOSTS]
        result = poses(self._moving, np.stack([places for places, _ in shown]))
        every = {
            shape: (turn.reshape(-1, 4), middle.reshape(-1, 3), scale.reshape(-1, 3))
            for shape, (turn, middle, scale) in result.items()
        }
        colours = {}
        for shape in result:
            own = self._moving.colours_of(shape)
            each = [own if colour is None else np.tile(rgb(colour), (len(own), 1)) for _, colour in shown]
            colours[shape] = self._shade(np.concatenate(each))
        self._ghosts.put(self._shown(every), colours)

    def arrows(self, rows: Sequence[Arrow], of: str = "points") -> None:
        """The arrows of points or of joints; none clears those."""
        stout, arrows, labels = self._arrows[of]
        if not rows:
            arrows.clear()
            labels.put([], np.empty((0, 3)))
            return
        origins, vectors, names, texts = zip(*rows, strict=True)
        start, direction = self.in_scene(np.array(origins, float)), np.array(vectors, float) * self.scale
        length = np.linalg.norm(direction, axis=1, keepdims=True)
        neck = start + direction * (
            1 - np.minimum(HEAD_LENGTH / np.where(length > 0, length, 1.0), HEAD_MOST)
        )
        colours = self._shade(np.array([rgb(name) for name in names]))
        shafts = stretched(start, neck, stout * SHAFT)
        heads = stretched(neck, start + direction, stout * HEAD)
        arrows.put({"cylinder": shafts, "cone": heads}, {"cylinder": colours, "cone": colours})
        labels.put(list(texts), start + direction + ABOVE / 2)

    def marks(self, points: Floats, labels: Sequence[str]) -> None:
        """Little marks at points (n, 3) [length], with a text each; none clears them."""
        places = self.in_scene(np.asarray(points, float).reshape(-1, 3))
        known = np.isfinite(places).all(axis=1, keepdims=True)
        self._mark_labels.put(list(labels), places + ABOVE)
        if not len(places):
            self._marks.clear()
            return
        turn, scale = np.tile([1.0, 0.0, 0.0, 0.0], (len(places), 1)), np.full((len(places), 3), MARK)
        balls = (turn, np.where(known, places, 0.0), np.where(known, scale, 0.0))
        self._marks.put({"ball": balls}, {"ball": np.tile(rgb(MARK_COLOUR), (len(places), 1))})

    def axodes(self, fixed: Floats, moving: Floats) -> None:
        """Draws the lines (n, 2, 3) [length] of a fixed and of a moving axode; none clears them."""
        for name, lines, colour in (
            ("fixed_axode", fixed, FIXED_AXODE),
            ("moving_axode", moving, MOVING_AXODE),
        ):
            self._draw_lines(name, self.in_scene(lines), rgb(colour, PALE), AXODE_LINE)

    def labels(self, on: bool) -> None:
        """Shows or hides the names of joints and points."""
        self._labels_on = on
        self._draw_names()

    def axes(self, on: bool) -> None:
        """Shows or hides the joints' axes."""
        self._axes_on = on
        if "axes" in self._lines:
            self._lines["axes"].visible = on
        self._draw_axes()

    def paths(self, on: bool) -> None:
        """Shows or hides the paths of joints and points."""
        self._paths_on = on
        for name in ("joints", "points"):
            if name in self._lines:
                self._lines[name].visible = on

    def grey(self, on: bool) -> None:
        """Shows linkage and ghosts in greys, for a state that is out of date; or in their colours again."""
        if on == self._grey:
            return
        self._grey = on
        if self._plan is not None and not self._fresh:
            self._solids.paint(self._colours(self._plan))
        for name, colours in self._path_colours.items():
            self._lines[name].colors = self._shade(colours)

    def _colours(self, shown: SolidPlan) -> dict[str, Colours]:
        return {shape: self._shade(shown.colours_of(shape)) for shape in shown.shapes}

    def _shade(self, colours: Colours) -> Colours:
        """The colours (..., 3), as greys where all is grey."""
        if not self._grey:
            return colours
        light = GREYEST + (1 - GREYEST / 255) * 0.5 * (colours @ np.array([0.21, 0.72, 0.07]))
        return np.repeat(light[..., None], 3, axis=-1).astype(np.uint8)

    def _shown(self, poses: Poses) -> Poses:
        return {
            shape: (turn, self.in_scene(middle), scale * self.scale)
            for shape, (turn, middle, scale) in poses.items()
        }

    def _draw_path(self, name: str, places: Sequence[tuple[int, Colours]], thickness: float) -> None:
        self._path_colours.pop(name, None)
        if self._frame is None or not places:
            self._draw_lines(name, np.empty((0, 2, 3)), np.empty((0, 2, 3), np.uint8), thickness)
            return
        trace = self.in_scene(self._frame.places[:, [place for place, _ in places]])
        steps = np.stack([trace[:-1], trace[1:]], axis=2)
        colours = np.array([colour for _, colour in places])
        colours = np.broadcast_to(colours[None, :, None], steps.shape)
        if self._within is not None:
            beyond = ~(self._within[:-1] & self._within[1:])
            white = BEYOND * 255 + (1 - BEYOND) * colours
            colours = np.where(beyond[:, None, None, None], white.astype(np.uint8), colours)
        colours = colours.reshape(-1, 2, 3)
        self._draw_lines(name, steps.reshape(-1, 2, 3), self._shade(colours), thickness)
        if name in self._lines:
            self._path_colours[name] = colours

    def _draw_axes(self) -> None:
        if not self._axes_on or self._plan is None or self._places is None:
            return
        start, end = np.moveaxis(self.in_scene(self._plan.known(self._places)[self._plan.axes]), 1, 0)
        direction = end - start
        length = np.linalg.norm(direction, axis=1, keepdims=True)
        beyond = self._size * OVERHANG * self.scale * direction / np.where(length > 0, length, 1.0)
        start, direction = start - beyond, direction + 2 * beyond
        dashes = start[:, None, None] + DASHES[..., None] * direction[:, None, None]
        self._draw_lines("axes", dashes.reshape(-1, 2, 3), AXIS_COLOUR, AXIS_LINE)

    def _draw_lines(self, name: str, steps: Floats, colours: Colours, thickness: float) -> None:
        """Draws segments (n, 2, 3); those with NaN are drawn as nothing, at the place of another."""
        handle = self._lines.get(name)
        known = np.isfinite(steps.sum(axis=(1, 2)))
        if not known.any():
            if handle is not None:
                self._lines.pop(name).remove()
            return
        if not known.all():
            steps = np.where(known[:, None, None], steps, steps[known][0, 0])
        if handle is not None and len(handle.points) == len(steps):
            handle.points = steps.astype(np.float32)
            if not np.array_equal(handle.colors, colours):
                handle.colors = colours
            return
        on = self._axes_on if name == "axes" else self._paths_on
        self._lines[name] = self._scene.add_line_segments(
            f"/{name}", steps, colours, thickness=thickness, thickness_units="screen", visible=on
        )

    def _draw_names(self) -> None:
        if self._plan is None or self._places is None:
            return
        named = self._plan.labels if self._labels_on else ()
        places = self._places[[place for _, place in named]]
        self._names.put([text for text, _ in named], self.in_scene(places) + ABOVE)
