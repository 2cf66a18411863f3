# %% [markdown]
# # 09 · The framebuffer and glBlendFunc
#
# *A ball is drawn over other balls. What happens at a pixel that already has a colour?*
#
# OpenGL answers with two factors: one for what comes (the **source**), one for what is
# there (the **destination**). `glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA)` is how
# every ball of this course is drawn.

# %%
from typing import Annotated, Literal

import numpy as np
from lesson import Lesson

import refcloud as rc
from refcloud import raster
from refcloud.conventions import Range

lesson = Lesson()
Factor = Literal["ZERO", "ONE", "SRC_ALPHA", "ONE_MINUS_SRC_ALPHA"]


def picture(
    *,
    src: Factor = "ONE",
    dst: Factor = "ONE_MINUS_SRC_ALPHA",
    tau: Annotated[float, Range(0.0, 10.0)] = 4.0,
) -> rc.Picture:
    """Draw three balls, one after the other, over a sky.

    Parameters
    ----------
    src
        What the source is multiplied by.
    dst
        What the destination is multiplied by.
    tau
        Optical depth of each ball on its axis.
    """
    width, height = lesson.size(480, 320)
    buffer = raster.framebuffer(width, height)
    buffer.pixels[..., :3] = rc.sky_gradient(
        [0.1, 0.22, 0.5], [0.5, 0.65, 0.8], width=width, height=height
    )
    colours = [0.95, 0.6, 0.35], [0.9, 0.9, 0.9], [0.35, 0.6, 0.9]
    for k, colour in enumerate(colours):
        x, y = (0.34 + 0.16 * k) * width, (0.42 + 0.1 * (k % 2)) * height
        ball = raster.patch(x, y, height / 3, width, height)
        if ball is None:
            continue
        weight = raster.footprint(ball.q)
        alpha = 1.0 - raster.transmittance(weight, tau)
        source = np.concatenate([alpha[..., None] * colour, alpha[..., None]], axis=-1)
        raster.blend(buffer, ball.rows, ball.columns, source, src, dst)
    return rc.Picture(buffer.pixels[..., :3])


lesson.show(picture, "09-blend", "Three balls over a sky, ONE and ONE_MINUS_SRC_ALPHA")

# %% [markdown]
# ## One formula
#
# Equation 28, `f` the factors and `c` the colours; with the two factors above, and
# alpha = 1 - T, it reads "the ball's own light, and what the ball lets through of the
# rest":
#
# $$ c = f_s c_s + f_d c_d \;=\; c_s + T \, c_d $$

# %%
from refcloud.plain import raster as plain

lesson.source(plain.blend, plain.splat)

# %% [markdown]
# The array form blends a whole patch at once; the balls still come one after the other.

# %%
lesson.source(raster.blend)

# %% [markdown]
# ## The knob: the two factors
#
# `ONE, ONE` adds light and never covers. `SRC_ALPHA` multiplies by alpha a colour that
# already holds it: dark rims. `ZERO, ONE_MINUS_SRC_ALPHA` only covers. `ONE, ZERO` is
# no blending at all, and shows the square that is drawn for each ball.

# %%
pairs: dict[str, tuple[Factor, Factor]] = {
    "ONE, 1 - SRC_A": ("ONE", "ONE_MINUS_SRC_ALPHA"),
    "ONE, ONE": ("ONE", "ONE"),
    "SRC_A, 1 - SRC_A": ("SRC_ALPHA", "ONE_MINUS_SRC_ALPHA"),
    "ZERO, 1 - SRC_A": ("ZERO", "ONE_MINUS_SRC_ALPHA"),
    "ONE, ZERO": ("ONE", "ZERO"),
}
lesson.row(
    {label: (lambda f=f: picture(src=f[0], dst=f[1])) for label, f in pairs.items()},
    "09-factors",
    "The same three balls under five pairs of factors",
)
lesson.strip(picture, "tau", (0.3, 1.0, 2.0, 4.0, 10.0), "09-tau", "Depths 0.3 to 10")

# %% [markdown]
# ## Where this breaks
#
# A framebuffer of 8 bits rounds after every ball. A thin layer that should take 1/255
# of what is left takes nothing as soon as that is less than half a code: the sum
# **stalls** (E35). Paper M, and every card of its time, drew into 8 bits.

# %%
layers = np.arange(1001)
names: tuple[Literal["RGBA64F", "RGBA8"], ...] = ("RGBA64F", "RGBA8")
formats = {
    name: 1.0 - raster.seen_through_layers(1 / 255, 1000, format=name) for name in names
}
lesson.plot(
    layers,
    formats,
    "09-stall",
    "What a thousand thin layers cover, in float64 and in 8 bits",
    y_range=(0.0, 1.0),
    names=("layers of alpha 1/255", "what they cover"),
)

# %% [markdown]
# ## Exercises
#
# 1. In which order do two balls of colours A and B over a black sky give A + T B?
# 2. Blend the same three balls near to far instead. What changes with `ONE, ONE`?
# 3. Which factor pair draws a picture that is already there, and nothing else?
#
# ## Solutions

# %%
# 1: B first: A is drawn over it, and lets T of it through.
pixel = [0.0, 0.0, 0.0, 0.0]
for light in (0.2, 0.7):  # B, then A, both with alpha 0.4
    ball = [light, light, light, 0.4]
    pixel = plain.blend(ball, pixel, "ONE", "ONE_MINUS_SRC_ALPHA")
assert abs(pixel[0] - (0.7 + 0.6 * 0.2)) < 1e-15

# 2: nothing: sums do not mind the order.
# 3: ZERO, ONE.
assert plain.blend([0.9, 0.9, 0.9, 1.0], pixel, "ZERO", "ONE") == pixel
