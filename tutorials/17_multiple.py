# %% [markdown]
# # 17 · Multiple scattering: the light left out
#
# *Why are real clouds so white, and ours so grey?*
#
# Because scattered light meets the next droplet, and the next. The first meeting alone
# gives the slab below less than a thirtieth of its light. The rest can be solved.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson

import refcloud as rc
from refcloud import march, transport
from refcloud.conventions import Range

lesson = Lesson()
CLOUD = rc.generate(seed=12, voxel=8.0 if lesson.quick else 2.0)


def picture(
    *,
    scattering: Literal["single", "multiple"] = "multiple",
    sigma_t: Annotated[float, Range(0.05, 4.0, "1 / scene unit")] = 0.8,
    albedo: Annotated[float, Range(0.0, 1.0)] = 1.0,
) -> rc.Picture:
    """March a cloud with light of one order or of every order of scattering.

    Parameters
    ----------
    scattering
        Once, or as often as it happens.
    sigma_t
        Extinction per unit of length where the density is 1.
    albedo
        Share of the light that survives each meeting.
    """
    width, height = lesson.size(400, 300)
    camera = rc.Camera([0, -10, 128], [1, 17, 0], width=width, height=height)
    return rc.render(
        CLOUD,
        camera=camera,
        suns=rc.Sun([-0.62, 0.62, 0.42], [6.3, 6.0, 5.6]),
        medium=rc.Medium(sigma_t, albedo, 0.6, "hg"),
        scattering=scattering,
        ambient=[0.2, 0.28, 0.4],
        tolerance=4 / 255,
    )


lesson.show(picture, "17-multiple", "A cloud with light of every order of scattering")
lesson.row(
    {"once": lambda: picture(scattering="single"), "every order": picture},
    "17-once",
    "The same cloud, medium and sun; light scattered once, and as often as it happens",
    columns=2,
)

# %% [markdown]
# ## One formula
#
# Light `L` at a place in a direction is made of light from all directions at all places
# before it. That the unknown stands on both sides is what makes it hard:
#
# $$ L(x, \omega) = \int_0^\infty e^{-\tau(x, x - t\omega)} \, \sigma_t \, a
# \int_{S^2} p(\omega, \omega') \, L(x - t\omega, \omega') \, d\omega' \, dt $$
#
# The plain way follows one path of light at a time, from the eye back, and throws dice
# for every turn: unbiased, and noisy.

# %%
from refcloud.plain import paths as plain
from refcloud.plain import sweep as plain_sweep

lesson.source(plain.walk)

# %% [markdown]
# The other way solves it once for all eyes: the sphere becomes a few dozen directions,
# and each **sweep** carries light along all of them through the whole grid. What voxels
# then scatter feeds the next sweep, until nothing changes. For one voxel, and for all:

# %%
lesson.source(plain_sweep.sweep, transport.sweep)

# %% [markdown]
# ## The knob: albedo
#
# One per cent lost at each meeting is a lot, where light meets a hundred droplets.

# %%
albedos = (0.5, 0.8, 0.95, 0.99, 1.0)[:: 2 if lesson.quick else 1]
lesson.strip(picture, "albedo", albedos, "17-strip", "Albedo 0.5 to 1")

# %% [markdown]
# ## How many meetings?
#
# The paths can count. Here is what paths of at most n scatterings show, in the middle
# of a slab of optical depth 12. At 64 it still rises; 256 are nearly all.

# %%
slab = rc.VoxelGrid(np.ones((4, 4, 4)), [-40, -40, 0], [40, 40, 1])
ray = [[0.0, 0.0, 9.0]], [[0.0, 0.0, -1.0]]
scene = {"suns": rc.Sun([0.0, 0.5, 1.0]), "medium": rc.Medium(12.0, 1.0, 0.6, "hg")}
orders, paths = [2**k for k in range(9)], 256 if lesson.quick else 16384
shown = []
for n in orders:
    traced = transport.trace_paths(slab, *ray, paths=paths, orders=n, **scene)
    shown.append(traced.radiance[0, 0])
    print(f"{n:3} meetings: {shown[-1]:.3f}, standard error {traced.error[0, 0]:.3f}")
once, _ = march.integrate(slab, *ray, **scene)
lesson.plot(
    orders,
    {"paths": shown, "exact, once": [once[0, 0]] * len(orders)},
    "17-orders",
    "What a slab shows against the number of scatterings that are counted",
    y_range=(0.0, 3.0),
    names=("scatterings at most", "radiance"),
    log=(True, False),
)

# %% [markdown]
# ## Where this breaks
#
# * **No exact method.** The solver's finest plan is the measure; its own distance from
#   unbiased paths grows with the optical depth of one voxel: 0.5 % at 0.25, 10 % at 5.
# * **Tricks.** Paper M hands light forward (tutorial 10), "Beer-powder" darkens edges:
#   cheap, tuned to one cloud, and off by a quarter to four fifths on another.
# * **Few directions.** A sharp forward peak is cut off and treated as not scattered at
#   all (delta-M), or a few dozen directions would miss it.
#
# ## Exercises
#
# 1. What does a cloud of albedo 1 show in light that comes from everywhere alike?
# 2. At albedo 0.99, how much is left after 100 meetings?
# 3. Why is the underside of a real cloud dark, if nothing is absorbed?
#
# ## Solutions
#
# 3. The light goes back up: a thick slab of albedo 1 reflects nearly all of it.

# %%
# 1: nothing: the cloud vanishes. What it takes out of a ray, 1 - exp(-3), it puts back.
scene = {"suns": (), "medium": rc.Medium(3.0, 1.0, 0.5, "hg"), "sky": [1.0] * 3}
furnace = transport.trace_paths(slab, *ray, ground=[1.0] * 3, paths=256, **scene)
assert abs(1.0 - np.exp(-3.0) - furnace.radiance[0, 0]) < 5 * furnace.error[0, 0]

# 2: a third.
assert abs(0.99**100 - 0.366) < 1e-3
