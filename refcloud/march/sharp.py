"""Clouds too sharp for slabs: the quadrature toward the eye, with what light allows."""

from __future__ import annotations

from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Observer, Skipped
from refcloud.march.certificate import Certificate, Found
from refcloud.march.shafted import SHAFTINGS, Shafting, shafted, shafts_of

FEWER = (2, 3)  # Gauss points of a piece, that may do where light is exact


def by_quadrature(
    certificate: Certificate, cloud: VoxelGrid, least: float, watch: Observer
) -> tuple[Found, tuple[Skipped, ...], tuple[str, ...]]:
    """Integrate all rays as cheaply as checked ones allow.

    Parameters
    ----------
    certificate
        Of the rays; the quadrature is what they are held against.
    cloud
        The cloud map, cut down to what is occupied.
    least
        Transmittance behind which nothing need be looked for.
    watch
        Called with ("errors of shafts", errors by setting).

    Returns
    -------
    Radiance and columns of density, and what is told.
    """
    task, count = certificate.task, len(certificate.task.origins)
    # 1. Light from leaning lattices.
    tried: dict[Shafting, float] = {}
    tables, finer = None, 0
    for way in SHAFTINGS:
        if way.finer != finer:
            tables, finer = shafts_of(task, cloud, way.finer), way.finer
        if tables is None:
            break
        tried[way] = certificate.error(
            shafted(certificate.some, tables, way.points, least)
        )
        if not certificate.holds(tried[way]):
            continue
        found = shafted(task, tables, way.points, least)
        bound = certificate.bound(tried[way], found)
        if bound <= certificate.tolerance:
            row = Skipped(
                "march",
                "exact columns to the suns",
                count,
                count,
                bound,
                how="certified",
            )
            note = (
                f"march: quadrature, {way.finer} samples of light per cell along the"
                f" suns' rays, {way.points} Gauss points; off by {tried[way]:.2g} at"
                f" most on {len(certificate.sample)} checked rays"
            )
            watch("errors of shafts", tried)
            return found, (row,), (note,)
    watch("errors of shafts", tried)
    # 2. Exact light, at as few points of a piece as do.
    note = "march: exact light at {} Gauss points, since no saving held"
    for fewer in FEWER:
        error = certificate.error(certificate.some.exact(least, fewer))
        if not certificate.holds(error):
            continue
        found = task.exact(least, fewer)
        bound = certificate.bound(error, found)
        if bound <= certificate.tolerance:
            what = "Gauss points of a piece"
            row = Skipped("march", what, 4 - fewer, 4, bound, how="certified")
            return found, (row,), (note.format(fewer),)
    return task.exact(least), (), (note.format(4),)
