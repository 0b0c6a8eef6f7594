"""The atlas of a designer: a measure, or the motion type with exact boundaries, over two dimensions."""

from sevenbar.errors import MissingExtraError

try:
    import shapely  # noqa: F401
except ImportError:
    raise MissingExtraError("maps need shapely; install it with: pip install 'sevenbar[design]'") from None

from sevenbar.design.maps.atlas import Map, motion_map
from sevenbar.design.maps.heights import Heights, measure_heights

__all__ = ["Heights", "Map", "measure_heights", "motion_map"]
