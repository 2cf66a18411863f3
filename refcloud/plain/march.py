"""Ray marching, one ray at a time: paper D's loop, and the integral it stands for.

Each function is the twin of the one of the same name in `refcloud.march`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from refcloud.plain.camera import Point, along, between, cross, dot, unit
from refcloud.plain.cloudmap import Grid, cell_size, trilinear
from refcloud.plain.optics import phase

Colour = Sequence[float]  # red, green, blue
SLACK = 1e-9  # a last bit does not decide how often a piece of a round depth is cut


class Cloud(NamedTuple):
    """A cloud map: densities [z][y][x] in the box from lower to upper."""

    density: Grid
    lower: Point
    upper: Point

    def at(self, point: Point) -> float:
        """Sample the density at a point."""
        return trilinear(self.density, self.lower, self.upper, point)


class Sun(NamedTuple):
    """A sun: the unit vector toward it, and its irradiance."""

    direction: Point
    irradiance: Colour


class Medium(NamedTuple):
    """What a cloud is made of, by channel, fields as `refcloud.optics.Medium`."""

    sigma_t: Colour
    albedo: Colour
    g: float
    phase: str


class Mixing(NamedTuple):
    """Factors on optical depths, fields as `refcloud.march.Mixing` (E38)."""

    light_absorption_toward_sun: float = 1.0
    light_absorption_through_cloud: float = 1.0
    darkness_threshold: float = 0.0


PHYSICAL = Mixing()


def ray_box(
    origin: Point, direction: Point, lower: Point, upper: Point
) -> tuple[float, float]:
    """Find where a ray enters and leaves a box; 0, 0 where it misses."""
    t0, t1 = 0.0, math.inf
    for o, d, a, b in zip(origin, direction, lower, upper, strict=True):
        if d == 0.0:  # along the slab: in it everywhere or nowhere
            if not a <= o <= b:
                return 0.0, 0.0
            continue
        near, far = sorted(((a - o) / d, (b - o) / d))
        t0, t1 = max(t0, near), min(t1, far)
    return (t0, t1) if t0 < t1 else (0.0, 0.0)


def sources(sun: Sun, medium: Medium, direction: Point) -> list[float]:
    """Give the radiance that a sun adds per unit of optical depth."""
    p = phase(
        medium.phase, medium.g, max(min(dot(direction, sun.direction), 1.0), -1.0)
    )
    return [a * p * e for a, e in zip(medium.albedo, sun.irradiance, strict=True)]


def segment_share(tau: float, segment: str) -> float:
    """Give what a step adds: 1 - exp(-tau), or Euler's tau."""
    return -math.expm1(-tau) if segment == "beer" else tau


def reaching(tau: float, mixing: Mixing) -> float:
    """Give the share of a sun's light that arrives (E38)."""
    dark = mixing.darkness_threshold
    return dark + (1.0 - dark) * math.exp(-mixing.light_absorption_toward_sun * tau)


def sun_depth_by_steps(
    cloud: Cloud, point: Point, direction: Point, sample_rate: int
) -> float:
    """March to the sun and add up the density on the way."""
    _, end = ray_box(point, direction, cloud.lower, cloud.upper)
    dt = end / sample_rate
    middles = [(step + 0.5) * dt for step in range(sample_rate)]
    return sum(cloud.at(along(point, (t, direction))) * dt for t in middles)


def march_by_steps(
    cloud: Cloud,
    origin: Point,
    direction: Point,
    suns: Sequence[Sun],
    medium: Medium,
    *,
    sample_rate: int,
    sun_sample_rate: int,
    segment: str = "beer",
    mixing: Mixing = PHYSICAL,
) -> tuple[list[float], list[float]]:
    """March one ray in equal steps; radiance and transmittance by channel."""
    direction = unit(direction)
    k = mixing.light_absorption_through_cloud
    L, T = [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]
    t0, t1 = ray_box(origin, direction, cloud.lower, cloud.upper)
    dt = (t1 - t0) / sample_rate
    for step in range(sample_rate):
        point = along(origin, (t0 + (step + 0.5) * dt, direction))
        density = cloud.at(point)
        for sun in suns:
            column = sun_depth_by_steps(cloud, point, sun.direction, sun_sample_rate)
            light = sources(sun, medium, direction)
            for c, sigma_t in enumerate(medium.sigma_t):
                tau = sigma_t * density * dt
                thin = segment == "euler" or k == 0.0
                share = tau if thin else segment_share(k * tau, segment) / k
                L[c] += T[c] * light[c] * share * reaching(sigma_t * column, mixing)
        for c, sigma_t in enumerate(medium.sigma_t):
            T[c] *= math.exp(-k * sigma_t * density * dt)
    return L, T


def past_edges(
    cloud: Cloud, origin: Point, direction: Point, sun: Point
) -> list[float]:
    """List where a ray crosses planes that hold an edge of the box and the sun's way.

    There the light begins to enter through another face, and the depth has a kink.
    """
    found = []
    for axis in range(3):
        edge = (float(axis == 0), float(axis == 1), float(axis == 2))
        normal = cross(edge, sun)
        speed = dot(normal, direction)
        for corner in range(8 if speed != 0.0 else 0):
            low, high = cloud.lower, cloud.upper
            x, y, z = ((high if corner >> k & 1 else low)[k] for k in range(3))
            found.append(dot(normal, between(origin, (x, y, z))) / speed)
    return found


def reaches_faces(density: Grid) -> bool:
    """Tell whether there is density in an outermost voxel."""
    D, H, W = len(density), len(density[0]), len(density[0][0])
    return any(
        density[k][j][i] > 0.0
        for k in range(D)
        for j in range(H)
        for i in range(W)
        if k in (0, D - 1) or j in (0, H - 1) or i in (0, W - 1)
    )


