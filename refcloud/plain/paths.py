"""Light found by random paths, one path at a time.

Each function is the twin of the one of the same name in `refcloud.transport`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.cloudmap import trilinear
from refcloud.plain.noise import uniform
from refcloud.plain.optics import phase
from refcloud.plain.scattering import Point

STEP, REAL, ALBEDO, COSINE, AZIMUTH, SUN_STEP = range(6)
Cloud = tuple[list[list[list[float]]], list[float], list[float]]
Matter = tuple[float, float, float, str]  # sigma_t, albedo, g, phase
Light = tuple[Point, float]  # toward the sun, irradiance


def trace_paths(
    cloud: Cloud,
    origin: Point,
    direction: Point,
    suns: Sequence[Light],
    matter: Matter,
    sky: float,
    ground: float,
    paths: Sequence[int],
    orders: int,
    seed: int,
) -> tuple[float, float]:
    """Average paths of these numbers: the mean, and its standard error."""
    values = [
        walk(cloud, origin, direction, suns, matter, sky, ground, n, orders, seed)
        for n in paths
    ]
    mean = sum(values) / len(values)
    variance = sum((v - mean) ** 2 for v in values) / len(values)
    return mean, math.sqrt(variance / (len(values) - 1))


def walk(
    cloud: Cloud,
    origin: Point,
    direction: Point,
    suns: Sequence[Light],
    matter: Matter,
    sky: float,
    ground: float,
    path: int,
    orders: int,
    seed: int,
) -> float:
    """Follow one path from the eye to its end; give the light that it finds."""
    sigma_t, albedo, g, name = matter
    densest = sigma_t * max(v for rows in cloud[0] for row in rows for v in row)
    p, w = entered(cloud, origin, direction), direction
    found, scattered, stop = 0.0, 0, 0
    if p is None or not densest > 0.0:
        return 0.0
    while scattered < orders:
        t = -math.log1p(-uniform(path, stop, STEP, seed=seed)) / densest
        p = [a + t * b for a, b in zip(p, w, strict=True)]
        if not inside(cloud, p):
            outside = sky if w[1] > 0.0 else ground
            return found + (outside if scattered else 0.0)
        rho = sigma_t * trilinear(*cloud, p)
        if uniform(path, stop, REAL, seed=seed) * densest < rho:
            if uniform(path, stop, ALBEDO, seed=seed) >= albedo:
                return found
            for s, (toward, irradiance) in enumerate(suns):
                cosine = sum(a * b for a, b in zip(w, toward, strict=True))
                cosine = max(min(cosine, 1.0), -1.0)
                T = sun_share(cloud, p, toward, sigma_t, densest, (path, stop, s), seed)
                found += irradiance * phase(name, g, cosine) * T
            w = turned(w, name, g, path, stop, seed)
            scattered += 1
        stop += 1
    return found


def sun_share(
    cloud: Cloud,
    p: Point,
    toward: Point,
    sigma_t: float,
    densest: float,
    words: tuple[int, int, int],
    seed: int,
) -> float:
    """Estimate the transmittance to a sun: the product of 1 - rho / densest."""
    path, stop, which = words
    T, turn = 1.0, 0
    while T > 0.0:
        u = uniform(path, stop, SUN_STEP, which, turn, seed=seed)
        t = -math.log1p(-u) / densest
        p = [a + t * b for a, b in zip(p, toward, strict=True)]
        if not inside(cloud, p):
            break
        T *= max(1.0 - sigma_t * trilinear(*cloud, p) / densest, 0.0)
        turn += 1
    return T


def turned(
    w: Point, name: str, g: float, path: int, stop: int, seed: int
) -> list[float]:
    """Draw a new direction from the phase function."""
    u = uniform(path, stop, COSINE, seed=seed)
    around = math.tau * uniform(path, stop, AZIMUTH, seed=seed)
    if name == "hg" and g != 0.0:
        ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
        cosine = (1.0 + g * g - ratio * ratio) / (2.0 * g)
    elif name == "rayleigh":
        q = 4.0 * u - 2.0
        root = math.cbrt(q + math.sqrt(q * q + 1.0))
        cosine = root - 1.0 / root
    else:
        cosine = 2.0 * u - 1.0
    cosine = max(min(cosine, 1.0), -1.0)
    sine = math.sqrt(1.0 - cosine * cosine)
    x, y, z = w
    sign = 1.0 if z >= 0.0 else -1.0
    a, b = -1.0 / (sign + z), -x * y / (sign + z)
    right = (1.0 + sign * x * x * a, sign * b, -sign * x)
    up = (b, sign + y * y * a, -y)
    c, s = sine * math.cos(around), sine * math.sin(around)
    new = [c * r + s * v + cosine * d for r, v, d in zip(right, up, w, strict=True)]
    length = math.sqrt(sum(v * v for v in new))
    return [v / length for v in new]


def inside(cloud: Cloud, p: Point) -> bool:
    """Tell whether a point lies in the box."""
    _, lower, upper = cloud
    return all(a <= v <= b for a, v, b in zip(lower, p, upper, strict=True))


def entered(cloud: Cloud, p: Point, w: Point) -> list[float] | None:
    """Move a ray's origin to the box, None where it does not meet it."""
    near, far = 0.0, math.inf
    for low, high, at, speed in zip(cloud[1], cloud[2], p, w, strict=True):
        if speed != 0.0:
            ends = sorted(((low - at) / speed, (high - at) / speed))
            near, far = max(near, ends[0]), min(far, ends[1])
        elif not low <= at <= high:
            return None
    return [a + near * b for a, b in zip(p, w, strict=True)] if near < far else None
