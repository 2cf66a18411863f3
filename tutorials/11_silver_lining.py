# %% [markdown]
# # 11 · Light, pass 2: the silver lining
#
# *Why does a cloud in front of the sun have a shining rim?*
#
# Pass 1 stored how much light reaches each ball. Pass 2 draws the balls for the eye,
# far to near, and asks of each: how much of its light goes **this** way? A droplet
# throws most of it forward. At the rim the cloud is thin, and forward is where you
# stand.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson

import refcloud as rc
from refcloud import optics
from refcloud.conventions import Range

lesson = Lesson()
BALLS = rc.voxel_balls(rc.generate(seed=7, voxel=4.0 if lesson.quick else 2.0))
EVENING = rc.Sky([0.02, 0.075, 0.26], [0.15, 0.29, 0.54], [0.42, 0.52, 0.66])


def picture(
    *,
    phase: Literal["isotropic", "rayleigh", "hg"] = "hg",
    g: Annotated[float, Range(-0.9, 0.9)] = 0.6,
    height: Annotated[float, Range(0.0, 2.0)] = 0.36,
    light: Annotated[float, Range(0.0, 2.0)] = 0.5,
) -> rc.Picture:
    """Draw a cloud in front of the sun.

    Parameters
    ----------
    phase
        Where scattered light goes.
    g
        Mean cosine of phase "hg": 0 is everywhere alike, 1 straight on.
    height
        How high the sun stands behind the cloud.
    light
        Its strength; 1 is an isotropic scatterer shown white.
    """
    width, tall = lesson.size(480, 360)
    camera = rc.Camera([3, -14, 124], [3, 15, 0], width=width, height=tall)
    sun = rc.Sun([0.10, height, -0.93], np.full(3, light * 4 * np.pi))
    return rc.render(
        BALLS,
        camera=camera,
        suns=sun,
        medium=rc.Medium(1.2, 0.9, g, phase),
        background=EVENING,
        look=rc.Look(forward=0.5, erosion=0, relief=0),
        tolerance=lesson.tolerance(1 / 255),
    )


lesson.show(picture, "11-lining", "The sun behind the cloud, Henyey-Greenstein g = 0.6")

# %% [markdown]
# ## One formula
#
# Equation 29: from the farthest ball on, each adds its light toward the eye and dims
# what lies behind; `p` is the phase function at the angle between light and view:
#
# $$ I^*_k = g^*_k + T_k \, I^*_{k-1}, \qquad g^*_k \sim p(\cos\theta) \, I_k $$
#
# $$ p_\mathrm{HG}(\cos\theta) = \frac1{4\pi}
#    \frac{1 - g^2}{(1 + g^2 - 2 g \cos\theta)^{3/2}} $$

# %%
from refcloud.plain import eyeward, lighting
from refcloud.plain import optics as plain

lesson.source(plain.henyey_greenstein, lighting.ball_colours, eyeward.draw)

# %% [markdown]
# In arrays the loop over balls stays, far to near; inside it everything is a patch.

# %%
lesson.source(rc.lighting.eyeward_literal)

# %% [markdown]
# ## The knob: g

# %%
lesson.strip(picture, "g", (-0.3, 0.0, 0.3, 0.6, 0.8), "11-strip", "g from -0.3 to 0.8")
cosines = np.linspace(-1, 1, 201)
lesson.plot(
    cosines,
    {
        "Rayleigh, eq 25": 4 * np.pi * optics.rayleigh(cosines),
        "g = 0.3": 4 * np.pi * optics.henyey_greenstein(cosines, 0.3),
        "g = 0.6": 4 * np.pi * optics.henyey_greenstein(cosines, 0.6),
        "isotropic": np.ones_like(cosines),
    },
    "11-phases",
    "Phase functions: all have the mean 1, only g makes a forward peak",
    y_range=(0.05, 20.0),
    names=("cos theta, forward is 1", "4 pi p"),
    log=(False, True),
)

# %% [markdown]
# ## Where this breaks
#
# * **Rayleigh cannot do it.** Paper M names equation 25 for its anisotropic figure. It
#   runs from 0.75 to 1.5: a rim can be twice as bright as a side, never ten times.
# * **Counting 1/(4 pi) twice.** The paper's p has the mean 1 over the sphere, so its eq
#   26 divides; Henyey-Greenstein as written above already holds it (E20).
# * **The sign.** Forward is +1 here: cos theta is between the directions before and
#   after. With wo toward the eye and wi toward the sun it is -dot(wo, wi).

# %%
lesson.row(
    {
        "isotropic": lambda: picture(phase="isotropic"),
        "Rayleigh": lambda: picture(phase="rayleigh"),
        "g = 0.6": picture,
    },
    "11-rayleigh",
    "The same light and cloud under three phase functions",
    columns=3,
)

# %% [markdown]
# ## Exercises
#
# 1. How much brighter than an isotropic one is a scatterer of g = 0.6, looked at
#    against the sun?
# 2. Show that every phase function sends out as much light as it got.
# 3. Move the sun with `--height`. Where does the lining go?
#
# ## Solutions
#
# 3. It follows the sun: the rim shines where it is thin *and* near the sun's direction.

# %%
# 1: (1 - g^2) / (1 - g)^3 = (1 + g) / (1 - g)^2 = 10.
assert abs(4 * np.pi * plain.henyey_greenstein(1.0, 0.6) - 10.0) < 1e-12

# 2: the integral over the sphere is 2 pi times that over the cosine. Gauss's nodes.
nodes, weights = np.polynomial.legendre.leggauss(40)
for p in (optics.rayleigh(nodes), optics.henyey_greenstein(nodes, 0.6)):
    assert abs(2 * np.pi * np.sum(weights * p) - 1.0) < 1e-9