def cuts(
    cloud: Cloud, origin: Point, direction: Point, suns: Sequence[Sun] = ()
) -> list[float]:
    """List where a ray enters, crosses planes through voxel centres, and leaves."""
    t0, t1 = ray_box(origin, direction, cloud.lower, cloud.upper)
    found = {t0, t1}
    size = cell_size(*cloud)
    counts = len(cloud.density[0][0]), len(cloud.density[0]), len(cloud.density)
    for axis in range(3):
        for i in range(counts[axis] if direction[axis] != 0.0 else 0):
            plane = cloud.lower[axis] + (i + 0.5) * size[axis]
            found.add((plane - origin[axis]) / direction[axis])
    for sun in suns if reaches_faces(cloud.density) else ():
        found.update(past_edges(cloud, origin, direction, sun.direction))
    return sorted(t for t in found if t0 <= t <= t1)


def following(ends: list[float]) -> list[tuple[float, float]]:
    """Pair each number with the next one."""
    return [(ends[k], ends[k + 1]) for k in range(len(ends) - 1)]


def stretch(cloud: Cloud, origin: Point, direction: Point, a: float, b: float) -> float:
    """Integrate the density from a to b within one piece: two Gauss points."""
    middle, half = 0.5 * (a + b), 0.5 * (b - a)
    offset = half / math.sqrt(3.0)
    ends = (middle - offset, middle + offset)
    return sum(cloud.at(along(origin, (t, direction))) for t in ends) * half


def column(cloud: Cloud, origin: Point, direction: Point) -> float:
    """Integrate the density from a point on, piece by piece."""
    t = cuts(cloud, origin, direction)
    return sum(stretch(cloud, origin, direction, a, b) for a, b in following(t))


def parts(
    cloud: Cloud, origin: Point, direction: Point, a: float, b: float, sigma_t: float
) -> list[float]:
    """Cut a piece where its optical depth passes equal shares of at most 1/2."""
    whole = stretch(cloud, origin, direction, a, b)
    count = max(math.ceil(sigma_t * whole / 0.5 - SLACK), 1)
    ends = [a]
    for k in range(1, count):
        low, high = a, b
        for _ in range(60):
            middle = 0.5 * (low + high)
            if stretch(cloud, origin, direction, a, middle) > k / count * whole:
                high = middle
            else:
                low = middle
        ends.append(high)
    return [*ends, b]


def gauss4() -> list[tuple[float, float]]:
    """Give the four Gauss-Legendre points on [0, 1] and their weights."""
    found = []
    for sign in (-1.0, 1.0):
        x = math.sqrt(3.0 / 7.0 + sign * 2.0 / 7.0 * math.sqrt(6.0 / 5.0))
        weight = (18.0 - sign * math.sqrt(30.0)) / 72.0
        found += [(0.5 - 0.5 * x, weight), (0.5 + 0.5 * x, weight)]
    return found


def lit_points(
    cloud: Cloud,
    origin: Point,
    direction: Point,
    a: float,
    b: float,
    sun: Sun,
    rates: Sequence[float],
) -> list[tuple[Point, float, float]]:
    """Place Gauss points on a piece, in more parts where a sun's depth changes much."""
    rule = gauss4()
    far = [
        column(cloud, along(origin, (a + x * (b - a), direction)), sun.direction)
        for x, _ in rule
    ]
    between_outermost = max(x for x, _ in rule) - min(x for x, _ in rule)
    count = 1
    for rate in rates:
        low, high = rate * min(far), rate * max(far)
        change = min(high - low, max(41.0 - low, 0.0))
        count = max(count, math.ceil(change / between_outermost - SLACK))
    found = []
    for part in range(count):
        for x, weight in rule:
            at = a + (part + x) / count * (b - a)
            point = along(origin, (at, direction))
            found.append((point, at, weight * (b - a) / count))
    return found


def integrate(
    cloud: Cloud,
    origin: Point,
    direction: Point,
    suns: Sequence[Sun],
    medium: Medium,
    *,
    background: Colour = (0.0, 0.0, 0.0),
    ambient: Colour = (0.0, 0.0, 0.0),
    mixing: Mixing = PHYSICAL,
) -> tuple[list[float], list[float]]:
    """Integrate one ray; radiance and transmittance by channel."""
    direction = unit(direction)
    k = mixing.light_absorption_through_cloud
    t = cuts(cloud, origin, direction, suns)
    L, passed = [0.0, 0.0, 0.0], 0.0
    for start, end in following(t):
        thickest = k * max(medium.sigma_t)
        ends = parts(cloud, origin, direction, start, end, thickest)
        for a, b in following(ends):
            for sun in suns:
                light = sources(sun, medium, direction)
                toward = mixing.light_absorption_toward_sun
                rates = [toward * sigma_t for sigma_t in medium.sigma_t]
                for p, x, weight in lit_points(
                    cloud, origin, direction, a, b, sun, rates
                ):
                    near = passed + stretch(cloud, origin, direction, a, x)
                    far = column(cloud, p, sun.direction)
                    for c, sigma_t in enumerate(medium.sigma_t):
                        seen = math.exp(-k * sigma_t * near)
                        lit = light[c] * reaching(sigma_t * far, mixing)
                        L[c] += sigma_t * cloud.at(p) * weight * seen * lit
            passed += stretch(cloud, origin, direction, a, b)
    T = [math.exp(-k * sigma_t * passed) for sigma_t in medium.sigma_t]
    for c in range(3):
        L[c] += medium.albedo[c] * ambient[c] * (1.0 - T[c]) + T[c] * background[c]
    return L, T
