# %% [markdown]
# # 15 · How wrong, how long
#
# *You may be wrong by so much. How much work does that save, and how do you know that
# you are not wrong by more?*
#
# Every stage of refcloud takes `tolerance=`: the largest error of any channel, in units
# of displayed white. 0 leaves out nothing that could show. A larger one lets a stage
# skip work that it can bound or check.

# %%
from typing import Annotated

import numpy as np
from lesson import Lesson
from sheets import Sheet, grey

import refcloud as rc
from refcloud.bench import stability
from refcloud.conventions import Range

lesson = Lesson()
CLOUD = rc.generate(seed=7, voxel=5.0 if lesson.quick else 2.0)
SUN, MEDIUM = rc.Sun([-0.62, 0.62, 0.42]), rc.Medium(0.4, 1.0, 0.3, "hg")


def marched(tolerance: float) -> rc.Picture:
    """March the cloud within a tolerance."""
    width, height = lesson.size(320, 240)
    camera = rc.Camera([3, -6, 126], [3, 14, 0], width=width, height=height)
    return rc.render(CLOUD, camera=camera, suns=SUN, medium=MEDIUM, tolerance=tolerance)


def picture(
    *,
    tolerance: Annotated[float, Range(0.0, 0.5, "displayed white")] = 0.05,
    gain: Annotated[float, Range(1.0, 1000.0)] = 20.0,
) -> Sheet:
    """Show the square root of a march's distance from the exact one, enlarged.

    Parameters
    ----------
    tolerance
        Largest error of a channel.
    gain
        Factor on the difference, before the root; at 20 white is 0.05 and more.
    """
    off = np.abs(marched(tolerance).linear - EXACT.linear)
    return grey(np.sqrt(np.minimum(gain * off.max(axis=-1), 1.0)))


EXACT = marched(0.0)
lesson.show(picture, "15-error", "A march at tolerance 0.05: square root of 20 x error")

# %% [markdown]
# ## One formula
#
# A promise about a picture is a promise about its worst pixel, not about the mean:
#
# $$ \max_{x, y, c} \; \lvert \, \mathrm{approximate} - \mathrm{exact} \, \rvert
# \;\le\; \mathrm{tolerance} $$
#
# The plain form measures it, and so does the array form:

# %%
from refcloud.image import largest_difference
from refcloud.plain import image as plain

lesson.source(plain.largest_difference, largest_difference)

# %% [markdown]
# ## The knob: the tolerance
#
# Time and error of each, on this machine. Two kinds of saving serve a tolerance. Some
# are **proved**: an octave below half a code, a ball behind an opaque front. Others are
# **certified**: a method is compared with the exact one at a hashed sample of pixels,
# and given up where it fails. A picture says which were used.

# %%
tolerances = (0.005, 0.05, 0.2) if lesson.quick else (0.002, 0.005, 0.02, 0.05, 0.2)
errors = []
for tolerance in tolerances:
    drawn = lesson.timed(f"tolerance {tolerance:g}", marched, tolerance)
    errors.append(max(largest_difference(drawn.linear, EXACT.linear), 1e-6))
    print(f"largest error {errors[-1]:.5f}")
    lesson.told(drawn.skipped)
    assert errors[-1] <= tolerance
lesson.plot(
    tolerances,
    {"largest error": errors, "the promise": tolerances},
    "15-promise",
    "The largest error stays below what was allowed",
    y_range=(1e-4, 1.0),
    names=("tolerance", ""),
    log=(True, True),
)
lesson.strip(
    marched,
    "tolerance",
    (0.0, 0.01, 0.03, 0.1, 0.3),
    "15-strip",
    "Five tolerances: the pictures look alike, as they should",
)

# %% [markdown]
# ## Stability: where digits go
#
# A formula that is right on paper can lose its digits in a computer. The map of
# stability runs algorithms over their parameters, and past them, against exact
# arithmetic. A green square keeps its digits, amber loses some, red is wrong; grey is
# refused at the door.

# %%
probes = [p for p in stability.PROBES if not p.slow][: 2 if lesson.quick else 6]
panels = stability.panels(probes)
print(stability.text_of(panels))
shown = stability.bare_map(panels) if lesson.quick else stability.labelled_map(panels)
lesson.show(
    grey(shown.codes(tone="none", dither=False) / 255),
    "15-stability",
    "Part of the map of stability; refcloud bench stability draws all of it",
)

# %% [markdown]
# ## Where this breaks
#
# * A certificate by a sample is a promise with a small risk: a spot that no sampled
#   pixel met. It is hunted with generated scenes, not proved.
# * In float32 Henyey-Greenstein at g = 0.999 is 10 % low, if written as in the books
#   (E36): 1 + g² - 2 g cos cancels. Written with 1 - g it does not.
# * A whole-picture RMS hides a wrong patch: 8 x 8 pixels off by 40 codes pass RMS 2.
#
# ## Exercises
#
# 1. What does a tolerance of 1/255 mean on the screen?
# 2. Compute 1 - cos(x) for x = 1e-9 in two ways.
# 3. Which error passes RMS 2 on 192 x 192 pixels in a patch of 8 x 8?
#
# ## Solutions
#
# 1. One code of linear light; after the sRGB curve a dark pixel moves up to 13 codes.

# %%
# 2: the difference is 0, the half-angle form is not.
assert 1 - np.cos(1e-9) == 0.0
assert abs(2 * np.sin(0.5e-9) ** 2 - 0.5e-18) < 1e-30

# 3: sqrt(64 / 36864) times the patch's error: 48 codes.
assert 2 / np.sqrt(64 / 192**2) == 48
