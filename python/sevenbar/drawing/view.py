"""From where a linkage is seen: in its plane, along an axis, or from a corner."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.asked import asked_view
from sevenbar.errors import RequestError, shown, suggestion
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import cross
from sevenbar.kinematics.solvers.plane_and_sphere import plane_of

#: A view as it is requested: a name, or elevation and azimuth [deg].
Asked = str | Sequence[float] | None

#: Views along an axis: the axes to the right and up, by their numbers.
ALONG = {"xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
#: Elevation and azimuth [deg] from which all three axes are as long.
ISOMETRIC = (math.degrees(math.atan(math.sqrt(0.5))), -45.0)
#: All views with a name.
NAMED = ("plane", "space", *ALONG, "iso")

#: Elevations and, from each side, azimuths [deg] of which the best is taken.
ELEVATIONS, AZIMUTHS = (20.0, 30.0, 45.0), (25.0, 45.0, 65.0)

#: Share of gravity that has to lie in the plane to say what is down there; less is a tilt of the machine.
IN_PLANE = 0.1


@dataclass(frozen=True, eq=False)
class Projection:
    """The directions (2, 3) seen as right and up, and what the drawn coordinates are counted from (3,).

    `flat`: drawn as x-y figure, whose axes have the names `letters`; else in three dimensions, seen from
    `elevation` and `azimuth` [deg]. `planar`: in the plane of a planar loop.
    """

    screen: Floats
    origin: Floats
    flat: bool
    letters: tuple[str, str] = ("", "")
    elevation: float = 0.0
    azimuth: float = 0.0
    planar: bool = False

    @property
    def towards(self) -> Floats:
        """The direction (3,) from the linkage to the reader."""
        return np.asarray(cross(self.screen[0], self.screen[1]))

    def seen(self, places: Floats) -> Floats:
        """Places (..., 3) as they are seen (..., 2) [length]."""
        return (places - self.origin) @ self.screen.T


def view_of(asked: Asked, loop: Loop, places: Floats, axes: Any = None) -> Projection:
    """The requested view; without one of a planar loop in its plane, else one that shows places (n, 3) well.

    `axes` are those of the caller, if any: three-dimensional ones show no flat view, flat ones no other.
    Raises `RequestError` for a view that does not exist, and where the axes cannot show it.
    """
    solid = axes is not None and hasattr(axes, "get_zlim")
    flat = axes is not None and not solid
    if asked is None and axes is None:
        asked = asked_view()
    if asked is None:
        plane = None if solid else plane_of(loop)
        asked = "space" if plane is None else "plane"
        if flat and plane is None:
            raise RequestError(
                "ax: is flat, and the linkage moves in space; give axes made with projection='3d', "
                f"or view= one of {', '.join(ALONG)}"
            )
    made = _view(asked, loop, places)
    if axes is not None and made.flat == solid:
        what = "three-dimensional, and this view is flat" if solid else "flat, and this view is not"
        raise RequestError(
            f"ax: is {what}; give axes made with{'out' * solid} projection='3d', or another view"
        )
    return made


def check_view(asked: Asked, key: str = "view") -> str | tuple[float, float] | None:
    """A requested view, checked; raises `RequestError` for one that does not exist."""
    if asked is None or (isinstance(asked, str) and asked in NAMED):
        return asked
    if not isinstance(asked, str):
        try:
            elevation, azimuth = (float(angle) for angle in asked)
        except (TypeError, ValueError):
            elevation = math.nan
        if abs(elevation) <= 90 and math.isfinite(azimuth):
            return elevation, azimuth
    hint = suggestion(asked, NAMED) if isinstance(asked, str) else ""
    raise RequestError(
        f"{key}: {shown(asked)} is not a view; {hint}give one of {', '.join(NAMED)}, "
        "or elevation (-90 to 90) and azimuth [deg]"
    )


def _view(asked: Asked, loop: Loop, places: Floats) -> Projection:
    chosen = check_view(asked)
    if chosen == "plane":
        plane = plane_of(loop)
        if plane is None:
            raise RequestError(f"view: the linkage is not planar; give another one of {', '.join(NAMED[1:])}")
        screen = np.stack([plane.x, plane.y])
        named = _letter(plane.x), _letter(plane.y)
        known = all(named)
        letters = named if known else ("x in the plane", "y in the plane")
        origin = np.zeros(3) if known else plane.origin
        return Projection(screen, origin, flat=True, letters=letters, planar=True)
    if isinstance(chosen, str) and chosen in ALONG:
        right, up = ALONG[chosen]
        return Projection(np.eye(3)[[right, up]], np.zeros(3), flat=True, letters=(chosen[0], chosen[1]))
    angles = ISOMETRIC if chosen == "iso" else chosen
    elevation, azimuth = wide_view(places) if angles is None or isinstance(angles, str) else angles
    screen = directions(elevation, azimuth)
    return Projection(screen, np.zeros(3), flat=False, elevation=elevation, azimuth=azimuth)


def upright(loop: Loop) -> Floats | None:
    """The directions (2, 3) seen as right and up of a planar loop in its plane; `None` of any other.

    Gravity points down where it lies in the plane; otherwise the plane's own y points up.

        >>> import sevenbar as sb
        >>> upright(sb.load("planar_4r")).tolist(), upright(sb.load("rssr"))
        ([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], None)
    """
    plane = plane_of(loop)
    if plane is None:
        return None
    gravity = np.array(loop.loading.gravity)
    down = gravity - (gravity @ plane.normal) * plane.normal
    if not math.hypot(*down) > IN_PLANE * math.hypot(*gravity):
        return np.stack([plane.x, plane.y])
    up = -down / math.hypot(*down)
    return np.stack([cross(up, plane.normal), up]) + 0.0


def _letter(way: Floats) -> str:
    """The axis of the report frame that a direction is, if it is one."""
    for letter, own in zip("xyz", np.eye(3), strict=True):
        if np.abs(way - own).max() < 1e-9:
            return letter
    return ""


def wide_view(places: Floats) -> tuple[float, float]:
    """Elevation and azimuth [deg] from which places (n, 3) cover the most."""
    azimuths = (np.arange(-180.0, 180.0, 90.0)[:, None] + AZIMUTHS).ravel()
    elevation, azimuth = (grid.ravel() for grid in np.meshgrid(ELEVATIONS, azimuths))
    selected = places[~np.isnan(places).any(axis=1)]
    spread = (selected - selected.mean(axis=0)).T @ (selected - selected.mean(axis=0))
    screens = [directions(*view) for view in zip(elevation, azimuth, strict=True)]
    covered = np.array([np.sqrt(max(np.linalg.det(s @ spread @ s.T), 0.0)) for s in screens])
    # among like views the usual one, x to the right and y away
    unusual = (1 - np.cos(np.radians(azimuth + 60.0))) / 2 + np.abs(elevation - 30.0) / 100
    best = int(np.argmax(covered / (covered.max() or 1.0) - 0.3 * unusual))
    return float(elevation[best]), float(azimuth[best])


def directions(elevation: float, azimuth: float) -> Floats:
    """The directions, unit vectors (2, 3), seen as right and up from an elevation and an azimuth [deg]."""
    up, round_ = math.radians(elevation), math.radians(azimuth)
    above = [-math.sin(up) * math.cos(round_), -math.sin(up) * math.sin(round_), math.cos(up)]
    return np.array([[-math.sin(round_), math.cos(round_), 0.0], above])
