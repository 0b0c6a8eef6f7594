"""Draws exported GLB files side by side into a PNG: python examples/draw_glb.py out.png one.glb two.glb ..

The files are read back with trimesh and drawn with a depth buffer, so the picture shows what stands in them.
"""

import sys

import numpy as np
import trimesh
from matplotlib.image import imsave

#: Pixels of one picture's side, and samples per pixel along it.
SIDE, FINER = 640, 3
#: From where it is seen (glTF has y up), and where the light comes from.
EYE, LIGHT = np.array([0.62, 0.5, 1.0]), np.array([0.2, 1.0, 0.7])


def triangles(path):
    """All triangles (n, 3, 3) of a GLB file, and their colours (n, 3) from 0 to 1."""
    scene = trimesh.load(path)
    corners, colours = [], []
    for node in scene.graph.nodes_geometry:
        frame, name = scene.graph[node]
        mesh = scene.geometry[name]
        placed = trimesh.transform_points(mesh.vertices, frame)[mesh.faces]
        corners.append(placed)
        colour = np.asarray(mesh.visual.material.baseColorFactor[:3]) / 255
        colours.append(np.tile(colour, (len(placed), 1)))
    return np.concatenate(corners), np.concatenate(colours)


def picture(path):
    """A file as pixels (SIDE, SIDE, 3), seen from far away."""
    corners, colours = triangles(path)
    back = EYE / np.linalg.norm(EYE)
    right = np.cross([0, 1, 0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    light = 0.45 + 0.55 * np.clip(normals @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    shades = np.clip(colours * light[:, None], 0, 1)
    seen = corners @ np.stack([right, up, back], axis=1)
    low, high = seen.reshape(-1, 3).min(axis=0), seen.reshape(-1, 3).max(axis=0)
    count = SIDE * FINER
    scale = 0.9 * count / (high - low)[:2].max()
    flat = (seen[..., :2] - (low + high)[:2] / 2) * scale + count / 2
    pixels, depths = np.ones((count, count, 3)), np.full((count, count), -np.inf)
    for place, depth, shade in zip(
        flat[normals @ back > 0], seen[normals @ back > 0, :, 2], shades[normals @ back > 0], strict=True
    ):
        first, last = np.floor(place.min(axis=0)).astype(int), np.ceil(place.max(axis=0)).astype(int)
        x, y = np.meshgrid(np.arange(first[0], last[0] + 1), np.arange(first[1], last[1] + 1))
        (a, b), (c, d) = place[1] - place[0], place[2] - place[0]
        area = a * d - b * c
        if abs(area) < 1e-12:
            continue
        u = ((x - place[0, 0]) * d - (y - place[0, 1]) * c) / area
        v = ((y - place[0, 1]) * a - (x - place[0, 0]) * b) / area
        z = depth[0] + u * (depth[1] - depth[0]) + v * (depth[2] - depth[0])
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (z > depths[y, x])
        depths[y[hit], x[hit]] = z[hit]
        pixels[y[hit], x[hit]] = shade
    fine = pixels[::-1].reshape(SIDE, FINER, SIDE, FINER, 3)
    return fine.mean(axis=(1, 3))


if __name__ == "__main__":
    target, *sources = sys.argv[1:]
    imsave(target, np.concatenate([picture(source) for source in sources], axis=1))
