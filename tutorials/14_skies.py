# %% [markdown]
# # 14 · Skies, sheets, sprites
#
# *Most clouds in a picture are far away. Must each of them be a volume?*
#
# No. A layer of clouds far overhead is flat enough to be a **texture**: one number for
# each direction, turned into light and opacity. Documents S and C paint skies with it;
# small clouds become **sprites**, pictures that always face the eye.

# %%
from dataclasses import replace
from functools import partial
from typing import Annotated

import numpy as np
from lesson import Lesson

import refcloud as rc
from refcloud import noise, sky
from refcloud.conventions import Range
from refcloud.scenes import Model, View, shader

lesson = Lesson()


def picture(
    *,
    threshold: Annotated[float, Range(-0.5, 0.5, "noise")] = 0.0,
    opacity_slope: Annotated[float, Range(0.0, 20.0, "1 / noise")] = 6.0,
    light_slope: Annotated[float, Range(-4.0, 4.0, "radiance / noise")] = -1.1,
) -> rc.Picture:
    """Look up to a plane of clouds, a sum of simplex noise at every pixel.

    Parameters
    ----------
    threshold
        Noise below it is open sky.
    opacity_slope
        How fast clouds become solid above it.
    light_slope
        How their light changes with the noise; negative is darker in the middle.
    """
    width, height = lesson.size(480, 320)
    cover = sky.Cover(threshold, opacity_slope, 1.05, light_slope, 0.35)
    plane = replace(shader.PLANE, cover=cover)
    return shader.plane_sky(Model({}), View(width, height), of=plane)


lesson.show(picture, "14-plane", "Document S: a plane of clouds, six octaves of noise")

# %% [markdown]
# ## One formula
#
# Opacity and light are straight lines in the noise `n`, and their slopes have
# **opposite signs**: a cloud is light at its edge, where it is thin, and darker in its
# middle.
#
# $$ \alpha = \operatorname{clip}\bigl(s_\alpha (n - t), 0, 1\bigr), \qquad
# L = \max\bigl(L_0 + s_L (n - t), L_\mathrm{least}\bigr) $$

# %%
from refcloud.plain import sheet as plain_sheet
from refcloud.plain import skies as plain

lesson.source(plain.cloud_cover, sky.cloud_cover)

# %% [markdown]
# ## The knob: the threshold
#
# It sets how much of the sky is open; the slope of the light makes the mood.

# %%
covers, slopes = (-0.5, -0.25, -0.1, 0.0, 0.2), (2.0, 0.0, -1.1, -2.5)
lesson.strip(picture, "threshold", covers, "14-strip", "Nearly overcast to few clouds")
lesson.strip(picture, "light_slope", slopes, "14-light", "Slopes of the light")

# %% [markdown]
# ## Which surface?
#
# From the left: a plane, a sphere whose noise is a function of space, a half-sphere
# with a texture, and a sphere with a texture wrapped around it. The last one **pinches
# at its pole**, so document S gave it up. The labels are names of scenes:
# `refcloud render shader-dome -o dome.png` draws one.


# %%
def scene(name: str) -> rc.Picture:
    """Draw a named scene at the size of a panel."""
    width, height = lesson.size(480, 320)
    return rc.render(name, width=width, height=height)


surfaces = ("shader-c", "shader-b", "shader-dome", "shader-poles")
lesson.strip(
    scene, "name", surfaces, "14-surfaces", "Four surfaces; the last pinches at a pole"
)

# %% [markdown]
# Document C gets a tiling sheet out of 32 x 32 random numbers, in five steps. The last
# is its **exponential filter**, which leaves only the peaks and rounds them:

# %%
lesson.source(plain_sheet.exponential_filter, noise.exponential_filter)
steps = ("noise", "smoothed", "interpolated", "octaves", "filtered")
lesson.row(
    {step: partial(scene, f"simple-{step}") for step in steps},
    "14-sheet",
    "Document C, step by step: from random numbers to a sheet of clouds",
)
others = ("shader-d", "shader-e", "shader-particles", "shader-lit")
lesson.strip(
    scene,
    "name",
    others,
    "14-sprites",
    "Document S's other tries: a puff, a soap bubble, particles, a lit layer",
)

# %% [markdown]
# ## Where this breaks
#
# * Fly through it: a sheet has no inside. No light goes from one cloud to another.
# * "Transparency" in document S must mean opacity; as printed, clouds are clear where
#   they should be solid (E37). Its fog subtracts the distance in the exponent, so that
#   it would clear far away; multiplied by the distance, it thickens (E29).
# * Sprites and particles are cheap one by one. A field of them is thousands of blends,
#   most of them over each other: document S found that slow.
#
# ## Exercises
#
# 1. Which noise value is just opaque, with threshold 0.1 and slope 4?
# 2. Why does document C's sheet tile without a seam?
# 3. Which share of the sky is open at threshold 0? Count pixels of the noise.
#
# ## Solutions
#
# 2. The map of 32 x 32 is wrapped by a border of one cell before it is smoothed, and
#    every octave reads it modulo 32.

# %%
# 1: 0.1 + 1/4.
_, alpha = sky.cloud_cover([0.34, 0.35], sky.Cover(threshold=0.1, opacity_slope=4.0))
assert alpha[0] < 0.97
assert alpha[1] > 1.0 - 1e-12

# 3: about half: the noise is as often below 0 as above.
x = np.arange(0.0, 32.0, 0.25)
values = noise.fbm_grid(x, x, kind="simplex", seed=3)[0]
assert 0.4 < np.mean(values < 0.0) < 0.6
