"""Savings of the marches: rays, samples, slabs and light volumes."""

from __future__ import annotations

import dataclasses
import importlib
from typing import Any

import numpy as np
import pytest
from small_marches import BLOB, EYE, MEDIUM, SUN
from smooth_clouds import cloud
from twins.lighting import scattered_balls

from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.lighting import Octaves, octave_march
from refcloud.march import integrate
from refcloud.march.across import Across
from refcloud.march.chords import columns_of
from refcloud.march_picture import draw_march
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from skipping import Found, proof, replaced

OCTAVES = {"medium": Medium(4.0, 0.9, 0.5, "hg"), "octaves": Octaves(), "step": 0.1}
BEFORE = Camera([0.5, 1.0, 7.0], [0, 0, 0], width=12, height=9)
FRONT = Camera([2.2, 1.2, 3.0], [0, 0, 0], width=27, height=20)
THICK = dataclasses.replace(MEDIUM, sigma_t=60.0)
FLOAT32 = 2e-6  # sums of some dozen terms of at most 1, in single precision


def marched(
    grid: VoxelGrid | Metaballs, camera: Camera, **how: Any
) -> tuple[np.ndarray, tuple]:
    """March all pixels; light and transmittance side by side, and the report."""
    seen: dict[str, Any] = {}
    how = {"suns": SUN, "medium": MEDIUM} | how
    L, T = integrate(grid, *rays(camera), **how, observe=seen.__setitem__)
    return np.concatenate([L, T.reshape(*L.shape[:2], -1)], axis=-1), seen["skipped"]


@proof("march", "samples between empty voxels")
def samples_between_empty_voxels() -> Found:
    module = importlib.import_module("refcloud.lighting.octave_march")
    real = module.shining_of

    def everywhere(*how):
        table = real(*how)
        return dataclasses.replace(table, occupied=np.ones_like(table.occupied))

    found = octave_march(BLOB, EYE, suns=(SUN,), **OCTAVES)
    with replaced(module.__name__, shining_of=everywhere):
        whole = octave_march(BLOB, EYE, suns=(SUN,), **OCTAVES)
    return Found(found[0], whole[0], found[2])


@proof("march", "rays behind an opaque front", together=True)
def rays_behind_an_opaque_front() -> Found:
    thick = OCTAVES | {"medium": Medium(60.0, 0.9, 0.5, "hg")}
    found, whole = (
        octave_march(BLOB, EYE, suns=(SUN,), tolerance=t, **thick) for t in (0.5, 0.0)
    )
    return Found(found[0], whole[0], found[2])


@proof("march", "samples in double precision", together=True)
def samples_in_double_precision() -> Found:
    found, whole = (
        octave_march(BLOB, EYE, suns=(SUN,), tolerance=t, **OCTAVES)
        for t in (0.01, 0.0)
    )
    return Found(found[0], whole[0], found[2])


@proof("march", "exact rays through solved light", together=True)
@proof("light", "directions of the finest solution", together=True)
def cheaper_solved_light() -> Found:
    how = {"medium": dataclasses.replace(MEDIUM, sigma_t=2.0), "scattering": "multiple"}
    found, rows = marched(BLOB, EYE, tolerance=0.2, **how)
    return Found(found, marched(BLOB, EYE, **how)[0], rows)


@proof("march", "exact rays", together=True)
def exact_rays_by_slabs() -> Found:
    found, rows = marched(BLOB, FRONT, medium=THICK, tolerance=0.2)
    return Found(found, marched(BLOB, FRONT, medium=THICK)[0], rows)


@proof("march", "exact rays")
def exact_rays_by_slices() -> Found:
    camera = Camera([1.5, 1.0, 3.2], [0, 0, 0], fov_y=0.53, width=32, height=24)
    sun = (Sun([-0.5, 0.7, 0.4]),)
    blue, medium = np.array([0.1, 0.2, 0.4]), Medium(6.0)
    found, whole = (
        draw_march(cloud(40), camera, sun, blue, medium=medium, tolerance=tolerance)
        for tolerance in (0.03, 0.0)
    )
    assert any("slices" in note for note in found.notes)
    return Found(found.linear, whole.linear, found.skipped)


