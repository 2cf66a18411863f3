"""The quadrature: closed answers, laws, brute force, and numbers at their ends."""

from __future__ import annotations

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_marches import BLOB, EYE, MEDIUM, SUN, blob, rays_of, relative_error
from twins.march import directions

from refcloud.cloudmap import VoxelGrid
from refcloud.march import Mixing, cells, integrate, march_by_steps, ray_box
from refcloud.optics import Medium, Sun

SLAB = VoxelGrid(np.ones((2, 3, 4)), [-50.0, -50.0, 0.0], [50.0, 50.0, 2.0])
INWARD = ([0.0, 0.0, 9.0], [[0.0, 0.0, -1.0]])
HOW = {"suns": SUN, "medium": MEDIUM}
SOME = tuple(a.reshape(-1, 3)[20:90] for a in rays_of(EYE))


def haze(sigma_t: float) -> Medium:
    return Medium(sigma_t, phase="isotropic")


@given(st.floats(-7.0, 4.4))
def test_a_slab_lit_from_the_eye_and_from_behind(power) -> None:
    """From thin haze, tau 1e-7, to tau 2.5e4 between two voxel centres."""
    tau = 10.0**power
    T = math.exp(-tau)
    for z, expected in ((1, -math.expm1(-2.0 * tau) / 2.0), (-1, tau * T)):
        L, seen = integrate(SLAB, *INWARD, suns=Sun([0, 0, z]), medium=haze(tau / 2.0))
        # Four points on pieces of tau <= 1/2: worst seen 5.4e-10. What is left out lies
        # behind tau = 41.
        assert L[0, 0] == pytest.approx(expected, rel=1e-9, abs=1e-18)
        assert seen[0] == pytest.approx(T, rel=1e-12 * max(tau, 1.0), abs=1e-300)


