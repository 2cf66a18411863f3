"""Refusing scenes whose numbers leave no room for their products."""

from __future__ import annotations

import numpy as np

from refcloud.camera import AnyCamera, OrthographicCamera
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.extremes import refuse_bright, refuse_deep, refuse_far, refuse_small
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun


def refuse_extreme(
    cloud: Metaballs | VoxelGrid,
    suns: tuple[Sun, ...] = (),
    medium: Medium | None = None,
    camera: AnyCamera | None = None,
) -> None:
    """Refuse clouds, suns, media and eyes beyond the ends of scenes.

    Parameters
    ----------
    cloud, suns, medium, camera
        Of the scene; None for what is still to be chosen.

    Raises
    ------
    ValueError
        A length, a light or an optical depth is beyond `refcloud.extremes`.
    """
    if isinstance(cloud, VoxelGrid):
        refuse_far("cloud", [cloud.lower, cloud.upper])
        refuse_small("cloud", cell_size(cloud))
        refuse_deep("cloud", float(cloud.density.max()), cell_size(cloud).max() ** 3)
    else:
        refuse_far("cloud", cloud.centers)
        refuse_far("cloud", cloud.radii)
        refuse_small("cloud", cloud.radii)
        with np.errstate(over="ignore"):
            columns = cloud.densities * cloud.radii
            mass = columns * cloud.radii**2
        refuse_deep("cloud", 1.0, mass)
        if medium is not None:
            refuse_deep("sigma_t", float(np.max(medium.sigma_t)), columns)
    for sun in suns:
        refuse_bright("suns", sun.irradiance)
    if camera is not None:
        refuse_extreme_eye(camera)


def refuse_extreme_eye(camera: AnyCamera) -> None:
    """Refuse an eye beyond the ends of scenes, as `refuse_extreme`."""
    refuse_far("camera", [camera.eye, camera.target])
    if isinstance(camera, OrthographicCamera):
        refuse_far("camera", camera.height_of_view)
        refuse_small("camera", camera.height_of_view)