@proof("march", "exact columns to the suns")
def exact_columns_to_the_suns() -> Found:
    inner = np.pad(BLOB.density > 0.2, 1).astype(float)
    sharp = VoxelGrid(inner, [-1.2, -1.1, -1.3], [1.2, 1.1, 1.3])
    camera = dataclasses.replace(FRONT, width=30, height=22)
    found, rows = marched(sharp, camera, tolerance=0.01)
    return Found(found, marched(sharp, camera)[0], rows)


@proof("march", "Gauss points of a piece")
def gauss_points_of_a_piece() -> Found:
    sharp = VoxelGrid(1.0 * (BLOB.density > 0.2), [-1.2, -1.1, -1.3], [1.2, 1.1, 1.3])
    camera = dataclasses.replace(FRONT, width=30, height=22)
    with replaced("refcloud.march.sharp", SHAFTINGS=()):
        found, rows = marched(sharp, camera, tolerance=2e-3)
    return Found(found, marched(sharp, camera)[0], rows)


def by_slabs(**switched_off: Any) -> tuple[np.ndarray, tuple]:
    """March few slabs in several stretches, so that each saving has its turn."""
    with (
        replaced("refcloud.march.gather", STRETCH=1),
        replaced("refcloud.march.certified", **switched_off),
    ):
        return marched(BLOB, FRONT, medium=THICK, tolerance=0.2)


@proof("march", "passages through empty slabs", rounding=FLOAT32)
def passages_through_empty_slabs() -> Found:
    fast = importlib.import_module("refcloud.march.fast")
    real = fast.as_slabs

    def everywhere(*how):
        slabs = real(*how)
        V, U = slabs.across
        held = np.zeros_like(slabs.occupied).reshape(-1, V, U)
        held[: slabs.count] = True
        blocks = np.ones_like(slabs.blocks)
        return dataclasses.replace(slabs, occupied=held.reshape(-1), blocks=blocks)

    found, rows = by_slabs()
    with replaced(fast.__name__, as_slabs=everywhere):
        whole, _ = by_slabs()
    return Found(found, whole, rows)


@proof("march", "passages behind opaque fronts", rounding=FLOAT32)
def passages_behind_opaque_fronts() -> Found:
    found, rows = by_slabs()
    whole, _ = by_slabs(HIDDEN=1e-250)
    return Found(found, whole, rows)


# A sun cuts rays into pieces where its columns bend, needed or not: the quadrature's
# own error shows, worst seen 1.2e-6.
@proof("light", "suns without light", rounding=5e-6)
def marched_suns_without_light() -> Found:
    """A light of 1e-300 is marched, and adds nothing."""
    suns = [Sun([0.3, 0.9, 0.1], np.full(3, strength)) for strength in (0.0, 1e-300)]
    (found, rows), (whole, _) = (marched(BLOB, EYE, suns=(SUN, sun)) for sun in suns)
    return Found(found, whole, rows)


def by_balls(tolerance: float) -> tuple[np.ndarray, tuple]:
    """March thick balls, at a tolerance or to the end."""
    return marched(scattered_balls(3, 30), BEFORE, medium=THICK, tolerance=tolerance)


@proof("march", "pieces of rays behind an opaque front")
def pieces_of_rays_behind_an_opaque_front() -> Found:
    found, rows = by_balls(0.05)
    return Found(found, by_balls(0.0)[0], rows)


@proof("march", "chords toward suns")
def chords_toward_suns() -> Found:
    found, rows = by_balls(0.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Across, "columns", every_chord)
        whole, _ = by_balls(0.0)
    return Found(found, whole, rows)


def every_chord(cells: Across, places: np.ndarray) -> tuple[np.ndarray, int]:
    """Look at all balls from every place."""
    return columns_of(cells.balls, places, cells.direction), 0
