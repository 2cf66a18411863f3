# %% [markdown]
# # 10 · Light, pass 1: readback
#
# *How much sunlight reaches a ball in the middle of a cloud?*
#
# Put the camera where the sun is, clear the framebuffer to white (unblocked light), and
# draw the balls from near to far. Before each ball is drawn, look at the pixels that it
# is about to cover: their mean **is** the light that reaches it.

# %%
from dataclasses import replace
from typing import Annotated

import numpy as np
from lesson import Lesson
from sheets import Sheet, grey

import refcloud as rc
from refcloud.conventions import Range
from refcloud.lighting.lightview import light_view
from refcloud.lighting.literal_light import carried_literally

lesson = Lesson()
BALLS = rc.voxel_balls(rc.generate(seed=7, voxel=5.0 if lesson.quick else 3.0))
SUN = rc.Sun([-0.62, 0.62, 0.42])


def picture(
    *,
    drawn: Annotated[float, Range(0.0, 1.0)] = 0.4,
    sigma_t: Annotated[float, Range(0.0, 5.0, "1 / scene unit")] = 0.3,
    forward: Annotated[float, Range(0.0, 0.95)] = 0.7,
) -> Sheet:
    """Show the sun's framebuffer when a share of the balls is drawn.

    Parameters
    ----------
    drawn
        Which share; the ring is the area that the next ball reads back.
    sigma_t
        Extinction, which gives each ball its optical depth.
    forward
        Which share of the light that meets a ball is handed on.
    """
    side = lesson.size(360, 360)[0]
    view = light_view(BALLS, SUN.direction, side)
    tau = rc.metaballs.axis_depth(sigma_t, BALLS.densities, BALLS.radii)
    count = min(int(drawn * len(tau)), len(tau) - 1)
    look = rc.Look(forward=forward)
    first = replace(view, order=view.order[:count])
    _, buffer = carried_literally(first, tau, 1.0, look, forward)
    light = np.clip(buffer.pixels[..., :3], 0.0, 1.0) ** (1 / 2.2)
    if drawn < 1.0:
        k = view.order[count]
        pixels = np.arange(side) + 0.5
        away = np.hypot(pixels - view.x[k], pixels[:, None] - view.y[k])
        ring = np.clip(1.8 - np.abs(away - view.radius[k]), 0.0, 1.0)[..., None]
        light = light + ring * (np.array([0.95, 0.35, 0.05]) - light)
    return grey(light)


lesson.show(picture, "10-buffer", "The sun's framebuffer with 40 % of the balls drawn")

# %% [markdown]
# ## One formula
#
# Equation 27 of paper M. Ball `k` is reached by what the ball before it (in its way)
# scatters onward, `g`, and by what that one lets through:
#
# $$ I_k = g_{k-1} + T_{k-1} \, I_{k-1}, \qquad T = e^{-\tau} $$
#
# The blend of tutorial 09 computes it for every pixel at once; the readback averages
# over the ball. In plain Python:

# %%
from refcloud.plain import lighting as plain

lesson.source(plain.carry)

# %% [markdown]
# And in arrays: the loop over balls stays, since each needs those before it.

# %%
lesson.source(carried_literally)

# %% [markdown]
# ## The knob: how far the pass has come

# %%
lesson.strip(
    picture, "drawn", (0.05, 0.2, 0.4, 0.7, 1.0), "10-strip", "The pass, ball by ball"
)

# %% [markdown]
# What is it good for? Give every ball the full sun, and the cloud is a white cut-out.


# %%
def seen(lit: rc.LitMetaballs) -> rc.Picture:
    """Draw lit balls from the front."""
    width, height = lesson.size(320, 240)
    camera = rc.Camera([3, -4, 128], [3, 14, 0], width=width, height=height)
    return rc.render(lit, camera=camera, tolerance=lesson.tolerance(1 / 255))


lit = rc.sunward(BALLS, (SUN,), medium=rc.Medium(1.2), look="cumulus")
everywhere = replace(lit, light=np.broadcast_to(SUN.irradiance, lit.light.shape))
lesson.row(
    {"the full sun": lambda: seen(everywhere), "pass 1": lambda: seen(lit)},
    "10-light",
    "The same balls without pass 1 and with it",
    columns=2,
)

# %% [markdown]
# ## Where this breaks
#
# * **Light from nothing.** Equation 26 scatters `g = kappa tau I`. With the paper's
#   constants g + T passes 1 beyond tau = 9.3: every ball on the way makes light (E23).
#   The split rule, `g = exp(-(1-k) tau) - exp(-tau)`, cannot.
# * **Which area?** A disc, a square, or weighted by the footprint: three answers (E27).
#   At the buffer's edge a square reads outside; divide by what was really read.
# * **One direction.** Light goes straight on, away from the sun, and nowhere else. What
#   comes from the side is missing; tutorial 17 brings it.
#
# ## Exercises
#
# 1. What reaches a ball exactly behind another that hands on nothing?
# 2. Cut a ball into two of half the depth. Does what comes out behind stay the same?
# 3. From which depth on does equation 26 make light, with albedo 0.9?
#
# ## Solutions

# %%
from refcloud.optics import coupling_man2003, largest_steady_tau, scattered_split

# 1: the mean of exp(-tau w) over its disc: between exp(-tau) and 1, not exp(-tau).
two = rc.Metaballs([[0, 1.1, 0], [0, -1.1, 0]], [1.0, 1.0], [1.0, 1.0])
down = rc.Sun([0, 1, 0], [1, 1, 1])
dark = rc.Look(forward=0.0, readback="disc", sky_light=[0] * 3, ground_light=[0] * 3)
second = rc.sunward(two, (down,), medium=rc.Medium(2.0), look=dark).light[0, 1, 0]
assert np.exp(-2.0) < second < 1.0

# 2: yes with the split rule: T + g = exp(-(1-k) tau), and exponentials multiply.
both, half = (np.exp(-tau) + scattered_split(tau, 0.7) for tau in (3.0, 1.5))
assert abs(both - half**2) < 1e-15

# 3: at tau = 9.308 (E23).
assert abs(largest_steady_tau(coupling_man2003(0.9)) - 9.308) < 1e-3
