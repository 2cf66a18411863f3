"""Clouds that the page builds from their parameters, stage by stage."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from refcloud.choices import AMBIENT, SUN
from refcloud.cloudmap import box_cloud, generate
from refcloud.cloudmap.generate import BY_SHAPE
from refcloud.compose import LIGHT
from refcloud.lighting import Haze, Look, Octaves, sunward
from refcloud.march import Mixing
from refcloud.metaballs import approximate
from refcloud.optics import TAU_MAN2003, Medium
from refcloud.render import render
from refcloud.scenes import cumulus, demand
from refcloud.sky import Sky
from refcloud.studio.box import Box, box_picture
from refcloud.studio.glimpse import glimpse
from refcloud.studio.knobs import group_of
from refcloud.studio.noise import NOISE
from refcloud.studio.recipe import Call, Name, Recipe, Stage
from refcloud.studio.setups import (
    FILE,
    ROUGH,
    TOLERANCE,
    Frame,
    Setup,
    Values,
    by_key,
    camera_call,
    camera_group,
    differing,
    medium_group,
    saving,
    second_sun,
    sun_group,
    suns_of,
    written_as,
)

# Coarse frames: fewer balls, coarser voxels, small buffers, smooth edges.
COARSE_BALLS, COARSE_VOXEL, COARSE_CELLS = 300, 1.8, 24.0
COARSE_LOOK = {"erosion": 0.0, "relief": 0.0, "buffer": 64, "sky_buffer": 32}
COARSE_SAMPLES = 96
# Nearer than the scene `cumulus`, since nothing stands beside the cloud.
EYE = {"eye": np.array([0.0, -12.0, 104.0]), "target": np.array([1.0, 15.0, 0.0])}
HAZE = {"color": cumulus.HAZE, "length": cumulus.OWN.hero.air}

GENERATE = group_of(
    "generate",
    "Noise to cloud map",
    generate,
    start={"seed": 12},
    near={
        "diameters": np.array(BY_SHAPE["cumulus"][0]),
        "voxel": BY_SHAPE["cumulus"][1],
        "cell": BY_SHAPE["cumulus"][2],
    },
)
SKY = group_of("sky", "Sky", Sky)
AIR = group_of("haze", "Air", Haze, start=HAZE, may_be_off=True, on=False)


def _quality(source: Any, **how: Any) -> Any:
    return group_of("quality", "Time against error", source, **how)


SPLAT_GROUPS = (
    GENERATE,
    group_of(
        "approximate",
        "Cloud map to metaballs",
        approximate,
        start={"count": 1000},
        near={"tolerance": 0.3, "overlap": 2.2, "rim": 6.0, "refine_steps": 5},
    ),
    sun_group(SUN),
    second_sun(),
    medium_group(cumulus.OWN.single_medium),
    group_of("look", "Rules of light", Look, near={"tau": TAU_MAN2003}),
    camera_group(EYE),
    SKY,
    AIR,
    _quality(
        render, alone=("tolerance", "seed", "backend"), start={"tolerance": TOLERANCE}
    ),
    FILE,
)
MARCH_GROUPS = (
    dataclasses.replace(GENERATE, start={**GENERATE.start, "voxel": 2.0}),
    sun_group(SUN),
    second_sun(),
    medium_group(Medium(0.4, g=0.6, phase="hg")),
    group_of("mixing", "How marched light mixes", Mixing),
    camera_group(EYE),
    SKY,
    _quality(
        render,
        alone=("scattering", "ambient", "tolerance"),
        start={"tolerance": ROUGH},  # of sharp cloud maps 1/255 takes many seconds
        near={"ambient": AMBIENT},
    ),
    FILE,
)
BOX_GROUPS = (
    group_of("box", "Box: size and place of the cloud", Box),
    group_of(
        "texture",
        "Noise in the box: scale, voxels",
        box_cloud,
        without=("first", "second"),
        start={**vars(demand.OWN.cloud), "voxel": 0.03},
    ),
    sun_group(demand.OWN.sun),
    second_sun(),
    medium_group(demand.OWN.medium),
    group_of("octaves", "Light model", Octaves, start={"orders": 1}),
    camera_group(
        {
            "eye": demand.OWN.eye,
            "target": demand.OWN.target,
            "fov_y": demand.OWN.fov_y,
        }
    ),
    _quality(box_picture, start={"tolerance": TOLERANCE}),
    FILE,
)


def splatted(values: Values, frame: Frame) -> Recipe:
    """Write noise to cloud map, metaballs, pass 1, pass 2 (paper M)."""
    groups = by_key(SPLAT_GROUPS)
    cloud = cloud_stage(differing(GENERATE, values["generate"] or {}))
    chosen = differing(groups["approximate"], values["approximate"] or {})
    if chosen.get("tolerance") is not None:
        chosen.pop("count", None)  # one of them is given
    balls = Call("rc.approximate", approximate, (Name("cloud"),), chosen)
    count = min(chosen.get("count") or COARSE_BALLS, COARSE_BALLS)
    few = balls.but(count=count, method="quick")
    few = dataclasses.replace(
        few, keywords={k: v for k, v in few.keywords.items() if k != "tolerance"}
    )
    quality = differing(groups["quality"], values["quality"] or {})
    tolerance = quality.get("tolerance", 0.0)
    look = written_as("rc.Look", Look, groups, values, "look")
    lit = Call(
        "rc.sunward",
        sunward,
        (Name("balls"), suns_of(groups, values)),
        {
            "medium": written_as("rc.Medium", Medium, groups, values, "medium"),
            "look": look,
            "tolerance": LIGHT * tolerance,
        },
    )
    rough = lit.but(look=look.but(**coarse_look(values)), tolerance=LIGHT * ROUGH)
    drawn: dict[str, Any] = {
        "camera": camera_call(groups, values, frame),
        "background": written_as("rc.Sky", Sky, groups, values, "sky"),
    }
    if values["haze"] is not None:
        drawn["haze"] = written_as("rc.Haze", Haze, groups, values, "haze")
    drawn |= quality
    drawn["tolerance"] = ROUGH if frame.coarse else (1.0 - LIGHT) * tolerance
    picture = Call("rc.render", render, (Name("lit"),), drawn)
    return Recipe(
        (
            cloud,
            Stage("balls", balls, few),
            Stage("lit", lit, rough),
            Stage("picture", picture),
        ),
        saving(values),
    )


def marched(values: Values, frame: Frame) -> Recipe:
    """Write noise to cloud map, and rays through it."""
    groups = by_key(MARCH_GROUPS)
    cloud = cloud_stage(differing(groups["generate"], values["generate"] or {}))
    common = {
        "camera": camera_call(groups, values, frame),
        "suns": suns_of(groups, values),
        "medium": written_as("rc.Medium", Medium, groups, values, "medium"),
        "background": written_as("rc.Sky", Sky, groups, values, "sky"),
        "mixing": written_as("rc.march.Mixing", Mixing, groups, values, "mixing"),
    }
    quality = differing(groups["quality"], values["quality"] or {})
    here = (Name("cloud"),)
    picture = Call("rc.render", render, here, {**common, **quality})
    quality.pop("tolerance", None)
    quick = Call("glimpse", glimpse, here, {**common, **quality})
    return Recipe((cloud, Stage("picture", picture, quick)), saving(values))


def boxed(values: Values, frame: Frame) -> Recipe:
    """Write document D's cloud in a box."""
    groups = by_key(BOX_GROUPS)
    box = Box(**(values["box"] or {}))
    texture = differing(groups["texture"], values["texture"] or {})
    cloud = Call("rc.cloudmap.box_cloud", box_cloud, box.corners(), texture)
    # A coarse frame has at least so many voxels along the box.
    voxel = max(float(box.lengths.max()) / COARSE_CELLS / 2.0, texture["voxel"])
    quality = differing(groups["quality"], values["quality"] or {})
    if frame.coarse:
        samples = (values["quality"] or {})["samples"]
        quality |= {"samples": min(samples, COARSE_SAMPLES), "tolerance": ROUGH}
    picture = Call(
        "box_picture",
        box_picture,
        (Name("cloud"), camera_call(groups, values, frame)),
        {
            "suns": suns_of(groups, values),
            "medium": written_as("rc.Medium", Medium, groups, values, "medium"),
            "octaves": written_as(
                "rc.lighting.Octaves", Octaves, groups, values, "octaves"
            ),
            **quality,
        },
    )
    return Recipe(
        (Stage("cloud", cloud, cloud.but(voxel=voxel)), Stage("picture", picture)),
        saving(values),
    )


