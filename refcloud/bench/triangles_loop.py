"""Loops in the triangle benchmark: one triangle at a time, and one pixel at a time.

Both are given the corners in the window, with 1 / depth and the attributes divided by
depth; triangles that are seen from behind or cut are left out before.
"""

from __future__ import annotations

import math

import numpy as np

from refcloud.bench import triangles_scene as scene
from refcloud.camera import project
from refcloud.conventions import Array
from refcloud.raster import sample

SIZE = scene.WIDTH, scene.HEIGHT


def in_window(name: str, count: int) -> tuple[Array, Array]:
    """Give corners in pixels, (T, 3, 2), and 1/z, s/z, t/z, (T, 3, 3)."""
    mesh, camera, cull = scene.scene(name, count)
    x, y, depth, _ = project(camera, mesh.points)
    place = np.round(256.0 * np.stack([x, y], axis=-1))[mesh.faces] / 256.0
    linear = np.concatenate([np.ones((len(depth), 1)), mesh.attributes], axis=1)
    seen = (depth[mesh.faces] > scene.DEPTHS["near"]).all(axis=1)
    a, b, c = place[:, 0], place[:, 1], place[:, 2]
    area = (b - a)[:, 0] * (c - a)[:, 1] - (c - a)[:, 0] * (b - a)[:, 1]
    seen &= area < 0.0 if cull == "BACK" else area != 0.0
    linear /= np.where(depth > 0.0, depth, 1.0)[:, None]
    return place[seen], linear[mesh.faces[seen]]


def loop_over_triangles(name: str, count: int) -> Array:
    """Draw one triangle after the other, each with numpy on its box of pixels."""
    texture = scene.textured("LINEAR").texture
    pixels = np.zeros((scene.HEIGHT, scene.WIDTH, 4))
    nearest = np.zeros((scene.HEIGHT, scene.WIDTH))  # 1 / depth
    for corners, numbers in zip(*in_window(name, count), strict=True):
        low = np.maximum(np.ceil(corners.min(axis=0) - 0.5), 0).astype(int)
        high = np.minimum(np.floor(corners.max(axis=0) + 0.5), SIZE)
        if (high <= low).any():
            continue
        box = slice(low[1], int(high[1])), slice(low[0], int(high[0]))
        x = np.arange(box[1].start, box[1].stop) + 0.5
        y = np.arange(box[0].start, box[0].stop)[:, None] + 0.5
        (ax, ay), (bx, by), (cx, cy) = corners
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
        v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
        w = 1.0 - u - v
        inside = (u >= 0.0) & (v >= 0.0) & (w >= 0.0)
        q, s, t = (
            u * numbers[0, k] + v * numbers[1, k] + w * numbers[2, k] for k in range(3)
        )
        shows = inside & (q > nearest[box])
        if shows.any():
            coords = np.stack([s[shows] / q[shows], t[shows] / q[shows]], axis=-1)
            pixels[box][shows] = sample(texture, coords)
            nearest[box][shows] = q[shows]
    return pixels


def scalar(name: str, count: int) -> Array:
    """Draw one pixel after the other in plain Python, on each triangle's box."""
    texels = scene.textured("LINEAR").texture.texels.tolist()
    pixels = [[[0.0] * 4 for _ in range(scene.WIDTH)] for _ in range(scene.HEIGHT)]
    nearest = [[0.0] * scene.WIDTH for _ in range(scene.HEIGHT)]
    lists = (numbers.tolist() for numbers in in_window(name, count))
    for corners, numbers in zip(*lists, strict=True):
        (ax, ay), (bx, by), (cx, cy) = corners
        (qa, sa, ta), (qb, sb, tb), (qc, sc, tc) = numbers
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        first = max(math.ceil(min(ax, bx, cx) - 0.5), 0)
        last = min(math.floor(max(ax, bx, cx) + 0.5), scene.WIDTH)
        for j in range(
            max(math.ceil(min(ay, by, cy) - 0.5), 0),
            min(math.floor(max(ay, by, cy) + 0.5), scene.HEIGHT),
        ):
            y = j + 0.5
            for i in range(first, last):
                x = i + 0.5
                u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
                v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                q = u * qa + v * qb + w * qc
                if q > nearest[j][i]:
                    nearest[j][i] = q
                    s = (u * sa + v * sb + w * sc) / q
                    t = (u * ta + v * tb + w * tc) / q
                    pixels[j][i] = bilinear(texels, s, t)
    return np.array(pixels)


def bilinear(texels: list, s: float, t: float) -> list[float]:
    """Mix four texels of a texture that repeats."""
    x, y = s * scene.SIDE - 0.5, t * scene.SIDE - 0.5
    i, j = math.floor(x), math.floor(y)
    fx, fy = x - i, y - j
    low, high = texels[j % scene.SIDE], texels[(j + 1) % scene.SIDE]
    i, k = i % scene.SIDE, (i + 1) % scene.SIDE
    a, b, c, d = low[i], low[k], high[i], high[k]
    return [
        (1.0 - fy) * ((1.0 - fx) * a[n] + fx * b[n])
        + fy * ((1.0 - fx) * c[n] + fx * d[n])
        for n in range(4)
    ]
