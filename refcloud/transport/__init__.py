"""Light inside a voxel grid: what it meets on its way to the sun."""

from refcloud.transport.column import column_density
from refcloud.transport.sun import LightVolume, sun_depths

__all__ = ["LightVolume", "column_density", "sun_depths"]
