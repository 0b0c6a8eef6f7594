"""Solids in the browser: one batch of instances for each shape, moved without sending its mesh again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.studio.pictures.poses import Colours, Poses
from sevenbar.studio.pictures.shapes import mesh

if TYPE_CHECKING:
    from viser import BatchedMeshHandle, LabelHandle, SceneApi

#: Scales are rounded to this many digits, so that the rounding of a rigid link's length is not sent as news.
SCALE_DIGITS = 6


class Batches:
    """The solids under one name in the scene."""

    def __init__(self, scene: SceneApi, name: str, *, opacity: float | None = None) -> None:
        self._scene, self._name, self._opacity = scene, name, opacity
        self._handles: dict[str, BatchedMeshHandle] = {}

    def put(self, poses: Poses, colours: Mapping[str, Colours] | None = None) -> None:
        """Moves the solids; where a shape is new or its count another, colours must be given."""
        for shape in [shape for shape in self._handles if shape not in poses]:
            self._handles.pop(shape).remove()
        for shape, (turn, middle, scale) in poses.items():
            handle, scale = self._handles.get(shape), np.round(scale, SCALE_DIGITS)
            if handle is not None and len(handle.batched_positions) == len(middle):
                handle.batched_wxyzs = turn.astype(np.float32)
                handle.batched_positions = middle.astype(np.float32)
                handle.batched_scales = scale.astype(np.float32)
                # colours seldom change, and viser takes long to find that
                if colours is not None and not np.array_equal(handle.batched_colors, colours[shape]):
                    handle.batched_colors = colours[shape]
            elif colours is not None:
                # viser swaps a node for another of the same name at once
                self._handles[shape] = self._scene.add_batched_meshes_simple(
                    f"{self._name}/{shape.replace(' ', '_')}",
                    *mesh(shape),
                    batched_wxyzs=turn,
                    batched_positions=middle,
                    batched_scales=scale,
                    batched_colors=colours[shape],
                    opacity=self._opacity,
                    lod="off",
                    cast_shadow=False,
                    receive_shadow=False,
                )

    def paint(self, colours: Mapping[str, Colours]) -> None:
        """Gives the solids other colours (N, 3), by shape."""
        for shape, handle in self._handles.items():
            handle.batched_colors = colours[shape]

    def clear(self) -> None:
        """Takes the solids out of the scene."""
        self.put({})


class Labels:
    """The texts under one name in the scene."""

    def __init__(self, scene: SceneApi, name: str) -> None:
        self._scene, self._name = scene, name
        self._handles: list[LabelHandle] = []

    def put(self, texts: list[str], places: Floats) -> None:
        """Writes texts at places (n, 3), centred above them; a place that is NaN gets none."""
        while len(self._handles) > len(texts):
            self._handles.pop().remove()
        for i, (text, place) in enumerate(zip(texts, places, strict=True)):
            known = bool(np.isfinite(place).all())
            if i == len(self._handles):
                self._handles.append(
                    self._scene.add_label(
                        f"{self._name}/{i}", text, anchor="bottom-center", font_screen_scale=1.05
                    )
                )
            handle = self._handles[i]
            handle.text = text
            handle.visible = known
            if known:
                handle.position = place
