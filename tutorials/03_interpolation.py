# %% [markdown]
# # 03 · Interpolation, smoothing, and why smooth is not accurate
#
# *A hash gives values at lattice points only. What lies between them, and which way of
# filling in is the best?*

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, grey

from refcloud import noise
from refcloud.conventions import Range

lesson = Lesson()
Way = Literal["linear", "cosine", "cubic", "hermite", "quintic", "catmull_rom"]


def picture(
    *,
    interpolant: Way = "cosine",
    smooth: bool = False,
    cells: Annotated[int, Range(2, 64)] = 12,
    seed: Annotated[int, Range(0, 99)] = 3,
) -> Sheet:
    """Show a slice of value noise as grey.

    Parameters
    ----------
    interpolant
        How the noise goes from lattice point to lattice point.
    smooth
        Whether lattice values are averaged over 27 neighbours first (equation 3).
    cells
        Cells along the width.
    seed
        Which pattern.
    """
    width, height = lesson.size(480, 320)
    x, y = (np.arange(n) * (cells / width) for n in (width, height))
    values = noise.value_grid(
        x, y, [0.0], seed=seed, interpolant=interpolant, smooth=smooth
    )
    return grey(values[0], -1.0, 1.0)


lesson.show(picture, "03-value", "Value noise of 12 cells, interpolated by cosines")

# %% [markdown]
# ## One formula
#
# Between two values, `t` from 0 to 1, equation 5 of paper M walks half a wave:
#
# $$ a \left(1 - \tfrac F 2\right) + b \, \tfrac F 2, \qquad F = 1 - \cos \pi t $$
#
# In space the eight corners of a cell are joined along x, then y, then z (equation 7).
# The plain form of both:

# %%
from refcloud.plain import noise as plain

lesson.source(plain.cosine, plain.value)

# %% [markdown]
# The array form turns the loops round: for each of the eight corners, one look-up and
# one weight for **all** points at once.

# %%
from refcloud.noise.value import _literal

lesson.source(_literal)

# %% [markdown]
# ## The knob: the interpolant
#
# Linear shows the cells' edges, because its slope jumps there. Cosine and quintic are
# flat at every lattice point, which is why the cells show as a soft quilt.

# %%
ways: tuple[Way, ...] = ("linear", "cosine", "cubic", "quintic", "catmull_rom")
lesson.strip(
    picture, "interpolant", ways, "03-strip", "Five interpolants of the same values"
)
lesson.row(
    {"not smoothed": picture, "smoothed": lambda: picture(smooth=True)},
    "03-smooth",
    "Equation 3 averages 27 neighbours: the contrast falls, and so does the detail",
    columns=2,
)

# %% [markdown]
# ## Where this breaks: smooth is not accurate
#
# Paper M lists its interpolants "from the fastest one to the best one". Best at what?
# Take a function that is known between the lattice points too, a sine, and halve the
# spacing again and again. The slope of the error is the **order**: linear 2, cosine and
# quintic 1, Catmull-Rom 3. A cosine's step is smooth, but flat at both ends, where the
# sine is not, and no spacing mends that (E13).


# %%
def worst(interpolant: Way, spacing: float) -> float:
    """Give the largest error of a sine that is known at multiples of the spacing."""
    t = np.linspace(0.0, 1.0, 33)[:-1]
    weights, offsets = noise.taps(interpolant, t)  # (K, 32), (K,)
    cell = np.arange(0.0, 6.0, spacing)[:, None]  # (C, 1)
    guessed = np.sin(cell + spacing * offsets) @ weights  # (C, 32)
    return float(np.abs(guessed - np.sin(cell + spacing * t)).max())


spacings = 2.0 ** -np.arange(8, 0, -1.0)
errors = {way: np.array([worst(way, h) for h in spacings]) for way in ways}
lesson.plot(
    spacings,
    errors,
    "03-order",
    "The error of five interpolants of a sine: the smooth ones are the worst",
    y_range=(1e-9, 1.0),
    names=("spacing", "largest error"),
    log=(True, True),
)

# %% [markdown]
# For noise this does not matter: between random values nothing is known that could be
# missed. It matters when a grid holds samples of something, as voxels do.
#
# ## Exercises
#
# 1. How large can equation 6, the paper's cubic, get between values in [-1, 1]?
# 2. Read the order of each interpolant off the figure, with a ruler or with numpy.
# 3. How much contrast does smoothing take from the values at lattice points?
#
# ## Solutions

# %%
# 1: half way between 1 and 1, with -1 outside, it is 1.5; in space 1.5^3 = 3.375 (E12).
assert plain.cubic(-1, 1, 1, -1, 0.5) == 1.5

# 2: the error falls by 2^order for half the spacing.
orders = {way: round(float(np.log2(e[2] / e[1]))) for way, e in errors.items()}
assert orders == {"linear": 2, "cosine": 1, "quintic": 1, "cubic": 1, "catmull_rom": 3}

# 3: the standard deviation falls to sqrt(sum of squared weights) = 0.51: half is lost.
squares = (9 / 18) ** 2 + 6 * (4 / 108) ** 2 + 12 * (3 / 216) ** 2 + 8 * (2 / 144) ** 2
x = np.arange(40)
raw, soft = (noise.value_grid(x, x, x, smooth=s) for s in (False, True))
assert abs(soft.std() / raw.std() - np.sqrt(squares)) < 0.02