@pytest.mark.parametrize("sigmas", [[0.1, 0.1, 300.0], [0.01, 3.0, 1e6], [0, 1, 80]])
def test_an_opaque_channel_hides_nothing_of_clear_ones(sigmas) -> None:
    medium = Medium(sigmas, phase="isotropic")
    tau = 2.0 * np.array(sigmas)
    for z, expected in ((1, -np.expm1(-2.0 * tau) / 2.0), (-1, tau * np.exp(-tau))):
        L, _ = integrate(SLAB, *INWARD, suns=Sun([0, 0, z]), medium=medium)
        np.testing.assert_allclose(L[0], expected, rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize("tau", ["1e-7", "1e-5", "0.01"])
def test_thin_haze_keeps_its_digits(tau) -> None:
    with localcontext() as context:
        context.prec = 40
        expected = (1 - (-2 * Decimal(tau)).exp()) / 2
    L, T = integrate(SLAB, *INWARD, suns=Sun([0, 0, 1]), medium=haze(float(tau) / 2))
    assert L[0, 0] == pytest.approx(float(expected), rel=1e-14)
    ambient, _ = integrate(
        SLAB, *INWARD, suns=(), medium=haze(float(tau) / 2), ambient=[1.0, 1, 1]
    )
    exact = -math.expm1(-float(tau))
    assert ambient[0, 0] == pytest.approx(exact, rel=1e-14)
    assert T[0] == pytest.approx(math.exp(-float(tau)), rel=1e-15)


def test_a_ramp_has_a_column_of_second_degree() -> None:
    """Density 0 to 3 over centres 0 to 3, constant in the outer half voxels."""
    ramp = VoxelGrid(np.arange(4.0).reshape(4, 1, 1), [0, 0, 0], [1, 1, 4])
    way = [[0.0, 0.0, 1.0]]
    _, T = integrate(ramp, [0.5, 0.5, -1.0], way, suns=(), medium=haze(1.0))
    assert -math.log(T[0]) == pytest.approx(0.0 + 4.5 + 1.5, rel=1e-15)
    _, T = integrate(ramp, [0.5, 0.5, 2.0], way, suns=(), medium=haze(1.0))
    assert -math.log(T[0]) == pytest.approx((3.0**2 - 1.5**2) / 2.0 + 1.5, rel=1e-15)


@pytest.mark.slow
def test_brute_force_comes_near() -> None:
    exact, T = integrate(BLOB, *SOME, **HOW)
    L, seen = march_by_steps(BLOB, *SOME, **HOW, sample_rate=800, sun_sample_rate=400)
    # Measured 4.4e-6 and 3.4e-6: the steps' own error, a quarter of it at twice them.
    assert relative_error(L, exact) < 1e-5
    assert np.abs(seen - T).max() < 1e-5


@given(st.integers(0, 2**40), directions(), st.floats(0.0, 30.0))
@settings(max_examples=30)
def test_light_between_nothing_and_all(seed, toward, sigma_t) -> None:
    cloud = blob((5, 4, 6), seed)
    L, T = integrate(cloud, *SOME, suns=Sun(toward), medium=haze(sigma_t))
    assert L.min() >= 0.0
    # What is scattered once is at most what is taken from the ray.
    assert (L[:, 0] <= (1.0 - T) * (1.0 + 1e-8) + 1e-15).all()
    furnace, _ = integrate(
        cloud,
        *SOME,
        suns=(),
        medium=haze(sigma_t),
        ambient=[1, 1, 1],
        background=[1, 1, 1],
    )
    np.testing.assert_allclose(furnace, 1.0, rtol=0.0, atol=1e-15)


def test_suns_add_up() -> None:
    """In one set of pieces: those of a sun that is all but dark are cut as well."""
    other, dark = Sun([1, 0.1, -0.4], [3, 2, 1]), [1e-300, 1e-300, 1e-300]
    pairs = [(SUN, Sun(other.direction, dark)), (Sun(SUN.direction, dark), other)]
    one, two = (integrate(BLOB, *SOME, suns=p, medium=MEDIUM)[0] for p in pairs)
    both, _ = integrate(BLOB, *SOME, suns=(SUN, other), medium=MEDIUM)
    np.testing.assert_allclose(both, one + two, rtol=1e-14)


def test_a_coloured_medium_is_three_grey_ones() -> None:
    sigmas, albedos = [2.0, 8.0, 30.0], [0.2, 1.0, 0.7]
    mixing = Mixing(0.7, 1.3, 0.1)
    L, T = integrate(
        BLOB, *SOME, suns=SUN, medium=Medium(sigmas, albedos, 0.3, "hg"), mixing=mixing
    )
    assert T.shape == (70, 3)
    for c in range(3):
        grey = Medium(sigmas[c], albedos[c], 0.3, "hg")
        alone, through = integrate(BLOB, *SOME, suns=SUN, medium=grey, mixing=mixing)
        # Thick pieces are cut for the thickest channel, so these are other points:
        # what they differ by, 4e-6, is what the quadrature itself is off.
        np.testing.assert_allclose(L[:, c], alone[:, c], rtol=0.0, atol=1e-5)
        np.testing.assert_allclose(T[:, c], through, rtol=1e-14)


def test_what_lies_behind_shows_through() -> None:
    background = np.linspace(0.0, 2.0, 210).reshape(70, 3)
    L, T = integrate(BLOB, *SOME, **HOW)
    over, _ = integrate(BLOB, *SOME, **HOW, background=background)
    np.testing.assert_allclose(over, L + T[:, None] * background, rtol=1e-14)


def test_a_medium_twice_as_dense_is_the_same_as_one_twice_as_large() -> None:
    dense = VoxelGrid(2.0 * BLOB.density, BLOB.lower, BLOB.upper)
    large = VoxelGrid(BLOB.density, 2.0 * BLOB.lower, 2.0 * BLOB.upper)
    o, d = SOME
    for one, two in zip(
        integrate(dense, o, d, **HOW), integrate(large, 2.0 * o, d, **HOW), strict=True
    ):
        np.testing.assert_allclose(one, two, rtol=1e-12)


def test_turning_axes_turns_the_picture() -> None:
    """x, y, z to y, z, x, with cells that are no cubes."""
    lower, upper = np.array([-1.0, -0.7, -1.2]), np.array([1.0, 0.9, 1.4])
    one = VoxelGrid(BLOB.density, lower, upper)
    turned = np.transpose(BLOB.density, (2, 0, 1))  # [z, y, x] to [x, z, y]
    two = VoxelGrid(turned, np.roll(lower, -1), np.roll(upper, -1))
    o, d = SOME
    sun = Sun(np.roll(SUN.direction, -1))
    a = integrate(one, o, d, **HOW)
    b = integrate(
        two, np.roll(o, -1, axis=1), np.roll(d, -1, axis=1), suns=sun, medium=MEDIUM
    )
    np.testing.assert_allclose(a[0], b[0], rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(a[1], b[1], rtol=1e-11)


def test_empty_voxels_around_a_cloud_change_nothing() -> None:
    h = 2.0 / np.array(BLOB.density.shape[::-1])
    density = np.pad(BLOB.density, 3)
    inner = VoxelGrid(np.pad(BLOB.density, 1), -1.0 - h, 1.0 + h)
    outer = VoxelGrid(density, -1.0 - 3.0 * h, 1.0 + 3.0 * h)
    for one, two in zip(
        integrate(inner, *SOME, **HOW), integrate(outer, *SOME, **HOW), strict=True
    ):
        np.testing.assert_allclose(one, two, rtol=1e-11, atol=1e-14)


@settings(max_examples=10)
@given(st.integers(1, 7))
def test_the_list_may_be_cut_anywhere(chunk) -> None:
    origins, ways = SOME[0][:13], SOME[1][:13]
    whole = integrate(BLOB, origins, ways, **HOW)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cells, "CUTS", chunk * (sum(BLOB.density.shape) + 2))
        parts = integrate(BLOB, origins, ways, **HOW)
    np.testing.assert_array_equal(whole[0], parts[0])
    np.testing.assert_array_equal(whole[1], parts[1])


@pytest.mark.parametrize("far", [1e3, 1e6])
def test_a_box_far_away(far) -> None:
    offset = np.array([far, -far, far])
    moved = VoxelGrid(BLOB.density, BLOB.lower + offset, BLOB.upper + offset)
    one, two = (
        integrate(grid, o, SOME[1], **HOW)
        for grid, o in ((BLOB, SOME[0]), (moved, SOME[0] + offset))
    )
    # At 1e6 a coordinate has 1e-10 left, and a voxel is 0.15.
    assert np.abs(one[0] - two[0]).max() < 1e-14 * far
    assert np.abs(one[1] - two[1]).max() < 1e-14 * far


def test_an_eye_far_away() -> None:
    way = np.array([[0.1, -0.2, -0.97]])
    near = integrate(BLOB, -3.0 * way, way, **HOW)
    far = integrate(BLOB, -1e9 * way, way, **HOW)
    assert near[1] == pytest.approx(far[1], abs=1e-6)
    assert near[0] == pytest.approx(far[0], abs=1e-6)


@pytest.mark.parametrize("g", [0.999, 0.9999, 1.0 - 1e-8, 1.0 - 1e-12])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_e36_a_narrow_lobe_keeps_its_peak(g, sign) -> None:
    toward = SOME[1][30]
    medium = Medium(1e-3, 1.0, sign * g, "hg")
    L, T = integrate(
        BLOB, SOME[0][30], toward[None], suns=Sun(sign * toward), medium=medium
    )
    peak = (1.0 + g) / (4.0 * math.pi * (1.0 - g) ** 2)
    thin = 4.0 * math.pi * peak * (1.0 - T[0])
    # The sun is dimmed on its way too, by tau / 2 on average at most.
    assert thin * T[0] < L[0, 0] <= thin * (1.0 + 1e-9)


def test_one_voxel_and_none() -> None:
    one = VoxelGrid([[[2.0]]], [0, 0, 0], [1, 2, 4])
    L, T = integrate(one, [0.5, 1.0, 9.0], [[0, 0, -1]], suns=(), medium=haze(0.25))
    assert T[0] == pytest.approx(math.exp(-2.0), rel=1e-15)
    assert not L.any()
    empty = VoxelGrid(np.zeros((2, 3, 4)), [0, 0, 0], [1, 1, 1])
    L, T = integrate(empty, *SOME, **HOW)
    assert not L.any()
    assert (T == 1.0).all()
    L, T = integrate(BLOB, np.zeros((0, 3)), np.zeros((0, 3)), **HOW)
    assert (L.shape, T.shape) == ((0, 3), (0,))


def test_leading_axes_are_kept() -> None:
    o, d = rays_of(EYE)
    L, T = integrate(BLOB, o, d, **HOW)
    assert (L.shape, T.shape) == ((9, 12, 3), (9, 12))
    flat, _ = integrate(BLOB, EYE.eye, 3.0 * d.reshape(-1, 3), **HOW)
    np.testing.assert_allclose(flat.reshape(L.shape), L, rtol=1e-12)
    one, through = integrate(BLOB, EYE.eye, -EYE.eye, **HOW)
    assert (one.shape, through.shape) == ((3,), ())


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: VoxelGrid([[[np.nan]]], [0, 0, 0], [1, 1, 1]), "density: expected"),
        (lambda: VoxelGrid([[[-1.0]]], [0, 0, 0], [1, 1, 1]), "density: expected"),
        (lambda: Medium(1.0, g=1.0), "g: expected"),
        (lambda: Medium(1.0, g=-1.0), "g: expected"),
        (
            lambda: integrate(BLOB, [0, 0, 0], [[0.0, 0, 0]], **HOW),
            "directions: expected vectors that are not zero",
        ),
        (
            lambda: integrate(BLOB, np.zeros((2, 3)), np.ones((3, 3)), **HOW),
            "directions: expected a shape that fits",
        ),
        (
            lambda: integrate(BLOB, *SOME, **HOW, background=np.ones((3, 3))),
            "background: expected shape",
        ),
        (
            lambda: integrate(BLOB, *SOME, suns=SUN, medium=Medium(1e300)),
            "sigma_t: expected an optical depth",
        ),
        (lambda: integrate(BLOB, *SOME, **HOW, tolerance=2.0), "tolerance: expected"),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        call()


