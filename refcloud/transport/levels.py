"""One grid at several resolutions: halved for a start, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array

Reals = NDArray[np.floating[Any]]


def padded_even(volume: Array) -> Array:
    """Add an empty slice behind each odd axis."""
    return np.pad(volume, [(0, size % 2) for size in volume.shape])


def halved(volume: Array) -> Array:
    """Average blocks of two by two by two voxels; every axis is even."""
    D, H, W = volume.shape
    return volume.reshape(D // 2, 2, H // 2, 2, W // 2, 2).mean(axis=(1, 3, 5))


def halved_light(light: Array, density: Array) -> Array:
    """Average light over blocks as the matter in them sees it."""
    weight = halved(density)
    sums = halved(density * light)
    return np.divide(sums, weight, out=np.zeros_like(sums), where=weight > 0.0)


def doubling(size: int, dtype: Any = np.float64) -> Reals:
    """Give the matrix that interpolates centres of cells at centres of half cells."""
    at = np.clip((np.arange(2 * size) - 0.5) / 2.0, 0.0, size - 1.0)
    return np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(size))).astype(dtype)


def doubled(values: Reals) -> Reals:
    """Interpolate values of shape (..., D, H, W) at twice the resolution."""
    *front, D, H, W = values.shape
    up, down, across = (doubling(size, values.dtype) for size in (D, H, W))
    wide = down @ (values @ across.T)
    flat = up @ wide.reshape(*front, D, -1)
    return flat.reshape(*front, 2 * D, 2 * H, 2 * W)
