"""Savings of skies: places that are known, and noise in single precision."""

from __future__ import annotations

import dataclasses
import importlib

from refcloud.camera import Camera
from refcloud.render import render
from refcloud.sky import Plane, places
from skipping import Found, proof, replaced

UPWARD = Camera([0, 1, 0], [0.2, 1.4, -1], width=24, height=18)


@proof("sky", "pixels' rays and coordinates, known already,")
def places_known_already() -> Found:
    plane = Plane(height=3.0)
    earlier = places(UPWARD, plane)
    again = places(dataclasses.replace(UPWARD), plane, earlier=earlier)
    fresh = places(UPWARD, plane)
    return Found(again.coordinates, fresh.coordinates, again.skipped)


@proof("sky", "values of noise, float32 instead of float64, of their last digits")
def noise_in_single_precision() -> Found:
    scenes = importlib.import_module("refcloud.scenes.shader")
    how = {"width": 48, "height": 36, "tolerance": 1e-3}
    found = render("shader-c", **how)
    with replaced(scenes.__name__, precision=lambda view: "float64"):
        whole = render("shader-c", **how)
    return Found(found.linear, whole.linear, found.skipped)
