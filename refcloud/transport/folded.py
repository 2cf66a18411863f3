"""Sunlight that a backward peak turns round: a beam, and another against it.

A medium that scatters almost straight back (g near -1) sends most of what it takes out
of a beam back along the same line, from where it is turned again. Both beams together
have a closed form in optical depth, whatever the cloud along the line.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range
from refcloud.transport.sunlight import cell_mean


@checked
def folded_beams(
    tau: Annotated[Array, Range(0.0)],
    whole: Annotated[Array, Range(0.0)],
    own: Annotated[Array, Range(0.0)],
    *,
    turned: Annotated[float, Range(0.0, 1.0, open_upper=True)],
) -> tuple[Array, Array]:
    """Average two opposed beams over a voxel, each turned into the other.

    Formula: dU/dtau = -U + c D, dD/dtau = D - c U, U(0) = 1, D(whole) = 0; with
    k = sqrt(1 - c^2) and r = (1 - k) / (1 + k):
    U = (e^-k tau - r e^-k(2 whole - tau)) / (1 - r e^-2k whole),
    D = sqrt(r) (e^-k tau - e^-k(2 whole - tau)) / (1 - r e^-2k whole)

    Parameters
    ----------
    tau
        Optical depth from the sun to the voxel's centre.
    whole
        Of the whole line through the cloud, at least tau + own / 2.
    own
        Of the path through the voxel.
    turned
        c, the share of what a beam loses that goes on in the other.

    Returns
    -------
    The beam and the beam against it, of the broadcast shape.

    Source: an extension of paper M (multiple scattering, X09).

    Examples
    --------
    >>> [beam.round(4).tolist() for beam in folded_beams([1.0], [2], [0], turned=0.5)]
    [[0.4162], [0.093]]
    """
    k = np.sqrt((1.0 - turned) * (1.0 + turned))
    r = (1.0 - k) / (1.0 + k)
    on = cell_mean(k * tau, k * own)
    back = cell_mean(k * np.maximum(2.0 * whole - tau, tau), k * own)
    left = 1.0 - r * np.exp(-2.0 * k * whole)
    return (on - r * back) / left, np.sqrt(r) * (on - back) / left


def passed_and_returned(whole: Array, turned: float) -> tuple[Array, Array]:
    """Give what leaves a line at its far end, and at the near one, unchecked."""
    k = np.sqrt((1.0 - turned) * (1.0 + turned))
    r = (1.0 - k) / (1.0 + k)
    fade = np.exp(-k * whole)
    left = 1.0 - r * fade * fade
    return (1.0 - r) * fade / left, np.sqrt(r) * (1.0 - fade * fade) / left
