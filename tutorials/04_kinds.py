# %% [markdown]
# # 04 · Gradient, simplex and Worley noise
#
# *Value noise looks like a quilt. Which noises do not?*
#
# Three answers. **Gradient** noise is 0 at every lattice point and gives each a slope
# instead. **Simplex** noise does the same on triangles and tetrahedra. **Worley** noise
# scatters one point into each cell and measures the distance to the nearest.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, grey

from refcloud import noise
from refcloud.conventions import Range
from refcloud.noise_pictures import noise_picture

lesson = Lesson()
Kind = Literal["value", "gradient", "simplex", "worley_f1", "worley_inverted"]


def picture(
    *,
    kind: Kind = "worley_inverted",
    cells: Annotated[int, Range(2, 64)] = 12,
    seed: Annotated[int, Range(0, 99)] = 0,
) -> Sheet:
    """Show a slice of a noise as grey, brought to [0, 1] by its true bound.

    Parameters
    ----------
    kind
        Which noise; "worley_inverted" is white at the points.
    cells
        Cells along the width.
    seed
        Which pattern.
    """
    width, height = lesson.size(480, 320)
    whole = noise_picture(kind, size=width, cells=cells, seed=seed)
    return Sheet(whole.codes(tone="none", dither=False)[:height])


lesson.show(picture, "04-worley", "Inverted Worley noise: heaps, as on a cumulus")

# %% [markdown]
# ## One formula
#
# Worley's F1 is nothing but the distance to the nearest of the scattered points:
#
# $$ F_1(p) = \min_i \, \lvert p - q_i \rvert $$
#
# One point per cell makes the search short: the nearest lies at most two cells away. In
# plain Python, cell by cell, with a sorted list:

# %%
from refcloud.plain import gradient as plain_gradient
from refcloud.plain import worley as plain

lesson.source(plain.worley)

# %% [markdown]
# Gradient noise, at its plainest: each corner of the cell says how high its own ramp is
# here, `dot`, and how much it counts, `weight`.

# %%
lesson.source(plain_gradient.gradient_derivative)

# %% [markdown]
# In arrays the loop over cells or corners stays, each for all points at once. Faster
# forms, held equal to these, share work between neighbours: `noise.worley`,
# `noise.gradient` and `noise.simplex` for points, `..._grid` for grids.

# %%
from refcloud.noise.gradient import _literal as gradient_literal
from refcloud.noise.worley import _literal as worley_literal

lesson.source(worley_literal, gradient_literal)
points = np.stack(np.meshgrid(np.arange(0, 4, 0.25), np.arange(0, 4, 0.25)), axis=-1)
assert abs(noise.worley(points)[3, 5] - plain.worley(points[3, 5])) < 1e-12

# %% [markdown]
# ## The knob: the kind

# %%
lesson.strip(
    picture,
    "kind",
    ("value", "gradient", "simplex", "worley_f1", "worley_inverted"),
    "04-strip",
    "Five kinds of noise of 12 cells",
)

# %% [markdown]
# ## Where this breaks
#
# Document D searches the own cell and its 8 neighbours. That is fast, and wrong in rare
# places: the nearest point may lie two cells away (E32). Here is one, 0.6 cells wide.
# The error is a patch with a hard edge, where the cell ends: a crease that no light
# smooths.

# %%
size = lesson.size(210, 210)[0]
near = np.linspace(-0.3, 0.3, size)
x, y, seed = 19.0 + near, 21.0 + near, 104
exact = noise.worley_grid(x, y, seed=seed)
quick = noise.worley_grid(x, y, seed=seed, search="neighbours")
lesson.row(
    {
        "exact": grey(exact, 1.2, 0.6),
        "own cell and neighbours": grey(quick, 1.2, 0.6),
        "difference x 5": grey(quick - exact, 0.0, 0.2),
    },
    "04-gap",
    "Where the search of 3 x 3 cells misses the nearest point",
    columns=3,
)

# %% [markdown]
# ## Exercises
#
# 1. What is gradient noise at a lattice point, and why does that make it a bad first
#    choice for slices at whole numbers?
# 2. Is simplex noise continuous? Compare the kernels r² = 0.5 and 0.6 (E30).
# 3. How far can the nearest point be in the plane, if each cell holds one?
#
# ## Solutions

# %%
# 1: zero: every corner's own ramp is 0 there, and the other corners do not count.
assert noise.gradient(np.zeros((1, 3)), seed=5) == 0.0

# 2: along a line the largest step between close neighbours tells. With 0.6 a corner's
# kernel is not yet 0 where the point enters the next triangle.
line = np.stack([np.linspace(0, 40, 400_001), np.full(400_001, 0.3)], axis=-1)
steps = {
    radius: np.abs(np.diff(noise.simplex(line, radius=radius))).max()
    for radius in ("continuous", "usual")
}
assert steps["continuous"] < 1e-3 < steps["usual"]

# 3: sqrt(2): all four points around a lattice point may sit in their far corners.
assert noise.worley_bound(2, "F1") == np.sqrt(2)
