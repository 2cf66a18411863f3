# %% [markdown]
# # 05 · Fractal sums
#
# *A cloud has lumps on its lumps on its lumps. How does noise get them?*
#
# By adding itself, each time twice as fine and half as strong.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, grey

from refcloud import noise
from refcloud.conventions import Range
from refcloud.noise_pictures import noise_picture

lesson = Lesson()


def picture(
    *,
    octaves: Annotated[int, Range(1, 8)] = 4,
    persistence: Annotated[float, Range(0.1, 1.0)] = 0.5,
    kind: Literal["man", "fbm", "turbulence"] = "man",
    cells: Annotated[int, Range(1, 32)] = 6,
    seed: Annotated[int, Range(0, 99)] = 1,
) -> Sheet:
    """Show a slice of a sum of octaves.

    Parameters
    ----------
    octaves
        How many are summed.
    persistence
        Amplitude of each octave against the one before.
    kind
        Paper M's |sum| of value noise, document S's sum of gradient noise, or its sum
        of absolute values.
    cells
        Cells of the first octave along the width.
    seed
        Which pattern.
    """
    width, height = lesson.size(480, 320)
    x, y = ((np.arange(n) + 0.5) * (cells / width) for n in (width, height))
    how = {"seed": seed, "octaves": octaves, "persistence": persistence}
    if kind == "man":
        return grey(noise.octave_sum_grid(x, y, [0.5], **how)[0][0], 0.0, 0.8)
    if kind == "turbulence":
        return grey(noise.turbulence_grid(x, y, [0.5], **how)[0][0], 0.0, 0.6)
    return grey(noise.fbm_grid(x, y, [0.5], **how)[0][0], -0.6, 0.6)


lesson.show(picture, "05-sum", "Paper M's sum of four octaves of value noise")

# %% [markdown]
# ## One formula
#
# Equation 1 of paper M, with `h` the noise of tutorial 03, `Z` octaves and persistence
# `s`:
#
# $$ \wp(p) = \Bigl\lvert \sum_{i=0}^{Z-1} s^i \, h(2^i p) \Bigr\rvert $$
#
# In plain Python (a seed gives every octave a pattern and an origin of its own; without
# it all lattices meet at the origin, and it shows):

# %%
from refcloud.plain import noise as plain

lesson.source(plain.octave_sum)

# %% [markdown]
# And in arrays: the same loop over octaves, each for all points at once.

# %%
lesson.source(noise.octave_sum)

# %% [markdown]
# Octave by octave: above each alone, below the sums so far.

# %%
edge = lesson.size(150, 150)[0]
sums = noise_picture("fbm", size=edge, octaves=4, view="octaves", cells=4, seed=2)
lesson.show(
    Sheet(sums.codes(tone="none", dither=False)),
    "05-octaves",
    "Four octaves of gradient noise, and their sums",
)

# %% [markdown]
# ## The knob: persistence

# %%
lesson.strip(
    picture,
    "persistence",
    (0.2, 0.35, 0.5, 0.7, 1.0),
    "05-strip",
    "From smooth to rough: each octave 0.2 to 1 times as strong as the one before",
)
lesson.strip(picture, "kind", ("man", "fbm", "turbulence"), "05-kinds", "Three sums")

# %% [markdown]
# ## Where this breaks
#
# * **The range.** Four octaves can sum to 1 + 1/2 + 1/4 + 1/8 = 1.875 (E11). Paper M
#   says nothing; `normalize=` cuts at 1 (`"clip"`), divides by the true bound
#   (`"bound"`), or leaves it (`"none"`).
# * **The pixel.** An octave finer than the samples is not detail but dirt: each sample
#   catches an accidental value. The grid forms leave such octaves out, and say so.

# %%
x = np.arange(0.0, 8.0, 0.25)  # four samples to a cell
_, skipped = noise.octave_sum_grid(x, x, [0.5], octaves=8, finest=0.25)
lesson.told(skipped)

# %% [markdown]
# * **The absolute value.** Outside the sum it makes creases where the sum is 0; inside
#   (`turbulence`) every octave makes its own.
#
# ## Exercises
#
# 1. What is the largest value of eight octaves at persistence 0.7?
# 2. Half the octaves are invisible at persistence 0.2. How much do the last four of
#    eight add at most?
# 3. What do three octaves without a seed have in common at the origin?
#
# ## Solutions

# %%
# 1: a geometric sum.
assert abs(noise.octave_bound(8, 0.7) - (1 - 0.7**8) / (1 - 0.7)) < 1e-12

# 2: 0.2^4 + ... + 0.2^7 = 0.002: half a code of 255.
assert 255 * (noise.octave_bound(8, 0.2) - noise.octave_bound(4, 0.2)) < 0.51

# 3: 2^i 0 = 0: the same lattice value, three times. So the sum there is 1.75 h(0).
one, three = (
    noise.octave_sum([[0.0, 0, 0]], seed=None, octaves=n, normalize="none")[0]
    for n in (1, 3)
)
assert abs(three - 1.75 * one) < 1e-12
