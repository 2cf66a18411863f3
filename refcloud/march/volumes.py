"""Light volumes of one march: those that the caller kept, or made where none holds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from refcloud.cloudmap import VoxelGrid
from refcloud.march.cells import cropped
from refcloud.optics import Sun
from refcloud.transport import LightVolume, sun_depths
from refcloud.transport.sun import Scale, kept_volume


@dataclass(frozen=True)
class Volumes:
    """Light volumes of a cloud and its suns, at any scale that is asked for.

    Attributes
    ----------
    cloud
        What they are of: the cloud map, cut down to what is occupied.
    suns
        The lights.
    kept
        Of earlier calls.
    used
        What this march took or made so far, by scale and sun.
    """

    cloud: VoxelGrid
    suns: tuple[Sun, ...]
    kept: tuple[LightVolume, ...]
    used: dict[tuple[Scale, int], LightVolume] = field(default_factory=dict)

    def at(self, scale: Scale) -> list[LightVolume]:
        """Give the light volume of each sun, in single precision."""
        for number, sun in enumerate(self.suns):
            if (scale, number) not in self.used:
                held = kept_volume(self.kept, self.cloud, sun.direction, scale)
                if held is None:
                    held = sun_depths(
                        self.cloud, sun.direction, scale=scale, dtype="float32"
                    )
                self.used[scale, number] = held
        return [self.used[scale, number] for number in range(len(self.suns))]

    @property
    def all(self) -> tuple[LightVolume, ...]:
        """List what was used, for a later call to keep."""
        return tuple(self.used.values())

    def notes(self) -> tuple[str, ...]:
        """Tell for how many suns no light volume had to be made."""
        if not self.kept or not self.used:
            return ()
        made = {n for (_, n), v in self.used.items() if not _one_of(v, self.kept)}
        count = len(self.suns)
        return (f"light volume: reused for {count - len(made)} of {count} suns",)


def volumes_of(
    cloud: VoxelGrid, suns: tuple[Sun, ...], kept: tuple[LightVolume, ...]
) -> Volumes:
    """Prepare the light volumes of a cloud map.

    Parameters
    ----------
    cloud
        The cloud map.
    suns
        The lights.
    kept
        Light volumes of earlier calls: of this cloud or another, in any order. Those in
        double precision are left aside, so that the picture is the same without them.
    """
    inner = cropped(cloud)
    kept = tuple(v for v in kept if v.density.dtype == np.float32)
    # Grids are told apart as objects; the cut-down one is made anew by every call.
    for volume in kept:
        if volume.grid is not inner and _same(volume.grid, inner):
            inner = volume.grid
            break
    return Volumes(inner, suns, kept)


def _one_of(volume: LightVolume, volumes: Iterable[LightVolume]) -> bool:
    return any(volume is other for other in volumes)


def _same(a: VoxelGrid, b: VoxelGrid) -> bool:
    return (
        np.array_equal(a.lower, b.lower)
        and np.array_equal(a.upper, b.upper)
        and np.array_equal(a.density, b.density)
    )
