"""Figures of the errata in shape: kernels, ellipsoids, clusters, heights."""

from __future__ import annotations

from typing import Any

import numpy as np
from errata_sheet import Draw, Figure, frame, grey, name, pictures, plots

from refcloud import generate, noise
from refcloud.cloudmap import evaluate_quadric, modulate, quadric
from refcloud.drawing import BLACK, BLUE, GREEN, GREY, RED, curve, disc
from refcloud.metaballs import (
    adaptive_kmeans,
    approximate,
    chord,
    gaussian,
    gradient_descent,
    integral,
    largest_eigenvalue,
    lloyd,
    normalisation,
    printed_wyvill,
    profile,
    wyvill,
)
from refcloud.raster import framebuffer, splat


def e01() -> Figure:
    """Draw the kernel with either sign."""
    r = np.linspace(0.0, 1.2, 241)
    canvas, cells = plots(2)
    for cell, title, values, top, ink in (
        (cells[0], "as printed", printed_wyvill(r, 1.0), 5, RED),
        (cells[1], "-22/9", wyvill(r, 1.0), 1, BLUE),
    ):
        axes = frame(
            canvas, cell, (0, 1.2), (0, 1.05 * top), ((0, 0.5, 1), (0, 0.5 * top, top)),
            title, "r / R",
        )  # fmt: skip
        curve(axes, r, values, ink, 3.0)
    at = [0.0, 0.5, 1.0]
    printed, right = (
        ", ".join(f"{v:.3f}" for v in f(at, 1.0)) for f in (printed_wyvill, wyvill)
    )
    return Figure(
        f"f at 0, 1/2 and 1: {printed} as printed, {right} in refcloud.", canvas
    )


def e02() -> Figure:
    """Compare the printed k with every integral of the kernel."""
    k = normalisation("wyvill", "paper", R=1.0)
    parts = [integral("wyvill", n) for n in (1, 2, 3)]
    return Figure(
        f"With R = 1: k = {k:.4f}; the kernel's integral along a line through the"
        f" centre {parts[0]:.4f}, over a disc {parts[1]:.4f}, over the ball"
        f" {parts[2]:.4f}. With R = 2 the printed k is"
        f" {normalisation('wyvill', 'paper', R=2.0) / k:g} times as large, the ball's"
        f" integral {integral('wyvill', 3, R=2.0) / parts[2]:g} times."
    )


def e03() -> Figure:
    """Draw a ball of density 1 with k = 1 and with the printed k."""
    r = np.linspace(0.0, 1.1, 221)
    canvas, cells = plots(1)
    axes = frame(
        canvas, cells[0], (0, 1.1), (0, 1.05), ((0, 0.5, 1), (0, 0.5, 1)),
        "density of a ball with rho = 1", "r / R",
    )  # fmt: skip
    shares = []
    for R, ink, way in (
        (1.0, BLUE, "peak"),
        (1.0, RED, "paper"),
        (5.0, GREEN, "paper"),
    ):
        k = normalisation("wyvill", way, R=R)
        curve(axes, r, wyvill(r, 1.0) / k, ink, 3.0)
        shares.append(1.0 / k)
    name(axes, 0.35, 0.85, "k = 1", BLUE)
    name(axes, 0.04, 0.3, "printed k, R = 1", RED)
    return Figure(
        f"At the centre: {shares[0]:g} with k = 1; {shares[1]:.3f} with the printed k"
        f" and R = 1, {shares[2]:.3f} with R = 5 (green).",
        canvas,
    )


