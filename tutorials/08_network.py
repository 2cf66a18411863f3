# %% [markdown]
# # 08 · The RBF network in three phases
#
# *Which 100 balls look most like a given cloud of 11,000 voxels?*
#
# Paper M asks a neural network with one hidden layer: three inputs (x, y, z), a neuron
# for each ball, one output (the density). It learns in three phases: where, how large,
# how dense.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, grey

import refcloud as rc
from refcloud.conventions import Range

lesson = Lesson()
VOXEL = 2.0 if lesson.quick else 1.0  # edge, scene units
CLOUD = rc.generate("ellipsoid", seed=2, voxel=VOXEL)
Phase = Literal["where", "how large", "how dense"]


def seen_through(balls: rc.Metaballs, thickest: float = 12.0) -> Sheet:
    """Sum the balls along lines of sight: density R chord(q), a disc for each ball."""
    width, height = lesson.size(480, 270)
    x, y = np.linspace(-32, 32, width), np.linspace(18, -18, height)[:, None]
    column = np.zeros((height, width))
    for (cx, cy, _), radius, density in zip(
        balls.centers, balls.radii, balls.densities, strict=True
    ):
        q = ((x - cx) ** 2 + (y - cy) ** 2) / radius**2
        column += density * radius * rc.metaballs.chord(np.minimum(q, 1.0))
    return grey(np.sqrt(column / thickest))


def picture(
    *,
    count: Annotated[int, Range(3, 1000, "balls")] = 100,
    phase: Phase = "how dense",
    overlap: Annotated[float, Range(0.5, 4.0)] = 2.0,
    seed: Annotated[int, Range(0, 99)] = 0,
) -> Sheet:
    """Show the balls' density, summed along the line of sight, after a phase.

    Parameters
    ----------
    count
        How many balls, or neurons.
    phase
        After which phase: centres alone have one voxel's radius, radii density 1.
    overlap
        u: how many times the cluster's spread a radius is.
    seed
        Chooses the first patterns.
    """
    balls = rc.approximate(CLOUD, count=count, method="man", overlap=overlap, seed=seed)
    radii, densities = balls.radii, balls.densities
    if phase == "where":
        radii = np.full_like(radii, 1.5 * VOXEL)
    if phase != "how dense":
        densities = np.full_like(densities, float(CLOUD.density.max()))
    return seen_through(rc.Metaballs(balls.centers, radii, densities))


lesson.show(picture, "08-balls", "100 balls after the third phase, seen through")

# %% [markdown]
# ## One formula
#
# The network is a sum (equation 14), and its error is what every phase wants small
# (equation 20), with `y` the density of voxel `j` and `psi` a ball's kernel there:
#
# $$ g(x) = \sum_k v_k \, \psi_k(x), \qquad H = \sum_j \bigl(y_j - g(x_j)\bigr)^2 $$
#
# **Phase 1, where.** A voxel is shown; the nearest centre steps toward it, by less each
# time (equations 21 and 22; counts start at 1, E18):

# %%
from refcloud.plain import metaballs as plain

lesson.source(plain.adaptive_kmeans)

# %% [markdown]
# **Phase 2, how large.** The radius is `u` times the root mean square distance of the
# cluster's voxels (equation 23). **Phase 3, how dense.** The heights go downhill on H
# (equation 24), or to the bottom at once by least squares: H is a bowl.

# %%
lesson.source(plain.rms_radii, plain.gradient_descent, rc.metaballs.gradient_descent)
lesson.row(
    {
        "the map": lambda: seen_through(rc.voxel_balls(CLOUD)),
        "1 where": lambda: picture(phase="where"),
        "2 how large": lambda: picture(phase="how large"),
        "3 how dense": picture,
    },
    "08-phases",
    "The map, and 100 balls after each phase",
    columns=4,
)

# %% [markdown]
# ## The knob: how many

# %%
lesson.strip(picture, "count", (10, 30, 100, 300, 1000), "08-strip", "10 to 1000 balls")

# %% [markdown]
# ## Where this breaks
#
# * Paper M never ran phase 3: its figures 8 to 10 are the second panel from the right.
# * The step of equation 24 has a limit: beyond 1 over the largest eigenvalue of the
#   kernels' products the heights swing and grow without end (E19).
# * Which voxel is shown first decides which clusters arise. Another `seed`, another
#   fit.
#
# Better fits are one word away. The error of each over all voxels falls from line to
# line, while a ball has many voxels to stand for: at four each, `man` beats `quick`.

# %%
errors = []
for method in ("man", "quick", "standard", "full"):
    balls = rc.approximate(CLOUD, count=100, method=method)
    errors.append(rc.errors_of_fit(CLOUD, balls).density)
    print(f"{method:8} {errors[-1]:.3f}")
assert errors == sorted(errors, reverse=True)

# %% [markdown]
# ## Exercises
#
# 1. Why is no centre outside the cloud after phase 1?
# 2. Fit one ball to one voxel. Which radius and density come out?
# 3. Try `--overlap 0.5` and `--overlap 4`. What goes wrong at each end?
#
# ## Solutions
#
# 1. A centre starts on a voxel and only moves toward voxels: it stays inside their
#    convex hull (which can be outside a cloud with a hollow).
# 3. At 0.5 the balls do not touch: beads. At 4 they all overlap: fog, and the heights
#    of phase 3 must cancel each other, which densities from 0 cannot.

# %%
# 2: the spread of one voxel is its floor, half its edge (E18); the height is its own.
one = rc.VoxelGrid(np.full((1, 1, 1), 0.7), [0, 0, 0], [1, 1, 1])
ball = rc.approximate(one, count=1, method="man", overlap=2.0)
assert ball.radii[0] == 1.0
assert abs(ball.densities[0] - 0.7) < 1e-9
