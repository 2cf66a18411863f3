# %% [markdown]
# # 07 · Metaballs and their kernels
#
# *A cloud of 11,000 voxels is a lot to draw. Can a few soft balls stand in for it, and
# what exactly is a soft ball?*
#
# A metaball is a centre, a radius, a density, and a **kernel** that says how the
# density falls from the centre to the edge. Where balls overlap, densities add.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, grey

import refcloud as rc
from refcloud import metaballs
from refcloud.conventions import Range

lesson = Lesson()


def picture(
    *,
    distance: Annotated[float, Range(0.0, 3.0, "radii")] = 1.2,
    kernel: Literal["wyvill", "gaussian"] = "wyvill",
    level: Annotated[float, Range(0.01, 1.0)] = 0.3,
) -> Sheet:
    """Show the density of two balls in a plane, with the line where it is `level`.

    Parameters
    ----------
    distance
        Between the two centres.
    kernel
        How density falls.
    level
        Where the line is drawn.
    """
    width, height = lesson.size(480, 300)
    balls = rc.Metaballs(
        [[-distance / 2, 0, 0], [distance / 2, 0, 0]], [1.0, 0.8], [1.0, 0.9], kernel
    )
    x, y = np.linspace(-2, 2, width), np.linspace(-1.25, 1.25, height)
    density = metaballs.field_grid(balls, x, y=y, z=[0.0])[0]
    # The line is a pixel or two wide: the distance to it is the height over the slope.
    slope = np.hypot(*np.gradient(density)) + 1e-9
    line = np.clip(2.0 - np.abs(density - level) / slope, 0.0, 1.0)
    shade = np.clip(density / 1.3, 0.0, 1.0)
    red, dark = np.maximum(shade, line), shade * (1.0 - 0.7 * line)
    return grey(np.stack([red, dark + 0.15 * line, dark], axis=-1))


lesson.show(picture, "07-two", "Two metaballs flow together; the line is density 0.3")

# %% [markdown]
# ## One formula
#
# Paper M's equation 12, Wyvill's kernel, as a function of `a = r/R`. It is printed with
# +22/9, which grows outward; this sign makes it fall to 0 with slope 0 (E01):
#
# $$ f(a) = 1 - \tfrac{22}{9} a^2 + \tfrac{17}{9} a^4 - \tfrac49 a^6 $$

# %%
from refcloud.plain import metaballs as plain

lesson.source(plain.wyvill, plain.field)

# %% [markdown]
# In arrays the same runs over all points of a grid at once, and for each ball only over
# the part of the grid that it reaches: `metaballs.field_grid`. The kernel alone:

# %%
lesson.source(metaballs.kernels.wyvill)

# %%
a = np.linspace(0.0, 1.0, 201)
profile = metaballs.profile(a**2)
lesson.plot(
    a,
    {
        "Wyvill": profile,
        "Gauss, R = 2 sigma": metaballs.profile(a**2, "gaussian"),
        "as printed": [plain.printed_wyvill(x, 1.0) for x in a],
    },
    "07-kernels",
    "Two kernels, and equation 12 as it is printed",
    y_range=(0.0, 2.0),
    names=("r / R", "density"),
)

# %% [markdown]
# ## The knob: the distance

# %%
lesson.strip(
    picture, "distance", (0.0, 0.8, 1.2, 1.5, 2.0), "07-strip", "0 to 2 radii apart"
)

# %% [markdown]
# ## From kernel to footprint
#
# On the screen a ball is a **footprint**: what a line of sight meets on its way
# through. Paper M splats `f` of the distance in the plane. The integral along the chord
# is another curve, narrower at the rim (E04), and has a closed form:

# %%
lesson.source(plain.chord)
chord = metaballs.chord(a**2) / (944 / 945)  # so that it is 1 on the axis
lesson.plot(
    a,
    {"chord": chord, "profile": profile, "10 x difference": 10 * (profile - chord)},
    "07-footprint",
    "The chord integral against the profile, both 1 on the axis",
    y_range=(-0.1, 1.1),
    names=("distance from the axis / R", ""),
    legend="top",
)

# %% [markdown]
# ## Where this breaks
#
# * **Normalisation.** The paper divides by k = 748/405 pi R, which normalises nothing
#   (E02), and says that the density at the centre is rho, which needs k = 1 (E03).
#   refcloud takes the peak, 1; `metaballs.integral` gives what a ball holds in all.
# * **The Gaussian never ends.** Cut at R = 2 sigma it still is exp(-4) = 0.018: a faint
#   edge, which light finds.
#
# ## Exercises
#
# 1. Show that f(1/2) = 1/2.
# 2. How much of a ball of radius 1 and density 1 is there? Integrate over its volume.
# 3. Where is the profile farthest from the footprint, and by how much?
#
# ## Solutions

# %%
# 1: 1 - 22/36 + 17/144 - 4/576 = 1/2.
assert abs(plain.wyvill(0.5, 1.0) - 0.5) < 1e-15

# 2: shells of area 4 pi r^2; the closed form is 736/2835 pi.
r = (np.arange(10_000) + 0.5) / 10_000
volume = np.sum(4 * np.pi * r**2 * metaballs.profile(r**2)) / 10_000
assert abs(volume - metaballs.integral("wyvill", 3)) < 1e-7

# 3: at a = 0.57, and 0.065 of what it is on the axis.
off = profile - chord
assert abs(a[off.argmax()] - 0.57) < 0.02
assert abs(off.max() - 0.065) < 0.001
