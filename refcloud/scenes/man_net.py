"""Figures 6 and 7 of paper M: the network of a real fit, and the centres of one.

Figure 6 shows every neuron of a net that was fitted to a small cloud, and what each of
them says about one voxel. Figure 7 shows the 1000 centres that phase 1 finds for the
cloud of figure 4.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from refcloud.camera import Camera, project
from refcloud.cloudmap import VoxelGrid, cell_size, generate
from refcloud.conventions import Array
from refcloud.drawing import (
    BLACK,
    BLUE,
    GREY,
    RED,
    WHITE,
    Canvas,
    arrow,
    blank,
    box,
    disc,
    polyline,
    ring,
    words,
)
from refcloud.figure import Figure, enter_figure
from refcloud.image import Picture
from refcloud.metaballs import (
    Metaballs,
    adaptive_kmeans,
    approximate,
    field,
    profile,
    voxel_balls,
)
from refcloud.render import framed
from refcloud.scene import View
from refcloud.scenes import man
from refcloud.scenes.demand_plane import flat_alone

NEURONS = 6
CENTRES = 1000
OVERLAP = man.OVERLAP
RULES = {"method": "man", "overlap": OVERLAP}
TURNED, LIFTED, CLOSER = 0.55, 0.32, 0.72  # of figure 7's eye: radians, shares


def small_cloud() -> VoxelGrid:
    """Generate a cloud that six balls describe."""
    return generate(diameters=np.array([20.0, 11.0, 11.0]), cell=5.0, relief=2.0)


def network(view: View) -> Picture:
    """Draw figure 6: three inputs, the hidden neurons, one output, their numbers."""
    flat_alone(view)
    canvas = blank(view.width, view.height)
    grid = small_cloud()
    net = approximate(grid, count=NEURONS, **RULES)
    point, true = asked_voxel(grid, net)
    away = np.sqrt(np.square(net.centers - point).sum(axis=1))
    says = profile(np.square(away / net.radii), net.kernel)
    middle = 0.5 * canvas.height
    rows = _spread(len(net), middle, canvas.height - 90.0)
    inputs = _spread(3, middle, 0.4 * canvas.height)
    inner, last = 250.0, 545.0
    heaviest = max(float(net.densities.max()), 1e-300)
    # 1. Connections: every input to every neuron; to the output as thick as its weight.
    for y in rows:
        for start in inputs:
            polyline(canvas, [(90.0, start), (inner - 16.0, y)], GREY, 0.8)
    for y, weight in zip(rows, net.densities, strict=True):
        wide = 0.6 + 4.0 * float(weight) / heaviest
        polyline(canvas, [(inner + 16.0, y), (last - 18.0, middle)], BLUE, wide)
    # 2. Inputs: the place of the voxel.
    for y, name, value in zip(inputs, "xyz", point, strict=True):
        box(canvas, (62.0, y - 14.0), (90.0, y + 14.0), fill=WHITE)
        words(canvas, (76.0, y), name, size=14, anchor="mm")
        words(canvas, (56.0, y), f"{value:.1f}", size=11, anchor="rm")
    # 3. Hidden neurons: the basis with its centre w, spread sigma, and what it says.
    for y, k in zip(rows, range(len(net)), strict=True):
        _neuron(canvas, (inner, y), float(says[k]), net)
        w = ", ".join(f"{v:.1f}" for v in net.centers[k].round(1) + 0.0)
        sigma = net.radii[k] / OVERLAP
        text = f"w {w}; sigma {sigma:.1f}"
        words(canvas, (inner, y - 24.0), text, size=10, anchor="mm", halo=WHITE)
        # Beside its connection, on the side that this one bends away from.
        at = y + 38.0 / (last - inner) * (middle - y)
        aside = -11.0 if y <= middle else 11.0
        text = f"v {net.densities[k]:.2f} times {says[k]:.2f}"
        words(canvas, (inner + 38.0, at + aside), text, size=10)
    # 4. The output: their sum, beside the density that the voxel has.
    disc(canvas, (last, middle), 18.0, WHITE)
    ring(canvas, (last, middle), 18.0)
    words(canvas, (last, middle), "sum", size=12, anchor="mm")
    arrow(canvas, (last + 18.0, middle), (last + 46.0, middle))
    total = float(field(net, point[None])[0])
    words(canvas, (last, middle + 34.0), f"net {total:.2f}", anchor="mm")
    words(canvas, (last, middle + 50.0), f"voxel {true:.2f}", anchor="mm")
    for k, line in enumerate(("asked at the voxel where", "the heaviest neuron sits")):
        place = last, middle + 76.0 + 14.0 * k
        words(canvas, place, line, size=10, anchor="mm")
    for x, name in ((76.0, "input"), (inner, "RBF neurons"), (last, "output")):
        words(canvas, (x, canvas.height - 14.0), name, size=13, anchor="mm")
    note = f"net of {len(net)} neurons at one voxel: {total:.3f}, the voxel {true:.3f}"
    where = "that voxel: where the heaviest neuron sits, so that it has much to say"
    return canvas.picture(note, where)


def asked_voxel(grid: VoxelGrid, net: Metaballs) -> tuple[Array, float]:
    """Give the voxel at the heaviest neuron: its place, shape (3,), and its density."""
    heaviest = net.centers[int(net.densities.argmax())]
    size = cell_size(grid)
    i, j, k = np.floor((heaviest - grid.lower) / size).astype(int)
    point = grid.lower + (np.array([i, j, k]) + 0.5) * size
    return np.asarray(point, np.float64), float(grid.density[k, j, i])


def _spread(count: int, middle: float, length: float) -> Array:
    step = length / max(count - 1, 1)
    away: Array = np.asarray(np.arange(count) - 0.5 * (count - 1), np.float64)
    return middle + step * away


def _neuron(
    canvas: Canvas, place: tuple[float, float], says: float, net: Metaballs
) -> None:
    """Draw a neuron: its basis as a small curve, and a dot where it is asked."""
    x, y = place
    disc(canvas, place, 16.0, WHITE)
    r = np.linspace(-1.0, 1.0, 41)
    heights = profile(np.square(r), net.kernel)
    line = np.stack([x + 11.0 * r, y + 8.0 - 14.0 * heights], axis=1)
    polyline(canvas, line, BLUE, 1.2)
    at = float(np.interp(says, heights[20:][::-1], r[20:][::-1]))
    disc(canvas, (x + 11.0 * at, y + 8.0 - 14.0 * says), 2.4, RED)
    ring(canvas, place, 16.0, BLACK)


def centres(view: View) -> Picture:
    """Draw figure 7: the voxels, and the centres that phase 1 moves among them.

    The eye stands aside, so that rows of voxels do not hide each other.
    """
    flat_alone(view)
    canvas = blank(view.width, view.height)
    balls = voxel_balls(man.cloud_map())
    found = adaptive_kmeans(balls.centers, CENTRES, seed=man.SEED)
    camera = aside(framed(balls, view.width, view.height))
    for points, radius, color, share in (
        (balls.centers, 1.8, GREY, 0.4),
        (found.centers, 3.4, BLUE, 1.0),
    ):
        x, y, depth, _ = project(camera, points)
        near = (depth.max() - depth) / max(float(np.ptp(depth)), 1e-300)
        # The farthest first; what is far is paler.
        for k in np.argsort(-depth, kind="stable"):
            place = x[k] / canvas.scale, y[k] / canvas.scale
            strength = share * (0.35 + 0.65 * float(near[k]))
            disc(canvas, place, radius, color, share=strength)
    text = f"{len(balls)} voxels, {len(found.centers)} centres"
    words(canvas, (320.0, canvas.height - 16.0), text, anchor="mm")
    return canvas.picture(f"{text} after {found.epochs} epochs")


def aside(camera: Camera) -> Camera:
    """Turn an eye about its target, to the right and up, and fill the paper."""
    way = camera.eye - camera.target
    c, s = math.cos(TURNED), math.sin(TURNED)
    turned = np.array([c * way[0] + s * way[2], way[1], c * way[2] - s * way[0]])
    turned[1] += LIFTED * float(np.hypot(*way[[0, 2]]))
    return replace(camera, eye=camera.target + turned, fov_y=CLOSER * camera.fov_y)


for name, number, title, draw in (
    ("man-06", "figure 6", "the RBF network, its neurons and weights", network),
    ("man-07", "figure 7", "K-means with 1000 centres", centres),
):
    enter_figure(Figure(name, number, title, draw))
