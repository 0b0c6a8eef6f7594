"""Lines through the rows of a path, without visible corners where rows are far apart, as at a dead centre.

Between two rows the line is a cubic. Its tangent at a row is that of the parabola through the row and its
neighbours, by the length of their chords. All rows stay where they are.
"""

from __future__ import annotations

import numpy as np

from sevenbar.arrays import Floats

#: Angle [rad] between neighbouring pieces of a line that no eye sees.
UNSEEN = 0.03
#: A greater angle [rad] is a corner of the path, or of rows too few to know better: it stays.
CORNER = 0.6


def smooth_line(places: Floats) -> Floats:
    """Places (m, d) of a line through places (n, d), with more of them where it bends; NaN rows stay gaps."""
    known = np.isfinite(places).all(axis=1)
    ends = np.flatnonzero(np.diff(known.astype(int))) + 1
    pieces = np.split(places, ends)
    return np.concatenate([_smooth(piece) if np.isfinite(piece).all() else piece for piece in pieces])


def _smooth(places: Floats) -> Floats:
    """The same for places without gaps."""
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    # a walk has the row of a dead centre twice
    places = places[np.concatenate([[True], steps > 1e-9 * steps.max(initial=0.0)])]
    if len(places) < 3:
        return places
    along = np.linalg.norm(np.diff(places, axis=0), axis=1)
    slopes = np.diff(places, axis=0) / along[:, None]
    bends = np.zeros(len(places))
    cosines = np.sum(slopes[1:] * slopes[:-1], axis=1)
    bends[1:-1] = np.arccos(np.clip(cosines, -1, 1))
    # the parabola through three places, at the middle one and at the ends of the line
    before, after = along[:-1, None], along[1:, None]
    middle = (slopes[:-1] * after + slopes[1:] * before) / (before + after)
    tangents = np.concatenate([[2 * slopes[0] - middle[0]], middle, [2 * slopes[-1] - middle[-1]]])
    line = [places[:1]]
    for k, length in enumerate(along):
        bend = bends[k : k + 2]
        count = 1 if bend.max() > CORNER else max(1, int(np.ceil(bend.max() / UNSEEN)))
        s = (np.arange(1, count + 1) / count)[:, None]
        start, end = tangents[k] * length, tangents[k + 1] * length
        step = places[k + 1] - places[k]
        # Hermite's cubic, less the straight line
        bow = s * (1 - s) * ((1 - s) * (start - step) - s * (end - step))
        line.append(places[k] + s * step + bow)
    return np.concatenate(line)
