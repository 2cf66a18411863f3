"""Light inside a voxel grid: on its way to the sun, and scattered many times."""

from refcloud.transport.approximations import beer_powder, forward_depth
from refcloud.transport.column import column_density
from refcloud.transport.delta_m import (
    ScaledMedium,
    delta_m,
    legendre_moments,
    smooth_phase,
)
from refcloud.transport.diffusion import Diffused, diffuse_source, diffused_light
from refcloud.transport.directions import Directions, sphere_directions
from refcloud.transport.folded import folded_beams
from refcloud.transport.harmonics import harmonics
from refcloud.transport.paths import PathEstimate, trace_paths
from refcloud.transport.plans import PLANS, Plan, Stage
from refcloud.transport.scattering import (
    ScatteredLight,
    scattered_light,
    source_toward,
)
from refcloud.transport.sun import LightVolume, sun_depths
from refcloud.transport.sunlight import cell_mean, intercepted
from refcloud.transport.sweep import sweep

__all__ = [
    "PLANS",
    "Diffused",
    "Directions",
    "LightVolume",
    "PathEstimate",
    "Plan",
    "ScaledMedium",
    "ScatteredLight",
    "Stage",
    "beer_powder",
    "cell_mean",
    "column_density",
    "delta_m",
    "diffuse_source",
    "diffused_light",
    "folded_beams",
    "forward_depth",
    "harmonics",
    "intercepted",
    "legendre_moments",
    "scattered_light",
    "smooth_phase",
    "source_toward",
    "sphere_directions",
    "sun_depths",
    "sweep",
    "trace_paths",
]
