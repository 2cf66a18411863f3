"""What stands behind the clouds, and skies whose clouds are textures on surfaces."""

from refcloud.sky.cover import SAME_SIGN, Cover, cloud_cover
from refcloud.sky.displaced import Displacement, displaced_sphere
from refcloud.sky.flat_base import FlatBase, base_density, light_from_above
from refcloud.sky.fog import fog_factor, fogged
from refcloud.sky.fractal import fractal_texture, fractal_volume, looked_up
from refcloud.sky.gradient import Sky, clear_sky, printed_gradient, sky_gradient
from refcloud.sky.meshes import surface_mesh
from refcloud.sky.places import Places, places
from refcloud.sky.puff import Puff, puff_density
from refcloud.sky.shaded import Fog, shaded
from refcloud.sky.surfaces import (
    Dome,
    Plane,
    Sphere,
    dome_coordinates,
    dome_points,
    plane_coordinates,
    sphere_coordinates,
    sphere_points,
)

__all__ = [
    "SAME_SIGN",
    "Cover",
    "Displacement",
    "Dome",
    "FlatBase",
    "Fog",
    "Places",
    "Plane",
    "Puff",
    "Sky",
    "Sphere",
    "base_density",
    "clear_sky",
    "cloud_cover",
    "displaced_sphere",
    "dome_coordinates",
    "dome_points",
    "fog_factor",
    "fogged",
    "fractal_texture",
    "fractal_volume",
    "light_from_above",
    "looked_up",
    "places",
    "plane_coordinates",
    "printed_gradient",
    "puff_density",
    "shaded",
    "sky_gradient",
    "sphere_coordinates",
    "sphere_points",
    "surface_mesh",
]
