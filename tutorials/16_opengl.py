# %% [markdown]
# # 16 · Against real OpenGL
#
# *refcloud claims to do what OpenGL does. How do you check a claim like that?*
#
# By drawing the same with OpenGL and comparing pixels. One in software is enough
# (Mesa's llvmpipe needs no display and no card). Where there is none, this page shows a
# picture that was drawn before.

# %%
from typing import Annotated

import numpy as np
from lesson import PICTURES, Lesson
from sheets import GAP, Sheet, grey

import refcloud as rc
from refcloud import raster
from refcloud.conventions import Backend, Range
from refcloud.image import read_png
from refcloud.raster.formats import Format

lesson = Lesson()
BALLS = rc.voxel_balls(rc.generate(seed=7, voxel=5.0 if lesson.quick else 2.0))


def picture(
    *,
    format: Format = "RGBA8",
    tau: Annotated[float, Range(0.001, 1.0)] = 0.006,
    balls: Annotated[int, Range(1, 600)] = 400,
) -> Sheet:
    """Draw many faint black balls over white, in a framebuffer of some format.

    Parameters
    ----------
    format
        Of the framebuffer, as OpenGL names it.
    tau
        Optical depth of a ball on its axis.
    balls
        How many lie over each other.
    """
    width, height = lesson.size(480, 300)
    buffer = raster.framebuffer(width, height, color=np.ones(4), format=format)
    x, y = (0.3 + 0.4 * (np.arange(balls) % 2)) * width, height / 2
    for place in x.tolist():
        raster.splat(buffer, place, y, 0.35 * width, emission=[0.0] * 3, tau=tau)
    return grey(buffer.pixels[..., :3])


lesson.show(
    picture, "16-format", "400 faint balls in 8 bits: a hard edge where the sum stalls"
)

# %% [markdown]
# ## One formula
#
# A format rounds after every blend. With 8 bits a colour `v` is stored as the nearest
# of 256 codes; a change below half a code is lost, each time:
#
# $$ v \leftarrow \tfrac{1}{255} \operatorname{round}\bigl(255 \,
# (c_s + T v)\bigr) $$

# %%
from refcloud.plain import framebuffer as plain

lesson.source(plain.stored, raster.stored)

# %% [markdown]
# ## The knob: the format

# %%
formats: tuple[Format, ...] = ("RGBA8", "SRGB8_ALPHA8", "RGBA16F", "RGBA32F", "RGBA64F")
lesson.strip(picture, "format", formats, "16-strip", "400 balls in five formats")

# %% [markdown]
# ## The two passes on OpenGL
#
# `backend="gl"` runs both passes of light in shaders, in float32. The pictures are
# compared as codes: one is what rounding may do.


# %%
def on_opengl(size: tuple[int, int]) -> np.ndarray:
    """Draw with OpenGL, or cut what was drawn before out of the page's picture."""
    file = PICTURES / ("quick" if lesson.quick else "") / "16-same.png"
    if not (lesson.quick and file.exists()):  # quick pictures are to be the same always
        try:
            return drawn_by("gl", size)
        except ValueError as missing:
            print(f"{missing}; the picture was drawn before")
    width, height = size
    return read_png(file)[:height, width + GAP : 2 * width + GAP]


def drawn_by(backend: Backend, size: tuple[int, int]) -> np.ndarray:
    """Draw a cloud by numpy or by OpenGL, as codes without a dither."""
    camera = rc.Camera([3, -4, 128], [3, 14, 0], width=size[0], height=size[1])
    shown = rc.render(BALLS, camera=camera, medium=rc.Medium(1.2), backend=backend)
    return shown.codes(dither=False)


size = lesson.size(208, 156)
by_numpy = drawn_by("numpy", size)
by_opengl = on_opengl(size)
found = rc.compare_codes(by_numpy, by_opengl, codes=1, fraction=1.0)
off = round(found.off_share * size[0] * size[1])
print(f"{off} of {size[0] * size[1]} pixels off, by {found.worst} at most")
lesson.row(
    {
        "numpy, float64": Sheet(by_numpy),
        "OpenGL, float32": Sheet(by_opengl),
        "difference x 100": grey(np.abs(by_numpy.astype(int) - by_opengl), 0.0, 2.55),
    },
    "16-same",
    "numpy, OpenGL, and their difference times 100: nearly nothing",
    columns=3,
)

# %% [markdown]
# ## Where this breaks
#
# * **Two drivers round differently.** The specification allows it: some round the
#   source to 8 bits before blending, some do not. So parity is checked on RGBA32F, and
#   8-bit targets get one code.
# * **To the bit** is possible for one driver that is known: `framebuffer(...,
#   arithmetic="llvmpipe")` computes what Mesa's llvmpipe holds after any blend.
# * **Upside down.** OpenGL counts rows from below. refcloud keeps row 0 at the top, and
#   turns pictures round at the border to OpenGL and nowhere else.
#
# ## Exercises
#
# 1. From which value on does a layer of alpha 1/255 change nothing in 8 bits?
# 2. How many digits does RGBA16F have near 1?
# 3. Run this with OpenGL: `pip install ".[gl]"`. Which pixels differ?
#
# ## Solutions
#
# 3. Those where the light is close to the middle between two codes.

# %%
# 1: 255 v / 255 < 1/2: below one half.
alpha = 1 / 255
assert plain.stored([(1 - alpha) * 127 / 255] * 4, "RGBA8")[0] == 127 / 255
assert plain.stored([(1 - alpha) * 129 / 255] * 4, "RGBA8")[0] == 128 / 255

# 2: 11 bits: the next number below 1 is 1 - 2^-11.
assert raster.stored([[1 - 2.0**-11] * 4], "RGBA16F")[0, 0] == 1 - 2.0**-11
assert raster.stored([[1 - 2.0**-14] * 4], "RGBA16F")[0, 0] == 1.0
