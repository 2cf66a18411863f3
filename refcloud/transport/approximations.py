"""Cheap stand-ins for multiple scattering, by name: what sunlight is made to be.

None of them carries light sideways or back; `refcloud.scattering_pictures` shows what
each is off. The octaves of Wrenninge 2013 stand in `refcloud.lighting`, diffusion in
`refcloud.transport.diffusion`.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range
from refcloud.optics.extinction import held_share, largest_steady_tau


@checked
def beer_powder(tau: Annotated[Array, Range(0.0)]) -> Array:
    """Dim sunlight as games do: dark where the light has just come in, too.

    Formula: 2 exp(-tau) (1 - exp(-2 tau))

    Parameters
    ----------
    tau
        Optical depth to the sun, any shape.

    Returns
    -------
    The same shape, in [0, 0.77].

    Source: an extension of document D (R05), after Schneider, "The Real-Time
    Volumetric Cloudscapes of Horizon: Zero Dawn", 2015.

    Examples
    --------
    >>> beer_powder([0.0, 1.0]).round(4)
    array([0.    , 0.6362])
    """
    tau = np.asarray(tau)
    return 2.0 * np.exp(-tau) * -np.expm1(-2.0 * tau)


@checked
def forward_depth(
    tau: Annotated[Array, Range(0.0)], *, kappa: Annotated[float, Range(0.0, 1.0)]
) -> Array:
    """Give the depth that a voxel seems to have where it hands light on.

    Formula: -ln(exp(-tau) + min(kappa tau, 1 - exp(-tau))): the recurrence of eq 27,
    I_k = g_{k-1} + T_{k-1} I_{k-1}, voxel after voxel, is Beer's law with these depths

    Parameters
    ----------
    tau
        Optical depth of the path through each voxel, any shape.
    kappa
        The coupling of eq 26, in [0, 1].

    Returns
    -------
    The same shape, in [0, tau].

    Source: paper M, eq 26 and 27 (L04); E22, E23.

    Examples
    --------
    >>> bool(forward_depth([1.0], kappa=0.1) < 1.0)
    True
    """
    tau = np.asarray(tau)
    if kappa == 0.0:
        return np.array(tau)
    share = held_share(tau, kappa, largest_steady_tau(kappa))
    # Two forms of one sum: thin voxels keep their digits, thick ones do not overflow.
    thin = np.minimum(tau, 1.0)
    near = tau - np.log1p(np.minimum(share, 1.0) * np.exp(thin))
    far = -np.log(np.maximum(np.exp(-tau) + share, np.exp(-700.0)))
    return np.clip(np.where(tau < 1.0, near, far), 0.0, tau)
