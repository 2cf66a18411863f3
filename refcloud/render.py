"""One door to the renderers: any cloud, or a named scene, to a picture."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Literal

import numpy as np

from refcloud.camera import Camera, OrthographicCamera, refuse_large
from refcloud.checking import checked, complaint
from refcloud.choices import (
    AMBIENT,
    default_medium,
    default_sun,
    framed,
    size_of,
)
from refcloud.cloudmap import VoxelGrid
from refcloud.compose import Layer, draw_layers, idle_seed, passes_of
from refcloud.conventions import (
    MOST_PIXELS,
    Array,
    Backend,
    Colour,
    Observer,
    Range,
    Seed,
    Shape,
    Tolerance,
)
from refcloud.image import Picture
from refcloud.lighting import Haze, LitMetaballs, Look, named
from refcloud.lighting.ends import refuse_extreme
from refcloud.lighting.look import LookName
from refcloud.lighting.solved import brought_by
from refcloud.march import Mixing
from refcloud.march.multiple import Scattering
from refcloud.march_picture import draw_march
from refcloud.metaballs import Metaballs, voxel_balls
from refcloud.optics import Medium, Sun
from refcloud.refusal import counted, refuse_beside
from refcloud.scene import Scene, View, find_scene
from refcloud.sky import Sky
from refcloud.transport import LightVolume

Side = Annotated[int, Range(1, MOST_PIXELS, "pixels")]
Quality = Literal["quick", "final"]
Method = Literal["splat", "march"]

# Parameters that only splats have a use for; the other optional ones are the march's.
ONLY_SPLATS = ("look", "backend")


@checked
def render(
    cloud: Metaballs | LitMetaballs | VoxelGrid | Scene | str,
    *,
    camera: Camera | OrthographicCamera | None = None,
    width: Side | None = None,
    height: Side | None = None,
    suns: Sun | tuple[Sun, ...] | None = None,
    medium: Medium | None = None,
    background: Sky
    | Literal["transparent"]
    | Colour
    | Annotated[Array, Shape("H", "W", 3), Range(0.0)]
    | None = None,
    haze: Haze | None = None,
    look: Look | LookName | None = None,
    method: Method | None = None,
    scattering: Scattering | None = None,
    ambient: Colour | None = None,
    mixing: Mixing | None = None,
    tolerance: Tolerance = 0.0,
    volumes: tuple[LightVolume, ...] = (),
    quality: Quality = "final",
    seed: Seed = 0,
    observe: Observer | None = None,
    backend: Backend = "numpy",
) -> Picture:
    """Render metaballs, a cloud map or a named scene.

    Formula: pass 1 (eq 27) for each sun, then pass 2 (eq 29) over the background; or
    the integral of `refcloud.march.integrate` for every pixel

    Parameters
    ----------
    cloud
        Metaballs; balls with their light, of `sunward`, which is then not carried again
        and brings suns, medium and look; a cloud map; a scene or its name.
    camera
        The eye; None frames the cloud, or takes the scene's own.
    width, height
        Size where no camera is given, pixels; by quality 320 x 240 or 1024 x 768. One
        alone keeps that shape, 4 to 3; a camera has its own. At most 8.3 megapixels.
    suns
        The lights, one or several; None for one from the front left, weaker for light
        that is solved.
    medium
        What the cloud is made of; None sets sigma_t so that the optical depth through
        the cloud's middle is 40, or 16 where it is marched.
    background
        A sky, one colour, or "transparent"; None for the default sky. Or a picture of
        the camera's size, shape (H, W, 3). Scenes bring their own.
    haze
        Air in front of the cloud; None for none. Scenes bring their own.
    look
        Rules of splatted light, "cumulus" or "man"; None for "cumulus", or the scene's
        own.
    method
        "splat" draws balls in two passes, a cloud map as one ball per occupied voxel;
        "march" follows rays. None splats metaballs and marches cloud maps.
    scattering
        How often light is scattered: "single" is once along marched rays, and once from
        ball to ball for splats; "multiple" is every order, solved first. Or that light,
        which an earlier call handed to its `observe` as "scattered light", for another
        eye: it brings suns and medium. None for "single", or the scene's own.
    ambient
        Radiance that reaches a marched cloud from all sides alike, RGB; None for the
        mean of a clear sky and the ground.
    mixing
        Factors on marched light without a counterpart in physics; None for none.
    tolerance
        Largest error of a channel that savings may make; 0 is exact.
    volumes
        Light volumes that an earlier call handed to its `observe` as "light volumes":
        those of this cloud and these suns are not made again. Tolerance 0 has no use
        for them. Only for marched cloud maps.
    quality
        Which size a scene has by default.
    seed
        Chooses the noise that erodes footprints.
    observe
        Called with (name, value) for each intermediate.
    backend
        What runs the two passes: "numpy", or "gl" for OpenGL in float32, through
        moderngl.

    Returns
    -------
    The picture, with what was skipped, chosen, and the time of each stage.

    Raises
    ------
    ValueError
        No scene has that name; the picture is over 8.3 megapixels, or the camera's
        size is another; the backend is missing.

    Source: paper M, section 4 (W03); document D (R02).
    """
    if isinstance(suns, Sun):
        suns = (suns,)
    width, height = size_of(width, height, quality, camera)
    if isinstance(cloud, (Scene, str)):
        scene = find_scene(cloud) if isinstance(cloud, str) else cloud
        refuse_large(width, height)  # before the clouds are made
        passes_of(backend)  # refuses a missing one, likewise
        refuse_beside(
            "a scene's name, which brings its own",
            background=background,
            haze=haze,
            method=method,
            ambient=ambient,
            mixing=mixing,
            volumes=volumes or None,
        )
        if not (scattering is None or isinstance(scattering, str)):
            expected = "single or multiple beside a scene"
            raise ValueError(complaint("scattering", expected, "solved light"))
        if scattering is not None and "scattering" not in scene.uses:
            expected = f"none beside {scene.name}, whose light is not solved"
            raise ValueError(complaint("scattering", expected, scattering))
        how = tolerance, seed, observe, backend, scattering
        view = View(width, height, camera, suns, medium, look, *how)
        model = scene.model()
        picture = scene.draw(model, view)
        return dataclasses.replace(
            picture,
            skipped=model.skipped + picture.skipped,
            seconds={**model.seconds, **picture.seconds},
            notes=(
                *model.notes,
                *picture.notes,
                *(idle_seed(seed) if "seed" not in scene.uses else ()),
            ),
        )
    notes: list[str] = []
    lit = None
    if isinstance(cloud, LitMetaballs):
        whose = "lit balls, which bring their own"
        refuse_beside(
            whose,
            suns=suns,
            medium=medium,
            look=look,
            method=method,
            scattering=scattering,
        )
        lit, suns, medium, look = cloud, cloud.suns, cloud.medium, cloud.look
        cloud = lit.balls
    march = is_marched(cloud, method)
    _refuse_idle(
        march,
        look=look,
        backend=None if backend == "numpy" else backend,
        ambient=ambient,
        mixing=mixing,
        volumes=volumes or None,
    )
    passes_of(backend)  # refuses a missing one before any work
    scattering = "single" if scattering is None else scattering
    if not isinstance(scattering, str):
        suns, medium = brought_by(scattering, suns, medium)
    refuse_extreme(cloud, suns or (), medium, camera)
    drawn = as_drawn(cloud, method)
    if drawn is not cloud and isinstance(drawn, Metaballs):
        count = counted(len(drawn), "ball")
        notes.append(f"drawn as one ball per occupied voxel: {count}")
    rules = None if march else named(look or "cumulus")
    if medium is None:
        medium, note = default_medium(drawn, rules)
        notes.append(note)
    if camera is None:
        camera = framed(drawn, width, height)
        # Far from the origin an eye and its target share their first digits.
        near = np.linalg.norm(camera.eye - camera.target)
        far = max(np.abs([camera.eye, camera.target]).max() / near, 1.0)
        eye, target = (
            " ".join(f"{x:.{4 + int(np.log10(far))}g}" for x in place)
            for place in (camera.eye, camera.target)
        )
        notes.append(f"camera: eye {eye}, target {target}")
    behind = Sky() if background is None else background
    if suns is None:
        sun, note = default_sun(scattering)
        suns, notes = (sun,), [*notes, note] if note else notes
    if march:
        picture = draw_march(
            drawn,
            camera,
            suns,
            behind,
            medium=medium,
            haze=haze,
            ambient=AMBIENT if ambient is None else ambient,
            mixing=mixing,
            scattering=scattering,
            tolerance=tolerance,
            volumes=volumes,
            observe=observe,
        )
        notes += idle_seed(seed)
    else:
        assert isinstance(drawn, Metaballs)
        assert rules is not None
        picture = draw_layers(
            [Layer(drawn, medium, rules, haze, lit, scattering)],
            camera,
            suns,
            behind,
            tolerance=tolerance,
            seed=seed,
            observe=observe,
            backend=backend,
        )
    return dataclasses.replace(picture, notes=(*notes, *picture.notes))


def is_marched(cloud: Metaballs | VoxelGrid, method: Method | None) -> bool:
    """Tell whether a cloud is marched, or drawn in two passes."""
    return isinstance(cloud, VoxelGrid) if method is None else method == "march"


def as_drawn(
    cloud: Metaballs | VoxelGrid, method: Method | None
) -> Metaballs | VoxelGrid:
    """Give what a method draws: a cloud map that is splatted becomes balls."""
    if isinstance(cloud, VoxelGrid) and method == "splat":
        return voxel_balls(cloud)
    return cloud


def _refuse_idle(march: bool, **given: object) -> None:
    """Refuse what the chosen method has no use for."""
    for name, value in given.items():
        if value is not None and (name in ONLY_SPLATS) == march:
            method, other = ("march", "splat") if march else ("splat", "march")
            expected = f"none beside the method {method}"
            advice = f"choose method {other}, or leave {name} out"
            raise ValueError(complaint(name, expected, "one", advice))