@given(directions(), directions(), st.floats(0.01, 8.0))
@settings(max_examples=20)
def test_a_full_box_in_oblique_light(way, toward, sigma_t) -> None:
    """Known by one variable's integral: both depths are lengths in the box."""
    lower, upper = np.array([-1.0, -0.5, -0.7]), np.array([1.0, 0.8, 0.9])
    cloud = VoxelGrid(np.ones((2, 3, 2)), lower, upper)
    d = np.array(way) / np.linalg.norm(way)
    middle = np.array([0.1, 0.2, -0.1])
    sun = Sun(toward)
    L, _ = integrate(cloud, middle - 9.0 * d, d[None], suns=sun, medium=haze(sigma_t))
    box = {"lower": lower, "upper": upper}
    t0, t1 = (float(t[0]) for t in ray_box(middle - 9.0 * d, d[None], **box))
    t = t0 + (np.arange(20000) + 0.5) / 20000 * (t1 - t0)
    points = middle - 9.0 * d + t[:, None] * d
    _, out = ray_box(points, sun.direction, **box)
    expected = sigma_t * np.exp(-sigma_t * (t - t0 + out)).sum() * (t1 - t0) / 20000
    # The midpoint sum has its own error where light only grazes a face: 2e-6 seen.
    assert L[0, 0] == pytest.approx(expected, rel=1e-5, abs=1e-9)
