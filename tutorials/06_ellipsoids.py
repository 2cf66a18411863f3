# %% [markdown]
# # 06 · From noise to a cloud
#
# *Noise fills all of space. How does it become one cloud, here, of this size?*
#
# Paper M cuts it out with an ellipsoid: dense in the middle, fading outward, with the
# noise deciding where the fading ends.

# %%
from typing import Annotated

import numpy as np
from lesson import Lesson
from sheets import grey

import refcloud as rc
from refcloud.cloudmap import evaluate_quadric, modulate, quadric
from refcloud.conventions import Range

lesson = Lesson()
VOXEL = 4.0 if lesson.quick else 2.0  # edge, scene units


def picture(
    *,
    threshold: Annotated[float, Range(0.0, 0.9)] = 0.1,
    ellipsoids: Annotated[int, Range(1, 12)] = 1,
    seed: Annotated[int, Range(0, 99)] = 2,
) -> rc.Picture:
    """Draw paper M's cloud map, a ball for each voxel.

    Parameters
    ----------
    threshold
        t: products below it are empty.
    ellipsoids
        How many ellipsoid volumes are united.
    seed
        Which cloud.
    """
    cloud = rc.generate(
        "ellipsoid", seed=seed, voxel=VOXEL, threshold=threshold, ellipsoids=ellipsoids
    )
    return seen(cloud, [0, -12, 105], [0, 0, 0])


def seen(cloud: rc.VoxelGrid, eye: list[float], target: list[float]) -> rc.Picture:
    """Draw a cloud map, a ball for each voxel."""
    width, height = lesson.size(480, 360)
    return rc.render(
        rc.voxel_balls(cloud),
        camera=rc.Camera(eye, target, width=width, height=height),
        suns=rc.Sun([-0.62, 0.62, 0.42]),
        medium=rc.Medium(1.5),
        tolerance=lesson.tolerance(1 / 255),
    )


lesson.show(picture, "06-cloud", "One ellipsoid, cut out of four octaves of noise")

# %% [markdown]
# ## One formula
#
# The quadric `Q` is 1 at the centre `c` and 0 on the surface of radii `r` (equation 8);
# noise, quadric and threshold make the density (equations 9 and 10). As printed, eq 10
# holds no noise at all, though the text says it does; this is the reading (E15):
#
# $$ Q = 1 - \sum_k \left(\frac{p_k - c_k}{r_k}\right)^2, \qquad
# D = d \, \wp \, Q \; \text{ where } \; \wp \, Q \ge t, \; \text{ else } 0 $$

# %%
from refcloud.plain import cloudmap as plain

lesson.source(plain.quadric, plain.modulate, modulate)

# %% [markdown]
# A slice through the middle shows quadric, noise, and what is left of their product:

# %%
width, height = lesson.size(208, 150)
x, y = np.linspace(-32, 32, width), np.linspace(23, -23, height)
grid = np.stack([*np.meshgrid(x, y), np.zeros((height, width))], axis=-1)
Q = evaluate_quadric(quadric([0, 0, 0], [30, 17, 22]), grid)
noise = rc.noise.octave_sum(grid / 16, seed=2)
lesson.row(
    {"Q": grey(Q), "noise": grey(noise), "D": grey(modulate(Q, noise), 0, 0.6)},
    "06-stages",
    "Quadric, noise, and the density that is left",
    columns=3,
)

# %% [markdown]
# ## The knob: the threshold
#
# It is there "for highlighting empty spaces": the higher `t`, the more falls away.

# %%
lesson.strip(
    picture, "threshold", (0.0, 0.05, 0.1, 0.2, 0.4), "06-strip", "t from 0 to 0.4"
)

# %% [markdown]
# ## Where this breaks
#
# The absolute value of eq 1 is 0 on whole surfaces, so creases cut right through the
# cloud: foam, and loose beads. A cumulus wants a closed surface that is **moved** by
# the noise. That is `rc.generate()` without a shape's name: a pile of ellipsoids on a
# flat base, whose signed depth the noise shifts.


# %%
def moved(relief: float) -> rc.Picture:
    """Draw a pile of ellipsoids whose surface the noise moves so far."""
    cloud = rc.generate(seed=7, voxel=VOXEL, relief=relief)
    return seen(cloud, [3, -4, 128], [3, 14, 0])


lesson.row(
    {
        "eq 8 to 10, one": picture,
        "eq 8 to 10, seven": lambda: picture(ellipsoids=7),
        "pile, relief 0": lambda: moved(0.0),
        "pile, relief 6": lambda: moved(6.0),
    },
    "06-shapes",
    "The paper's ellipsoids, and a pile of them whose surface is moved",
    columns=4,
)

# %% [markdown]
# ## Exercises
#
# 1. What is Q half way from the centre to the surface, along any axis?
# 2. Why can no voxel be denser than the noise there?
# 3. Which share of the ellipsoid's volume is left at t = 0.1?
#
# ## Solutions

# %%
# 1: 1 - (1/2)^2 = 3/4.
assert plain.evaluate_quadric(plain.quadric([1, 2, 3], [4, 4, 4]), [3, 2, 3]) == 0.75

# 2: Q is at most 1, and d too.
assert np.all(modulate(Q, noise, threshold=0.0) <= noise)

# 3: count voxels against 4/3 pi r r r; about a quarter.
cloud = rc.generate("ellipsoid", seed=2, voxel=2.0, diameters=[60, 34, 44])
share = np.count_nonzero(cloud.density) * 2.0**3 / (np.pi / 6 * 60 * 34 * 44)
assert 0.15 < share < 0.35
print(f"{share:.2f} of the ellipsoid is cloud")
