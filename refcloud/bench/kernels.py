"""Kernels and footprints: ways to what a ball covers of a pixel, against closed forms.

A footprint is the integral of a ball's density along the line of sight, 1 on the axis
(E04). The paper takes the density in the plane instead, and textures of so many texels;
a sum over samples of the chord is what anyone would write first.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from refcloud.bench.subject import NS, Subject
from refcloud.bench.timing import Contender
from refcloud.conventions import Array
from refcloud.metaballs.kernels import Kernel, profile
from refcloud.raster import footprint

TEXELS = (32, 128, 512)  # of a texture along its radius; the paper's time had 32
SAMPLES = (4, 16, 64)  # of a chord
BOTH: tuple[Kernel, ...] = ("wyvill", "gaussian")


def squares(count: int) -> Array:
    """Give squared distances from the axis, in radii squared, in [0, 1]."""
    return np.square((np.arange(count) + 0.5) / count)


def summed(q: Array, kernel: Kernel, samples: int) -> Array:
    """Add up the density in the middles of even stretches of a chord."""
    half = np.sqrt(1.0 - q)
    found = np.zeros_like(q)
    whole = 0.0  # of the chord through the centre
    for k in range(samples):
        t = (k + 0.5) / samples
        found += profile(q + np.square(t * half), kernel)
        whole += float(profile(np.array([t * t]), kernel)[0])
    return found * half / whole


def looked_up(q: Array, kernel: Kernel, texels: int, linear: bool, codes: int) -> Array:
    """Read a texture of the footprint along the radius, as a graphics card does.

    Parameters
    ----------
    q
        Squared distances, shape (N,).
    kernel
        The density.
    texels
        How many, their values in their middles.
    linear
        Whether two are mixed, or the nearest is taken.
    codes
        Steps of a texel's value; 0 for none.

    Returns
    -------
    Shape (N,).
    """
    middles = np.square((np.arange(texels) + 0.5) / texels)
    texture = footprint(middles, kernel=kernel)
    if codes:
        texture = np.rint(texture * codes) / codes
    at = np.sqrt(q) * texels - 0.5
    if not linear:
        return texture[np.clip(np.rint(at).astype(np.int64), 0, texels - 1)]
    first = np.floor(at).astype(np.int64)
    share = at - first
    low, high = (np.clip(first + k, 0, texels - 1) for k in (0, 1))
    return (1.0 - share) * texture[low] + share * texture[high]


def footprints(count: int) -> list[Contender]:
    """List the ways to the footprints of both kernels."""
    q = squares(count)
    found = []
    for kernel in BOTH:
        exact = functools.cache(functools.partial(footprint, q, kernel=kernel))
        ways: dict[str, Callable[[], Array]] = {
            "closed form": functools.partial(footprint, q, kernel=kernel),
            "the plane's density": functools.partial(
                footprint, q, kernel=kernel, name="profile"
            ),
        }
        for samples in SAMPLES:
            ways[f"sum of {samples}"] = functools.partial(summed, q, kernel, samples)
        for texels in TEXELS:
            read = functools.partial(looked_up, q, kernel, texels)
            ways[f"{texels} texels, nearest"] = functools.partial(read, False, 0)
            ways[f"{texels} texels, linear"] = functools.partial(read, True, 0)
        ways["32 texels of 8 bits, linear"] = functools.partial(
            looked_up, q, kernel, 32, True, 255
        )
        found += [
            Contender(f"{kernel} footprint", name, count, work, exact)
            for name, work in ways.items()
        ]
    return found


KERNELS = Subject(
    name="kernels",
    title="footprints of balls: closed forms, sums, textures",
    about="CPU time per pixel, medians; error: largest distance of a weight in [0, 1]",
    lists=((footprints, 200_000, 2_000),),
    unit=NS,
    digits=2,
    reference="the closed form, 1e-15 from its plain twin",
)
