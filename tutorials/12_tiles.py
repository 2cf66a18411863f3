# %% [markdown]
# # 12 · Tiles: the same picture, faster
#
# *Drawing ball after ball touches each pixel of each ball, and most of that work is
# never seen. How do you draw the same picture with a fraction of it?*
#
# Cut the picture into **tiles** of 16 x 16 pixels, give each its own short list of
# balls, and go through the list from the front until nothing behind can show.

# %%
from functools import partial
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, enlarged, grey

import refcloud as rc
from refcloud.camera import project
from refcloud.conventions import Range
from refcloud.lighting import eyeward_literal
from refcloud.raster.tile_lists import SIDE, Discs, parts, tile_lists

lesson = Lesson()
BALLS = rc.voxel_balls(rc.generate(seed=7, voxel=5.0 if lesson.quick else 2.0))
LIT = rc.sunward(BALLS, (rc.Sun([-0.62, 0.62, 0.42]),), medium=rc.Medium(1.2))


def picture(
    *,
    shown: Literal["picture", "tiles"] = "tiles",
    tolerance: Annotated[float, Range(0.0, 0.2, "displayed white")] = 0.0,
) -> rc.Picture | Sheet:
    """Draw a cloud, or how many balls each tile of it has.

    Parameters
    ----------
    shown
        The picture, or a shade for each tile: the longer its list, the deeper.
    tolerance
        Largest error that savings may make in the picture.
    """
    camera = eye()
    if shown == "picture":
        return rc.render(LIT, camera=camera, tolerance=tolerance)
    count = listed(camera)
    share = (count / count.max())[..., None] ** 0.7
    shade = np.array([0.97, 0.97, 0.96]) - share * [0.27, 0.72, 0.94]
    codes = enlarged(grey(shade), SIDE).codes.copy()
    codes[::SIDE] = codes[:, ::SIDE] = 205
    return Sheet(codes[: camera.height, : camera.width])


def eye(width: int = 480, height: int = 360) -> rc.Camera:
    """Look at the cloud from the front."""
    width, height = lesson.size(width, height)
    return rc.Camera([3, -4, 128], [3, 14, 0], width=width, height=height)


def listed(camera: rc.Camera) -> np.ndarray:
    """Count the balls on the list of each tile."""
    x, y, _, scale = project(camera, BALLS.centers)
    discs = Discs(x, y, BALLS.radii * scale)
    count = np.zeros((-(-camera.height // SIDE), -(-camera.width // SIDE)), int)
    for lists in parts(discs, camera.width, camera.height):
        count[lists.row, lists.column] = lists.count
    return count


lesson.show(picture, "12-lists", "Balls on the list of each tile of 16 x 16 pixels")

# %% [markdown]
# ## One formula
#
# Blending far to near needs every ball of a pixel. Written from the front it is a sum,
# with `s` the colours of the balls and `F` the light that passes all nearer ones:
#
# $$ F_k = T_0 T_1 \cdots T_{k-1}, \qquad
# c = \sum_k s_k \, (F_k - F_{k+1}) + F_\mathrm{end} \, \mathrm{background} $$
#
# Where F has come to 0, nothing can follow. The plain form goes from the back, ball by
# ball `c = s (1 - T) + T c`: the same sum, where the T of later, nearer balls make F.

# %%
from refcloud.plain import eyeward as plain

lesson.source(plain.eyeward)

# %% [markdown]
# The fast form makes one list of pairs, sorted by tile. Then it goes down the lists of
# 64 tiles at a time, and leaves out every pixel that has become opaque.

# %%
lesson.source(tile_lists)

# %% [markdown]
# ## The same picture
#
# Equal to the literal loop within rounding, and here is what each of them costs:

# %%
camera = eye(316, 237)
how = {"background": rc.clear_sky(camera)}
first = lesson.timed("ball after ball", eyeward_literal, LIT, camera, **how)
exact, _ = lesson.timed("tiles, exact", rc.eyeward, LIT, camera, **how)
how["tolerance"] = 1 / 255
loose, rows = lesson.timed("tiles, 1/255", rc.eyeward, LIT, camera, **how)
lesson.told(rows)
assert np.abs(exact - first).max() < 1e-12
assert np.abs(loose - first).max() <= 1 / 255
first, exact, loose = (rc.Picture(light[..., :3]) for light in (first, exact, loose))
off = rc.difference_picture(first, loose, gain=100)
lesson.row(
    {"tiles, exact": exact, "difference at 1/255, x 100": off},
    "12-same",
    "The exact tiles, and what a tolerance of one code changes, times 100",
    columns=2,
)

# %% [markdown]
# ## The knob: the tolerance

# %%
cloud, allowed = partial(picture, shown="picture"), (0.0, 0.004, 0.02, 0.05, 0.2)
lesson.strip(cloud, "tolerance", allowed, "12-strip", "From 0 to a fifth of white")

# %% [markdown]
# ## Where this breaks
#
# * A thin cloud is nowhere opaque: every ball of every list has to be drawn.
# * Very few, very large balls: every tile lists all of them.
# * Sums in another order round otherwise: equal means within 1e-12, not the same bits.
#
# ## Exercises
#
# 1. How many pairs of tile and ball are there, against balls times tiles?
# 2. After how many layers of tau = 1 is less than half a code of 255 left?
# 3. Why may a tile not stop at its *first* opaque pixel?
#
# ## Solutions
#
# 3. Its other pixels still look through: the one that lets most pass decides.

# %%
# 1: 1.5 %: a ball reaches 4 or 5 of 300 tiles. A quick picture has fewer tiles: 14 %.
count = listed(camera)
assert count.sum() < 0.3 * count.size * len(BALLS)

# 2: exp(-n) < 1/510 from n = 7 on: most lists of this cloud are longer.
assert np.exp(-7) < 1 / 510 < np.exp(-6)
