"""Nodes: exact for polynomials, and their last terms tell how far pixels are off."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.lighting.sparse_tiles import NODES, _one_sided
from refcloud.noise import uniform
from refcloud.raster.between import SIZES, lattice
from refcloud.raster.nodes import LAST, LEAST_RISE, nodes
from refcloud.raster.tile_lists import SIDE, Discs, parts
from refcloud.raster.tiles import composite, pixel_places

COUNTS = (6, 8, 12)


@pytest.mark.parametrize("n", COUNTS)
def test_polynomials_below_n_are_exact(n: int) -> None:
    level = nodes(n)
    for degree_x, degree_y in ((0, 0), (1, 2), (n - 1, n - 1), (n - 1, 0)):
        at_nodes, at_pixels = (
            (x / 8.0) ** degree_x * (y / 8.0) ** degree_y
            for x, y in (level.places, pixel_places())
        )
        found = level.at_pixels(at_nodes[None, None])[0, 0]
        np.testing.assert_allclose(found, at_pixels, rtol=0.0, atol=1e-13)
        expected = 0.0 if max(degree_x, degree_y) < n - LAST else None
        estimate = level.error_of(at_nodes[None, None])[0]
        assert estimate < 1e-13 if expected == 0.0 else estimate > 1e-6


@pytest.mark.parametrize("n", COUNTS)
def test_no_pixel_lies_beyond_the_nodes(n: int) -> None:
    x, y = nodes(n).places
    assert x.max() == y.max() > SIDE / 2 - 0.5


@pytest.mark.parametrize("n", COUNTS)
def test_what_errors_of_one_sign_make_at_pixels(n: int) -> None:
    level = nodes(n)
    # The worst errors from 0 to 1 are 1 where the pixel's weight is positive.
    for sign in (1.0, -1.0):
        errors = (sign * level.spread.T > 0.0).astype(float)[:, None]
        made = np.abs(np.diagonal(level.at_pixels(errors)[:, 0])).max()
        assert made <= level.one_sided * (1.0 + 1e-12)
        assert sign < 0.0 or made > 0.999 * level.one_sided > 1.0


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("n", COUNTS)
def test_polynomials_below_n_are_exact_at_samples(n: int, size: int) -> None:
    level, grid = nodes(n), lattice(size)
    spread = level.spread_to(grid.along)
    for degree_x, degree_y in ((0, 0), (1, 2), (n - 1, n - 1)):
        at_nodes, at_samples = (
            (x / 8.0) ** degree_x * (y / 8.0) ** degree_y
            for x, y in (level.places, grid.places)
        )
        np.testing.assert_allclose(at_nodes @ spread, at_samples, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("size", SIZES)
def test_a_front_cut_at_nodes_is_cut_for_samples_too(size: int) -> None:
    spread = nodes(NODES).spread_to(lattice(size).along)
    for sign in (1.0, -1.0):
        made = np.abs(np.einsum("ns,ns->s", spread, sign * spread > 0.0)).max()
        assert made <= _one_sided()
    assert _one_sided() >= nodes(NODES).one_sided


@settings(max_examples=20)
@given(
    st.integers(0, 2**63 - 1),
    st.integers(1, 60),
    st.floats(1.0, 2.2),
    st.floats(-1.0, 1.0),
    st.sampled_from(["chord", "profile"]),
    st.sampled_from(["beer", "linear"]),
    st.sampled_from([8, 12]),
)
def test_the_last_terms_bound_the_error(seed, count, power, depth, name, law, n):
    k, size = np.arange(count), (64, 48)
    radius = 10.0**power * (0.7 + 0.6 * uniform(k, 0, seed=seed))
    tau = 10.0**depth * (0.5 + uniform(k, 1, seed=seed))
    x, y = (
        (2.0 * uniform(k, 2 + axis, seed=seed) - 0.5) * side
        for axis, side in enumerate(size)
    )
    discs = Discs(x, y, radius)
    colours = uniform(k[:, None], 4 + np.arange(3), seed=seed)
    level = nodes(n)
    for lists in parts(discs, *size):
        both = [
            composite(lists, discs, tau, colours, places, name=name, law=law)
            for places in (level.places, pixel_places())
        ]
        values, exact = (
            np.concatenate([b.light, b.clear[:, None]], axis=1) for b in both
        )
        rise = radius / np.sqrt(np.maximum(tau, 1.0))
        rise = np.minimum.reduceat(rise[lists.ball], lists.first)
        serves = rise >= LEAST_RISE * level.spacing
        error = np.abs(level.at_pixels(values) - exact).max(axis=(1, 2))
        # Smaller errors than this no tolerance of float32 asks about.
        assert (error <= level.error_of(values) + 5e-4)[serves].all()
