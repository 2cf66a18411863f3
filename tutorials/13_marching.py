# %% [markdown]
# # 13 · Marching rays: Beer, Henyey-Greenstein, sun
#
# *Can a cloud be drawn without balls, straight from its voxels?*
#
# Document D does: from the eye a ray goes through each pixel into the box, in steps. At
# every step it asks how dense it is, how much sunlight arrives (by another march, to
# the sun), and how much of it turns toward the eye.

# %%
from typing import Annotated

import numpy as np
from lesson import Lesson

import refcloud as rc
from refcloud import march
from refcloud.camera import rays
from refcloud.conventions import Range

lesson = Lesson()
CLOUD = rc.generate(seed=7, voxel=5.0 if lesson.quick else 1.4)


def picture(
    *,
    sigma_t: Annotated[float, Range(0.02, 4.0, "1 / scene unit")] = 0.5,
    g: Annotated[float, Range(-0.9, 0.9)] = 0.3,
    sun_height: Annotated[float, Range(-1.0, 2.0)] = 0.6,
    sky: Annotated[float, Range(0.0, 1.0, "radiance")] = 0.3,
) -> rc.Picture:
    """March rays through a cloud map.

    Parameters
    ----------
    sigma_t
        Extinction per unit of length where the density is 1.
    g
        Mean cosine of the scattering: forward is 1.
    sun_height
        y of the sun's direction.
    sky
        Light that comes from all sides alike.
    """
    width, height = lesson.size(400, 300)
    camera = rc.Camera([3, -6, 126], [3, 14, 0], width=width, height=height)
    return rc.render(
        CLOUD,
        camera=camera,
        suns=rc.Sun([-0.6, sun_height, 0.4], [14.0, 13.3, 12.0]),
        medium=rc.Medium(sigma_t, 1.0, g, "hg"),
        ambient=[0.8 * sky, sky, 1.3 * sky],
        tolerance=lesson.tolerance(2 / 255),
    )


lesson.show(picture, "13-march", "A cloud map, marched: no balls, no splats")

# %% [markdown]
# ## One formula
#
# What reaches the eye is the integral along the ray, of density times what has come
# from the sun times what gets through to the eye, and the background behind it all:
#
# $$ L = \int_{t_0}^{t_1} \sigma_t \rho(t) \; e^{-\tau(t_0, t)} \; a \, p(\cos\theta) \,
# E \, e^{-\tau_\mathrm{sun}(t)} \, dt + e^{-\tau(t_0, t_1)} L_\mathrm{behind} $$
#
# In steps, to the letter:

# %%
from refcloud.march.steps import _marched
from refcloud.plain import march as plain

lesson.source(plain.sun_depth_by_steps, plain.march_by_steps)

# %% [markdown]
# In arrays all rays go forward one step together.

# %%
lesson.source(_marched)

# %% [markdown]
# ## The knob: extinction

# %%
lesson.strip(
    picture, "sigma_t", (0.05, 0.15, 0.5, 1.5, 4.0), "13-strip", "From mist to chalk"
)
lesson.strip(picture, "sun_height", (-0.3, 0.3, 2.0), "13-sun", "The sun climbs")

# %% [markdown]
# ## Where this breaks
#
# A step that jumps over a thin wisp has not seen it. How many are enough? Ask the exact
# integral (it is what `tolerance=0` draws), which cuts every ray where it crosses a
# cell's face, so that each piece is a polynomial. Document D adds `tau` of a step where
# `1 - exp(-tau)` belongs (E38): Euler's sum makes light where steps are deep.

# %%
seen = rays(rc.Camera([0, -6, 112], [0, 14, 0], width=16, height=12))
scene = {"suns": rc.Sun([-0.6, 0.6, 0.4]), "medium": rc.Medium(0.5, 1.0, 0.3, "hg")}
exact, _ = march.integrate(CLOUD, *seen, **scene)
rates = [4, 8, 16, 32] if lesson.quick else [4, 8, 16, 32, 64, 128]
errors: dict[str, list[float]] = {"euler": [], "beer": []}
for segment, found in errors.items():
    for rate in rates:
        steps = {"sample_rate": rate, "sun_sample_rate": rate, "segment": segment}
        light, _ = march.march_by_steps(CLOUD, *seen, **scene, **steps)
        found.append(np.abs(light - exact).max())
errors["one code of 255"] = [1 / 255] * len(rates)
lesson.plot(
    rates,
    errors,
    "13-steps",
    "The largest error of 192 pixels against the number of steps",
    y_range=(1e-3, 30.0),
    names=("steps to the eye, and to the sun at each", "largest error"),
    log=(True, True),
    legend="top",
)

# %% [markdown]
# ## Exercises
#
# 1. What does a homogeneous slab of depth tau show, lit from behind the eye, without a
#    background?
# 2. Check that T of two halves is the product of their T.
# 3. How much light does Euler's sum add too much in one step of tau = 1?
#
# ## Solutions

# %%
# 1: light goes t in and t out: the integral of exp(-2 t) is (1 - exp(-2 tau)) / 2.
slab = rc.VoxelGrid(np.ones((2, 2, 2)), [-50, -50, 0], [50, 50, 1])
scene = {"suns": rc.Sun([0, 0, 1]), "medium": rc.Medium(2, phase="isotropic")}
L, T = march.integrate(slab, [0.0, 0, 9], [[0.0, 0, -1]], **scene)
assert abs(L[0, 0] - (1 - np.exp(-4.0)) / 2) < 1e-6

# 2: depths add, so transmittances multiply.
assert abs(T[0] - np.exp(-1.0) * np.exp(-1.0)) < 1e-12

# 3: 1 / (1 - exp(-1)) = 1.58 times as much as is there.
assert plain.segment_share(1.0, "euler") / plain.segment_share(1.0, "beer") > 1.58
