# %% [markdown]
# # 01 · A cloud in ten lines
#
# *How does a picture of a cloud come out of nothing but numbers?*
#
# In three steps, each a function: noise fills a box with density (`generate`), a few
# hundred soft balls stand in for the voxels (`approximate`), and light goes through the
# balls to the eye (`render`). Run this file, look at the picture, change a number.

# %%
from typing import Annotated

from lesson import Lesson

import refcloud as rc
from refcloud.conventions import Range

lesson = Lesson()


def picture(
    *,
    seed: Annotated[int, Range(0, 99)] = 7,
    count: Annotated[int, Range(5, 1000, "balls")] = 300,
    relief: Annotated[float, Range(0.0, 12.0, "scene units")] = 6.0,
    height: Annotated[float, Range(-1.0, 1.0)] = 0.6,
) -> rc.Picture:
    """Draw a cumulus.

    Parameters
    ----------
    seed
        Which cloud.
    count
        How many balls stand in for it.
    relief
        How far noise moves its surface.
    height
        How high the sun stands: y of its direction.
    """
    cloud = rc.generate(seed=seed, voxel=2.0, relief=relief)
    balls = rc.approximate(cloud, count=count)
    width, tall = lesson.size(480, 360)
    camera = rc.Camera([3, -12, 112], [3, 15, 0], width=width, height=tall)
    sun = rc.Sun([-0.6, height, 0.4])
    return rc.render(
        balls, suns=sun, camera=camera, tolerance=lesson.tolerance(1 / 255)
    )


lesson.show(picture, "01-cloud", "300 balls, fitted to a cloud map of seed 7")

# %% [markdown]
# ## One formula
#
# Every picture of this course is a sum of light that is weakened on its way. Of light
# `L` that enters a medium of optical depth `tau`, the share that comes out is
#
# $$ T = e^{-\tau} $$
#
# The plain form, as you would write it first, and the array form that draws:

# %%
from refcloud import optics
from refcloud.plain import optics as plain

lesson.source(plain.beer_lambert, optics.beer_lambert)

# %% [markdown]
# Both are the same function for one number and for many. That is how refcloud is made:
# `refcloud/plain/` holds the definition, the other folders the arrays, and a test holds
# them equal. The course shows both, always from the library itself.
#
# ## The knob: how many balls
#
# Each step of the strip has about three times as many balls as the one before. The
# shape is there from the start; it is the edge that needs numbers.

# %%
lesson.strip(picture, "count", (10, 30, 100, 300, 1000), "01-count", "10 to 1000 balls")

# %% [markdown]
# What did the renderer leave out? A picture tells, row by row, with a bound on the
# error in units of displayed white:

# %%
lesson.told(picture(count=30).skipped)

# %% [markdown]
# ## Where this breaks
#
# * Below some 30 balls each ball is seen as a ball.
# * `--relief 12` moves the surface farther than the lumps are thick: pieces come loose,
#   and only the largest is kept.
# * `--height -1` lights the cloud from below. Nothing is wrong: light knows no up.
#
# ## Exercises
#
# 1. Draw the cloud with the sun behind it. Which vector is that?
# 2. Draw the same cloud twice and show that both pictures are equal to the last bit.
# 3. How does the error of the fit fall with the number of balls?
#
# ## Solutions
#
# 1. The camera looks along -z, so the sun stands at -z: `rc.Sun([0.1, 0.3, -1])`. The
#    rim shines and the middle is dark; tutorial 11 says why.

# %%
import numpy as np

# 2: chance is an integer hash of the seed, never a clock.
assert np.array_equal(picture(count=30).linear, picture(count=30).linear)

# 3: errors_of_fit gives the relative error over all voxels; it falls by half or so for
# ten times as many balls.
cloud = rc.generate(seed=7, voxel=2.0)
few, many = (rc.errors_of_fit(cloud, rc.approximate(cloud, count=n)) for n in (30, 300))
assert many.density < 0.7 * few.density
