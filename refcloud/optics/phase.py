"""Phase functions: how much light a particle sends into each direction.

``cos_theta`` is the cosine between the direction the light travels and the direction
it leaves in: forward is +1. They integrate to 1 over the sphere; the paper's own form,
whose mean over the sphere is 1, stands beside them (E20).
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import WHOLE_SPHERE, Array, Range
from refcloud.optics.media import Medium


@checked
def isotropic(cos_theta: Annotated[Array, Range(-1.0, 1.0)]) -> Array:
    """Scatter the same into every direction.

    Formula: 1 / (4 pi)

    Parameters
    ----------
    cos_theta
        Any shape, in [-1, 1].

    Returns
    -------
    The same shape, 1 / steradian.

    Source: paper M, section 4.2 ("constant 1"), over 4 pi.

    Examples
    --------
    >>> float(isotropic([0.3])[0] * WHOLE_SPHERE)
    1.0
    """
    return np.full(np.shape(cos_theta), 1.0 / WHOLE_SPHERE)


@checked
def rayleigh(cos_theta: Annotated[Array, Range(-1.0, 1.0)]) -> Array:
    """Scatter as particles far smaller than the wavelength do.

    Formula: 3 / (16 pi) (1 + cos_theta^2)

    Parameters
    ----------
    cos_theta
        Any shape, in [-1, 1].

    Returns
    -------
    The same shape, 1 / steradian.

    Source: paper M, eq 25 over 4 pi; E20.

    Examples
    --------
    >>> bool(rayleigh([1.0])[0] == 2 * rayleigh([0.0])[0])
    True
    """
    return rayleigh_man2003(cos_theta) / WHOLE_SPHERE


@checked
def rayleigh_man2003(cos_theta: Annotated[Array, Range(-1.0, 1.0)]) -> Array:
    """Give Rayleigh's phase function with mean 1 over the sphere, as the paper does.

    Formula: p = 3/4 (1 + cos_theta^2)

    Parameters
    ----------
    cos_theta
        Any shape, in [-1, 1].

    Returns
    -------
    The same shape, relative to isotropic.

    Source: paper M, eq 25; E20, E21.

    Examples
    --------
    >>> rayleigh_man2003([-1.0, 0.0, 1.0])
    array([1.5 , 0.75, 1.5 ])
    """
    return 0.75 * (1.0 + np.square(cos_theta))


@checked
def henyey_greenstein(
    cos_theta: Annotated[Array, Range(-1.0, 1.0)],
    g: Annotated[float, Range(-1.0, 1.0, open_lower=True, open_upper=True)],
) -> Array:
    """Scatter mostly forward (g > 0) or backward (g < 0), with mean cosine g.

    Formula: (1 - g^2) / (4 pi ((1 - |g|)^2 + 2 |g| (1 - sign(g) cos_theta))^(3/2)),
    which is the usual form written so that nothing cancels near |g| = 1.

    Parameters
    ----------
    cos_theta
        Any shape, in [-1, 1].
    g
        Mean cosine, in (-1, 1).

    Returns
    -------
    The same shape, 1 / steradian.

    Source: document D names it (R04); E20, E36.

    Examples
    --------
    >>> bool(henyey_greenstein([1.0], 0.6)[0] > henyey_greenstein([-1.0], 0.6)[0])
    True
    """
    toward = np.asarray(cos_theta) if g >= 0.0 else -np.asarray(cos_theta)
    return lobe_of(1.0 - toward, abs(g))


def lobe_of(versed: Array, size: float) -> Array:
    """Evaluate a forward lobe from 1 - cos_theta, unchecked.

    Parameters
    ----------
    versed
        1 - cos_theta, any shape; of a backward lobe 1 + cos_theta.
    size
        |g|, in [0, 1).

    Returns
    -------
    The same shape, 1 / steradian.
    """
    spread = (1.0 - size) ** 2 + 2.0 * size * versed
    return (1.0 - size) * (1.0 + size) / (WHOLE_SPHERE * spread * np.sqrt(spread))


@checked
def phase(medium: Medium, cos_theta: Annotated[Array, Range(-1.0, 1.0)]) -> Array:
    """Evaluate a medium's phase function.

    Formula: that of `isotropic`, `rayleigh` or `henyey_greenstein`, by name

    Parameters
    ----------
    medium
        Holds the name, and g.
    cos_theta
        Any shape, in [-1, 1].

    Returns
    -------
    The same shape, 1 / steradian.

    Source: paper M, eq 25 and section 4.2 (L11).
    """
    if medium.phase == "hg":
        return henyey_greenstein(cos_theta, medium.g)
    return rayleigh(cos_theta) if medium.phase == "rayleigh" else isotropic(cos_theta)
