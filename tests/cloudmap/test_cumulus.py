"""The pile of ellipsoids, how deep it is, and the surface that noise moves."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.cloudmap import axes, coordinates, places, seeds

from refcloud.cloudmap import cumulus_ellipsoids, depth_inside, displace
from refcloud.cloudmap.cumulus import LOBES, MEAN_NOISE

lengths = st.floats(1.0, 100.0)
lines = st.lists(coordinates, min_size=1, max_size=4)
piles = st.lists(st.tuples(places, axes), min_size=1, max_size=4)


def split(pile: list) -> dict[str, np.ndarray]:
    centers, radii = np.reshape(pile, (-1, 2, 3)).swapaxes(0, 1)
    return {"centers": centers, "radii": radii}


@given(st.tuples(lengths, lengths, lengths), seeds)
def test_three_generations_that_sit_on_each_other(diameters, seed: int) -> None:
    centers, radii = cumulus_ellipsoids(diameters, seed=seed)
    base, each, last = LOBES
    assert len(centers) == base * (1 + each * (1 + last))
    assert (radii > 0.0).all()
    parents = np.repeat(
        np.arange(base * (1 + each)), [each] * base + [last] * base * each
    )
    off = (centers[base:] - centers[parents]) / radii[parents]
    # At 0.75 to 0.95 of the parent's surface, and mostly upward.
    distance = np.sqrt(np.square(off).sum(axis=1))
    assert (distance >= 0.75 - 1e-9).all()
    assert (distance <= 0.95 + 1e-9).all()
    assert (off[:, 1] >= -0.15).all()


@given(st.tuples(lengths, lengths, lengths), seeds, st.floats(0.1, 10.0))
def test_the_pile_scales_with_its_diameters(diameters, seed, factor) -> None:
    small, large = (
        np.stack(cumulus_ellipsoids(factor_ * np.array(diameters), seed=seed))
        for factor_ in (1.0, factor)
    )
    np.testing.assert_allclose(large, factor * small, rtol=1e-12, atol=1e-12 * factor)


def test_another_seed_is_another_pile() -> None:
    piles_ = [cumulus_ellipsoids([62, 34, 34], seed=seed)[0] for seed in (0, 0, 1)]
    np.testing.assert_array_equal(piles_[0], piles_[1])
    assert np.abs(piles_[0] - piles_[2]).min(axis=1).max() > 0.1


@given(piles, lines, lines, lines)
def test_depth_of_a_union_is_the_largest_of_its_parts(pile, x, y, z) -> None:
    whole = depth_inside(x, y, z, **split(pile))
    parts = [depth_inside(x, y, z, **split([one])) for one in pile]
    np.testing.assert_array_equal(whole, np.max(parts, axis=0))


@given(piles, lines, lines, lines, st.floats(-5.0, 0.0))
def test_what_matters_to_nobody_changes_nothing_above_it(pile, x, y, z, least) -> None:
    exact = depth_inside(x, y, z, **split(pile))
    found = depth_inside(x, y, z, **split(pile), least=least)
    np.testing.assert_array_equal(found, np.maximum(exact, least))


@given(places, axes)
def test_depth_is_the_smallest_radius_in_the_middle(center, radii) -> None:
    x, y, z = ([c] for c in center)
    pile = split([(center, radii)])
    assert depth_inside(x, y, z, **pile)[0, 0, 0] == pytest.approx(min(radii))
    x = [center[0] + radii[0]]
    assert depth_inside(x, y, z, **pile)[0, 0, 0] == pytest.approx(0.0, abs=1e-12)


@given(
    st.floats(-9.0, 9.0),
    st.floats(0.0, 1.0),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 3.0),
    st.floats(0.0, 9.0),
    st.floats(0.1, 3.0),
)
def test_density_rises_inward_and_never_leaves_0_to_1(d, more, n, y, relief, edge):
    how = {"relief": relief, "edge": edge}
    low, high = (
        displace([[[at]]], [[[n]]], [y], **how)[0, 0, 0] for at in (d, d + more)
    )
    assert 0.0 <= low <= high <= 1.0
    if y + 0.5 * n <= 0.0 or d + relief * (abs(n) - MEAN_NOISE) <= 0.0:
        assert low == 0.0
    if y >= 1.5 and d - relief * MEAN_NOISE >= edge:
        assert low == pytest.approx(1.0)


def test_without_relief_the_surface_is_that_of_the_pile() -> None:
    depth = [[[-1.0, -0.01, 0.0, 0.6, 1.2, 5.0]]]
    density = displace(depth, np.zeros((1, 1, 6)), [9.0], relief=0.0, edge=1.2)
    assert density.ravel() == pytest.approx([0.0, 0.0, 0.0, 0.5, 1.0, 1.0])