def e04() -> Figure:
    """Draw both footprints, and one ball with either half of each."""
    b = np.linspace(0.0, 1.0, 1001)
    flat, deep = profile(b**2), chord(b**2) / chord(0.0)
    canvas, cells = plots(2)
    axes = frame(
        canvas, cells[0], (0, 1), (0, 1), ((0, 0.5, 1), (0, 0.5, 1)),
        "profile (red), chord (blue)", "b / R",
    )  # fmt: skip
    curve(axes, b[::5], flat[::5], RED, 3.0)
    curve(axes, b[::5], deep[::5], BLUE, 3.0)
    gap = frame(
        canvas, cells[1], (0, 1), (0, 0.07), ((0, 0.5, 1), (0, 0.03, 0.06)),
        "their difference", "b / R",
    )  # fmt: skip
    curve(gap, b[::5], np.maximum(flat - deep, 0.0)[::5], BLACK, 3.0)
    worst = int(np.argmax(flat - deep))
    masses = []
    for way in ("profile", "chord"):
        buffer = framebuffer(101, 101)
        splat(buffer, 50.5, 50.5, 50, emission=[1, 1, 1], tau=0, name=way)
        masses.append(buffer.pixels[..., 0].sum())
    return Figure(
        f"They differ by up to {flat[worst] - deep[worst]:.4f}, at b = {b[worst]:.2f}"
        f" R; a splat of the profile is {100 * (masses[0] / masses[1] - 1):.1f} %"
        " brighter in all.",
        canvas,
    )


def e15() -> Figure:
    """Draw a slice of the printed form, and of the reading with noise."""
    x, y = np.linspace(-1.1, 1.1, 110), np.linspace(-0.75, 0.75, 75)
    at = np.stack(np.broadcast_arrays(x, y[:, None], 0.0), axis=-1)
    Q = evaluate_quadric(quadric([0, 0, 0], [1.0, 0.65, 0.65]), at)
    P = noise.octave_sum_grid(4 * x, 4 * y, [0.5], seed=2)[0][0]
    panels, shares = {}, []
    for title, values in (
        ("d Q, t = 0", modulate(Q, np.ones_like(Q), threshold=0.0)),
        ("d Q, t = 0.3", modulate(Q, np.ones_like(Q), threshold=0.3)),
        ("d Q P, t = 0.1", modulate(Q, P, threshold=0.1)),
    ):
        panels[title] = grey(values)
        shares.append(np.count_nonzero(values) / np.count_nonzero(Q > 0.0))
    canvas, _ = pictures(panels)
    return Figure(
        "Share of the ellipsoid that is cloud: "
        + ", ".join(f"{100 * s:.0f} %" for s in shares)
        + "; only the last has gaps inside.",
        canvas,
    )


def e16() -> Figure:
    """Count voxels and balls of a small cloud."""
    cloud = generate("ellipsoid", seed=2, voxel=4.0)
    voxels = np.count_nonzero(cloud.density)
    counts = [len(approximate(cloud, count=n, method="man")) for n in (1, 10, 30)]
    return Figure(
        f"A cloud of {voxels} voxels (eq 20's K) asked for 1, 10 and 30 balls (figure"
        f" 7's K, eq 11's N) has {counts[0]}, {counts[1]} and {counts[2]}."
    )


def e17() -> Figure:
    """Draw the Gaussian with and without the half, beside eq 12."""
    r = np.linspace(0.0, 1.0, 201)
    canvas, cells = plots(1)
    axes = frame(
        canvas, cells[0], (0, 1), (0, 1), ((0, 0.5, 1), (0, 0.5, 1)),
        "R = 2 sigma", "r / R",
    )  # fmt: skip
    one = np.ones(())
    curve(axes, r, gaussian(2.0 * r, one), BLUE, 3.0)
    curve(axes, r, np.exp(-0.5 * (2.0 * r) ** 2), RED, 3.0, dash=9.0)
    curve(axes, r, wyvill(r, 1.0), GREY, 3.0)
    name(axes, 0.62, 0.68, "with 1/2", RED)
    name(axes, 0.06, 0.45, "eq 15", BLUE)
    name(axes, 0.52, 0.12, "eq 12", GREY)
    off = [
        float(np.sqrt(np.mean((gaussian(u * r, one) - wyvill(r, 1.0)) ** 2)))
        for u in (1.75, 2.0)
    ]
    return Figure(
        f"At the cut the step is {float(gaussian(2.0, one)):.4f} without and"
        f" {np.exp(-2.0):.4f} with the half. RMS distance to eq 12: {off[0]:.3f} with"
        f" R = 1.75 sigma, {off[1]:.3f} with 2.",
        canvas,
    )