def cloud_stage(chosen: dict[str, Any]) -> Stage:
    """Write the cloud map, and its coarse form of larger voxels."""
    call = Call("rc.generate", generate, (), chosen)
    diameters, voxel, _ = BY_SHAPE[chosen.get("shape", "cumulus")]
    longest = float(np.max(chosen.get("diameters", diameters)))
    voxel = max(chosen.get("voxel", voxel) * COARSE_VOXEL, longest / COARSE_CELLS)
    return Stage("cloud", call, call.but(voxel=voxel))


def coarse_look(values: Values) -> dict[str, Any]:
    """Give what a coarse frame changes in a look."""
    look = values.get("look") or {}
    small = {
        name: min(look.get(name, side), side)
        for name, side in COARSE_LOOK.items()
        if name.endswith("buffer")
    }
    return {**COARSE_LOOK, **small}


SPLAT_VIEWS = (
    *("noise slice", "density slice", "light's buffer", "readback areas"),
    *("order toward the light", "order toward the eye", "balls per pixel", "error"),
)
MARCH_VIEWS = (
    *("noise slice", "density slice", "steps per pixel", "steps skipped per pixel"),
    "error",
)
OWN = (
    Setup(
        "cloud",
        "a cloud of metaballs (paper M)",
        SPLAT_GROUPS,
        splatted,
        SPLAT_VIEWS,
    ),
    Setup("march", "a cloud map, marched", MARCH_GROUPS, marched, MARCH_VIEWS),
    Setup("box", "a cloud in a box (document D)", BOX_GROUPS, boxed, MARCH_VIEWS[1:]),
    NOISE,
)
