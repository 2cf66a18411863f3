# %% [markdown]
# # 02 · Noise from an integer hash
#
# *How can a function look random and still give the same value at the same place, for
# ever, on every machine?*
#
# Noise starts with a **hash**: it takes the integer coordinates of a lattice point and
# stirs their bits until nothing of the order is left. No table, no state, no clock.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, enlarged, grey

from refcloud import noise
from refcloud.conventions import Range

lesson = Lesson()


def picture(
    *,
    hash: Literal["man2003", "mixed"] = "man2003",
    x: Annotated[int, Range(-(2**40), 2**40)] = 0,
    zoom: Annotated[int, Range(1, 16)] = 4,
    seed: Annotated[int, Range(0, 99)] = 0,
) -> Sheet:
    """Show the hash of a square of lattice points as grey.

    Parameters
    ----------
    hash
        Paper M's hash, equation 2, or refcloud's own.
    x
        Column at the left edge.
    zoom
        Pixels along each side of a lattice point.
    seed
        Which pattern; paper M's hash has none.
    """
    width, height = (max(1, edge // zoom) for edge in lesson.size(480, 320))
    columns, rows = x + np.arange(width), np.arange(height)[:, None]
    plane = np.zeros((1, 1), np.int64)
    how = None if hash == "man2003" else seed
    values = noise.lattice_random(
        columns + 0 * rows, rows + 0 * columns, plane, seed=how
    )
    return enlarged(grey(values, -1.0, 1.0), zoom)


lesson.show(picture, "02-hash", "Paper M's hash of 120 x 80 lattice points")

# %% [markdown]
# ## One formula
#
# Equation 2 of paper M, with its printed slips mended (E05 to E08): a point becomes one
# integer, which is shifted, xor-ed with itself, and put through a cubic polynomial of
# 31 bits:
#
# $$ m = x + 57 y + 57^2 z, \quad n = (m \ll 13) \oplus m $$
#
# $$ g = 1 - \frac{(n (15731 n^2 + 789221) + 1376312589) \wedge
# \mathtt{7fffffff}}{2^{30}} $$
#
# The plain form is the formula, in Python's unlimited integers:

# %%
from refcloud.plain import noise as plain

lesson.source(plain.elias, plain.man2003)

# %% [markdown]
# The array form says the same of whole arrays, in 64-bit integers that wrap around; the
# lowest 31 bits do not mind. Floating point would: its 53 bits lose the low ones.

# %%
lesson.source(noise.man2003)

# %% [markdown]
# ## The knob: zoom
#
# There is nothing between the lattice points yet: enlarged, noise is squares. It is
# neither coherent nor continuous. Tutorial 03 fills in between.

# %%
lesson.strip(picture, "zoom", (1, 2, 4, 8, 16), "02-zoom", "The same hash, enlarged")

# %% [markdown]
# ## Where this breaks
#
# `m` folds three coordinates into one line with strides 1, 57 and 57². So the value at
# (x + 57, y) **is** the value at (x, y + 1): the pattern repeats, shifted, every 57
# columns (E09). Left, paper M's hash and its difference from itself moved by (57, -1):
# black, equal everywhere. Right, the same for refcloud's hash, which mixes each
# coordinate in a round of its own: no repetition.


# %%
def moved(hash: Literal["man2003", "mixed"]) -> Sheet:
    """Show how far a hash differs from itself, 57 columns on and one row up."""
    width, height = (edge // 2 for edge in lesson.size(480, 320))
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    seed = None if hash == "man2003" else 0
    here = noise.lattice_random(x, y + 1, np.zeros_like(x), seed=seed)
    there = noise.lattice_random(x + 57, y, np.zeros_like(x), seed=seed)
    return enlarged(grey(np.abs(here - there), 0.0, 2.0), 2)


lesson.row(
    {
        "man2003": lambda: picture(zoom=2),
        "moved by (57, -1)": lambda: moved("man2003"),
        "mixed": lambda: picture(hash="mixed", zoom=2),
        "mixed, moved": lambda: moved("mixed"),
    },
    "02-period",
    "Paper M's hash repeats itself after 57 columns; a hash of all bits does not",
    columns=4,
)

# %% [markdown]
# ## Exercises
#
# 1. What is g at the origin? Work it out on paper.
# 2. Equation 2 is printed with the divisor 1073741823 = 2³⁰ - 1. Which value leaves
#    [-1, 1] then?
# 3. Is the mean of many values 0, as it should be?
#
# ## Solutions

# %%
# 1: m = n = 0, so g = 1 - 1376312589 / 2^30 = -0.2818 (to four digits).
assert round(plain.man2003(0, 0, 0), 4) == -0.2818

# 2: the largest masked integer is 2^31 - 1; 1 - (2^31 - 1) / (2^30 - 1) is below -1.
assert 1 - (2**31 - 1) / (2**30 - 1) < -1 < 1 - (2**31 - 1) / 2**30

# 3: of N independent values the mean is off by about 1 / sqrt(3 N).
values = noise.lattice_random(np.arange(100_000), 0, 0, seed=1)
assert abs(values.mean()) < 5 / np.sqrt(3 * values.size)
