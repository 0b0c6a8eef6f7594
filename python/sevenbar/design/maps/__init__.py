"""The atlas of a designer: a measure, or the motion type with exact boundaries, over two dimensions."""

from sevenbar.errors import of_extra

with of_extra("design", "maps need shapely"):
    import shapely  # noqa: F401

from sevenbar.design.maps.atlas import Map, motion_map
from sevenbar.design.maps.heights import Heights, measure_heights

__all__ = ["Heights", "Map", "measure_heights", "motion_map"]