LATTICE = np.argwhere(np.ones((9, 9, 9))).astype(np.float64)


def e18() -> Figure:
    """Draw where 12 centres come to lie, in the grid's order and shuffled."""
    found: dict[str, Any] = {
        "raster order": adaptive_kmeans(LATTICE, 12, order="raster"),
        "shuffled": adaptive_kmeans(LATTICE, 12),
        "Lloyd": lloyd(LATTICE, np.ones(len(LATTICE)), 12),
    }
    canvas, cells = plots(3, 116)
    costs = []
    for cell, (title, clusters) in zip(cells, found.items(), strict=True):
        axes = frame(canvas, cell, (-0.5, 8.5), (-0.5, 8.5), ((), ()), title)
        for x, _, z in clusters.centers:
            disc(canvas, axes.place(z, x), 7.0, BLUE)
        away = LATTICE - clusters.centers[clusters.assignment]
        costs.append(float((away**2).sum()))
    return Figure(
        f"Centres in a cube of 9^3 voxels, seen from the side. Squared distances:"
        f" raster {costs[0] / costs[2]:.1f}, shuffled {costs[1] / costs[2]:.1f} times"
        " those of Lloyd's.",
        canvas,
    )


def e19() -> Figure:
    """Draw the error over the steps, below and above the limit."""
    places = np.linspace(0.0, 1.0, 9)
    design = wyvill(np.abs(places[:, None] - np.linspace(0.1, 0.9, 5)), 0.5)
    y = noise.uniform(5, np.arange(9), seed=0)
    limit = 1.0 / largest_eigenvalue(design.T @ design)
    best = design @ np.linalg.lstsq(design, y)[0]
    floor = float(np.sum((y - best) ** 2))
    steps = np.arange(0, 61)
    below = [
        float(np.sum((y - design @ v) ** 2))
        for v in (
            gradient_descent(design, y, rate=0.9 * limit, most_steps=int(n))
            for n in steps
        )
    ]
    v, above = np.zeros(5), []
    for _ in steps:
        above.append(float(np.sum((y - design @ v) ** 2)))
        v = v + 2.0 * 1.05 * limit * design.T @ (y - design @ v)
    canvas, cells = plots(1)
    axes = frame(
        canvas, cells[0], (0, 60), (-2, 6), ((0, 20, 40, 60), (-2, 0, 2, 4, 6)),
        "log10 of H", "steps",
    )  # fmt: skip
    curve(axes, steps, np.log10(below), BLUE, 3.0)
    curve(axes, steps, np.log10(above), RED, 3.0)
    curve(axes, [0, 60], np.log10([floor, floor]), BLACK, 1.0, dash=8.0)
    name(axes, 24, 3.6, "1.05 limit", RED)
    name(axes, 3, -1.5, "0.9 limit; dashed: least squares", BLUE)
    try:
        gradient_descent(design, y, rate=1.05 * limit)
        refusal = "none"
    except ValueError as error:
        refusal = str(error)
    return Figure(
        f"After 60 steps H is {below[-1]:.4f} below and {above[-1]:.2g} above the"
        f" limit; least squares have {floor:.4f}. In refcloud: `{refusal}`.",
        canvas,
    )


FIGURES: dict[str, Draw] = {
    "E01": e01, "E02": e02, "E03": e03, "E04": e04, "E15": e15, "E16": e16,
    "E17": e17, "E18": e18, "E19": e19,
}  # fmt: skip
