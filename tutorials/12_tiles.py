# %% [markdown]
# # 12 · Tiles: the same picture, faster
#
# *Drawing ball after ball touches each pixel of each ball, and most of that work is
# never seen. How do you draw the same picture with a fraction of it?*
#
# Not by being clever with balls, but with **pixels**: cut the picture into squares of
# 16 x 16, give each its own short list of balls, and go through the list from the front
# until nothing behind can show.

# %%
import time
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson
from sheets import Sheet, enlarged, grey, sheet_of

import refcloud as rc
from refcloud.camera import project
from refcloud.conventions import Range
from refcloud.raster.tile_lists import SIDE, Discs, parts

lesson = Lesson()
BALLS = rc.voxel_balls(rc.generate(seed=7, voxel=5.0 if lesson.quick else 2.0))
SUN = rc.Sun([-0.62, 0.62, 0.42])
SKY = rc.Sky()


def picture(
    *,
    tolerance: Annotated[float, Range(0.0, 0.2, "displayed white")] = 0.0,
    shown: Literal["picture", "tiles"] = "tiles",
    sigma_t: Annotated[float, Range(0.01, 5.0, "1 / scene unit")] = 1.2,
) -> rc.Picture | Sheet:
    """Draw a cloud, or how many balls each tile of it has.

    Parameters
    ----------
    tolerance
        Largest error that savings may make.
    shown
        The picture, or the lengths of the tiles' lists over it.
    sigma_t
        Extinction; the thicker, the sooner a tile is opaque.
    """
    camera = eye()
    if shown == "tiles":
        return lists_over(camera)
    lit = rc.sunward(BALLS, (SUN,), medium=rc.Medium(sigma_t), tolerance=tolerance)
    light, rows = rc.eyeward(
        lit, camera, background=rc.clear_sky(camera), tolerance=tolerance
    )
    return rc.Picture(light[..., :3], skipped=rows)


def eye(width: int = 480, height: int = 360) -> rc.Camera:
    """Look at the cloud from the front."""
    width, height = lesson.size(width, height)
    return rc.Camera([3, -4, 128], [3, 14, 0], width=width, height=height)


def lists_over(camera: rc.Camera) -> Sheet:
    """Show each tile's list as a shade of orange: the more balls, the deeper."""
    x, y, depth, scale = project(camera, BALLS.centers)
    order = np.argsort(depth)
    discs = Discs(x[order], y[order], (BALLS.radii * scale)[order])
    across, down = -(-camera.width // SIDE), -(-camera.height // SIDE)
    count = np.zeros((down, across))
    for lists in parts(discs, camera.width, camera.height):
        count[lists.row, lists.column] = lists.count
    share = (count / max(count.max(), 1.0))[..., None]
    deep, paper = np.array([0.70, 0.25, 0.02]), np.array([0.97, 0.97, 0.96])
    codes = enlarged(grey(paper + share**0.7 * (deep - paper)), SIDE).codes.copy()
    codes[::SIDE] = codes[:, ::SIDE] = 205
    return Sheet(codes[: camera.height, : camera.width])


lesson.show(picture, "12-lists", "Balls on the list of each tile of 16 x 16 pixels")

# %% [markdown]
# ## One formula
#
# Blending far to near needs every ball of a pixel. Written from the front it is a sum,
# with `F` the light that passes all nearer balls:
#
# $$ F_k = T_0 T_1 \cdots T_{k-1}, \qquad
# c = \sum_k s_k \, (F_k - F_{k+1}) + F_\mathrm{end} \, \mathrm{background} $$
#
# All terms after the point where F is 0 are 0. The plain form is the one to the letter,
# from the back:

# %%
from refcloud.plain import eyeward as plain
from refcloud.raster.tile_lists import tile_lists

lesson.source(plain.eyeward)

# %% [markdown]
# The fast form starts from one list of pairs, sorted by tile. `raster.tiles.composite`
# then sums a few list slots of many tiles at a time, so that everything stays in the
# processor's cache.

# %%
lesson.source(tile_lists)

# %% [markdown]
# ## The same picture
#
# Equal to the literal loop within rounding, and here is what each of them costs:

# %%
lit = rc.sunward(BALLS, (SUN,), medium=rc.Medium(1.2))
camera = eye(316, 237)
sky = rc.clear_sky(camera)
drawn, seconds = {}, {}
for name, way in {
    "ball after ball": lambda: rc.lighting.eyeward_literal(lit, camera, background=sky),
    "tiles, exact": lambda: rc.eyeward(lit, camera, background=sky)[0],
    "tiles, 1/255": lambda: rc.eyeward(lit, camera, background=sky, tolerance=1 / 255)[
        0
    ],
}.items():
    start = time.process_time()
    drawn[name] = way()[..., :3]
    seconds[name] = time.process_time() - start
    print(f"{name:16} {seconds[name]:.2f} s")
first, exact, loose = drawn.values()
assert np.abs(exact - first).max() < 1e-11
assert np.abs(loose - first).max() <= 1 / 255
cells = {name: sheet_of(rc.Picture(light)) for name, light in drawn.items()}
off = rc.difference_picture(rc.Picture(first), rc.Picture(loose), gain=100)
lesson.row(
    {"tiles, exact": cells["tiles, exact"], "difference at 1/255, x 100": off},
    "12-same",
    "The exact tiles, and what a tolerance of one code changes, times 100",
    columns=2,
)

# %% [markdown]
# ## The knob: the tolerance

# %%
lesson.row(
    {
        f"tolerance {t:g}": (lambda t=t: picture(tolerance=t, shown="picture"))
        for t in (0.0, 0.004, 0.02, 0.05, 0.2)
    },
    "12-strip",
    "Tolerances from 0 to a fifth of white",
)
lesson.told(picture(tolerance=1 / 255, shown="picture").skipped)

# %% [markdown]
# ## Where this breaks
#
# * A thin cloud (`--shown picture --sigma-t 0.05`) is never opaque: every ball of every
#   list shows, and only the cache helps.
# * Very few, very large balls: every tile lists all of them.
# * Sums in another order round otherwise: equal means within 1e-12, not the same bits.
#
# ## Exercises
#
# 1. How many pairs of tile and ball are there, against balls times tiles?
# 2. After how many layers of tau = 1 is less than one code of 255 left?
# 3. Why may a tile not stop at its *first* opaque pixel?
#
# ## Solutions
#
# 3. Its other pixels still look through: the darkest of the tile's places decides.

# %%
# 1: see the first picture: a few per cent, since a ball reaches a few tiles.
x, y, _, scale = project(camera, BALLS.centers)
discs = Discs(x, y, BALLS.radii * scale)
pairs = sum(len(one.ball) for one in parts(discs, camera.width, camera.height))
tiles = -(-camera.width // SIDE) * -(-camera.height // SIDE)
assert pairs < 0.3 * tiles * len(BALLS)

# 2: exp(-n) < 1/510 from n = 7 on: most lists of this cloud are longer.
assert np.exp(-7) < 1 / 510 < np.exp(-6)
