"""Scattering along lattice directions beside its plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.transport as array
from refcloud.optics import Medium, Sun
from refcloud.plain import paths as walker
from refcloud.plain import scattering as plain
from refcloud.plain import sweep as ray
from twins import Draw, twin
from twins.cloudmap import grids, plain_grid
from twins.optics import PHASES, cosines, shares
from twins.transport import directions as toward

WITHOUT = {
    "refcloud.transport.diffusion.diffused_light": "solves a linear system; its balance"
    " is tested in tests/transport/test_cheap_ways.py",
    "refcloud.transport.diffusion.diffuse_source": "two terms of the field that it is"
    " given; tested in tests/transport/test_cheap_ways.py",
    "refcloud.transport.scattering.scattered_light": "iterates twins; equal to a plain"
    " iteration of them in tests/transport/test_scattering.py",
    "refcloud.transport.scattering.source_toward": "a sum over the twin of harmonics;"
    " equal to the sum over directions in tests/transport/test_scattering.py",
}

counts = st.sampled_from([26, 50, 128])
lobes = st.floats(-0.99, 0.99) | st.sampled_from([-0.95, 0.0, 0.6, 0.95])
media = st.builds(Medium, st.floats(0.0, 20.0), shares, lobes, st.sampled_from(PHASES))
degrees = st.integers(0, 7)


@twin(
    array.sphere_directions,
    plain.sphere_directions,
    tolerance=4e-15,
    why="worst seen 3.9e-16, times 10: zeros of P_8, found twice",
)
def sphere_directions(draw: Draw):
    count = draw(counts)
    found = array.sphere_directions(count)
    flat = np.concatenate([found.vectors, found.weights[:, None]], axis=1)
    return flat, [[*v, w] for v, w in plain.sphere_directions(count)]


@twin(
    array.harmonics,
    plain.harmonics,
    tolerance=5e-14,
    why="worst seen 5e-15, times 10: other recurrences, and (x + i y)^m for cos m phi",
)
def harmonics(draw: Draw):
    vectors = [plain.unit(v) for v in draw(st.lists(toward, min_size=1, max_size=3))]
    degree = draw(degrees)
    expected = [plain.harmonics(v, degree) for v in vectors]
    return array.harmonics(vectors, degree), expected


@twin(
    array.legendre_moments,
    plain.legendre_moments,
    tolerance=2e-15,
    why="powers round apart in their last bit",
)
def legendre_moments(draw: Draw):
    medium, degree = draw(media), draw(degrees)
    expected = plain.legendre_moments(medium.phase, medium.g, degree)
    return array.legendre_moments(medium, degree), expected


@twin(
    array.delta_m,
    plain.delta_m,
    tolerance=1e-14,
    why="worst seen 6e-17; at g = 0.99 the division by 1 - f takes two digits",
)
def delta_m(draw: Draw):
    medium, degree = draw(media), draw(degrees)
    found = array.delta_m(medium, degree)
    sigma_t, albedo, moments, *shares = plain.delta_m(
        (medium.sigma_t, medium.albedo, medium.g, medium.phase), degree
    )
    return (
        [
            found.sigma_t[0],
            found.albedo[2],
            *found.moments,
            found.forward,
            found.backward,
        ],
        [sigma_t, albedo, *moments, *shares],
    )


@twin(
    array.smooth_phase,
    plain.smooth_phase,
    tolerance=1.5e-14,
    why="worst seen 1.5e-15, times 10: Clenshaw's sum against terms one by one",
)
def smooth_phase(draw: Draw):
    moments = draw(st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=8))
    mu = draw(cosines)
    found = array.smooth_phase(np.array(moments), np.array(mu))
    return found, [plain.smooth_phase(moments, c) for c in mu]


@twin(
    array.cell_mean,
    ray.cell_mean,
    tolerance=2e-15,
    why="worst seen 1.1e-16, times 18: the same steps; exponentials round apart",
)
def cell_mean(draw: Draw):
    depths = draw(st.lists(st.floats(0.0, 1e4), min_size=1, max_size=4))
    own = draw(st.floats(0.0, 1e4) | st.floats(0.0, 1e-2))
    expected = [ray.cell_mean(tau, own) for tau in depths]
    return array.cell_mean(np.array(depths), np.array(own)), expected


@twin(
    array.folded_beams,
    ray.folded_beams,
    tolerance=1e-12,
    why="thin lines and c near 1 divide by a difference that is k times the depth",
)
def folded_beams(draw: Draw):
    own = draw(st.floats(0.0, 1e3) | st.floats(0.0, 1e-2))
    tau = 0.5 * own + draw(st.floats(0.0, 1e3) | st.floats(0.0, 1e-2))
    whole = tau + 0.5 * own + draw(st.floats(0.0, 1e3))
    turned = draw(st.floats(0.0, 0.99))
    found = array.folded_beams([tau], [whole], [own], turned=turned)
    expected = ray.folded_beams(tau, whole, own, turned)
    return [float(beam[0]) for beam in found], list(expected)


@twin(
    array.intercepted,
    ray.intercepted,
    tolerance=3e-15,
    why="worst seen 2.3e-16, times 13: the same rays, summed in another order",
)
def intercepted(draw: Draw):
    grid, direction, scale = draw(grids()), draw(toward), draw(st.floats(0.0, 5.0))
    cell = (grid.upper - grid.lower) / grid.density.shape[::-1]
    found = array.intercepted(grid, direction, scale=[scale])[0]
    expected = ray.intercepted(grid.density.tolist(), cell.tolist(), direction, scale)
    return found / (1.0 + found), expected / (1.0 + expected)


@twin(
    array.sweep,
    ray.sweep,
    tolerance=3e-15,
    why="worst seen 2.3e-16, times 13: matrices add what the ray follows back",
)
def sweep(draw: Draw):
    count, grid = draw(st.sampled_from([26, 50])), draw(grids())
    shift = draw(st.sampled_from(["cubic", "linear"]))
    inflow = draw(st.floats(0.0, 2.0))
    cubic = draw(st.booleans())
    extinction = grid.density
    cell = np.ones(3) if cubic else (grid.upper - grid.lower) / extinction.shape[::-1]
    chosen = array.sphere_directions(count)
    n = draw(st.integers(0, count - 1))
    waves = np.sin(np.arange(count * extinction.size)).reshape(count, *extinction.shape)
    source = 1.0 + waves
    place = tuple(draw(st.integers(0, size - 1)) for size in extinction.shape)
    found = array.sweep(
        source,
        extinction,
        chosen,
        cell=cell,
        inflow=np.full(count, inflow),
        shift=shift,
    )
    expected = ray.sweep(
        source[n].tolist(),
        extinction.tolist(),
        chosen.vectors[n].tolist(),
        cell.tolist(),
        inflow,
        place,
        shift,
    )
    return found[(n, *place)], expected


@twin(
    array.trace_paths,
    walker.trace_paths,
    tolerance=1e-13,
    why="worst seen 3e-15, times 30: the same steps, rounded apart at each stop",
)
def trace_paths(draw: Draw):
    grid, direction, seed = draw(grids()), draw(toward), draw(st.integers(0, 99))
    unit = plain.unit(direction)
    size = grid.upper - grid.lower
    # Optical depths of a few: walks of a hundred stops would tell no more.
    sigma_t = draw(st.floats(0.1, 3.0)) / float(size.max())
    matter = sigma_t, draw(shares), draw(lobes), draw(st.sampled_from(PHASES))
    aim = grid.lower + draw(st.floats(0.1, 0.9)) * size
    origin = aim - draw(st.sampled_from([0.0, 2.0])) * float(size.max()) * np.array(
        unit
    )
    suns = [(plain.unit(draw(toward)), 2.0) for _ in range(draw(st.integers(0, 2)))]
    sky, ground = draw(st.floats(0.0, 2.0)), draw(st.floats(0.0, 2.0))
    orders = draw(st.integers(1, 3) | st.just(1000))
    found = array.trace_paths(
        grid,
        [origin],
        [unit],
        suns=tuple(Sun(d, np.full(3, e)) for d, e in suns),
        medium=Medium(*matter),
        sky=np.full(3, sky),
        ground=np.full(3, ground),
        paths=2,
        orders=orders,
        seed=seed,
    )
    mean, error = walker.trace_paths(
        plain_grid(grid),
        origin.tolist(),
        list(unit),
        suns,
        matter,
        sky,
        ground,
        range(2),
        orders,
        seed,
    )
    return [found.radiance[0, 1], found.error[0, 1]], [mean, error]


@twin(
    array.beer_powder,
    plain.beer_powder,
    tolerance=1e-15,
    why="worst seen 2e-16: 1 - e^-2t cancels in the plain form",
)
def beer_powder(draw: Draw):
    depths = draw(st.lists(st.floats(0.0, 40.0), min_size=1, max_size=4))
    return array.beer_powder(depths), [plain.beer_powder(t) for t in depths]


@twin(
    array.forward_depth,
    plain.forward_depth,
    tolerance=4e-14,
    why="the plain form takes the logarithm of a sum that is near 1 for thin voxels",
)
def forward_depth(draw: Draw):
    depths = draw(st.lists(st.floats(0.0, 30.0), min_size=1, max_size=4))
    kappa = draw(shares)
    expected = [plain.forward_depth(t, kappa) for t in depths]
    return array.forward_depth(depths, kappa=kappa), expected
