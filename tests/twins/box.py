"""The box and the cloud in it beside their plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.cloudmap as array
from refcloud.plain import box as plain
from twins import Draw, twin
from twins.cloudmap import axes, coordinates, grids, places, plain_grid
from twins.smooth import texture_ways

counts = st.tuples(*[st.integers(1, 3)] * 3)
edge = st.just(0.0) | st.floats(0.01, 2.0)
edges = edge | st.tuples(edge, edge, edge)


def by_axis(edge) -> list[float]:
    return np.broadcast_to(edge, (3,)).tolist()


def drawn_box(draw: Draw) -> tuple[np.ndarray, np.ndarray]:
    """Draw two opposite corners, whichever of each pair comes first."""
    lower, size = np.array(draw(places)), np.array(draw(axes))
    ends = np.stack([lower, lower + size])
    flip = np.array(draw(st.tuples(*[st.integers(0, 1)] * 3)))
    return ends[flip, np.arange(3)], ends[1 - flip, np.arange(3)]


@twin(array.box_corners, plain.box_corners, tolerance=0.0, why="no arithmetic")
def box_corners(draw: Draw):
    first, second = drawn_box(draw)
    return array.box_corners(first, second), plain.box_corners(first, second)


@twin(array.box_lines, plain.box_lines, tolerance=0.0, why="no arithmetic")
def box_lines(draw: Draw):
    first, second = drawn_box(draw)
    return array.box_lines(first, second), plain.box_lines(first, second)


@twin(array.box_triangles, plain.box_triangles, tolerance=0.0, why="no arithmetic")
def box_triangles(draw: Draw):
    first, second = drawn_box(draw)
    return array.box_triangles(first, second), plain.box_triangles(first, second)


@twin(array.resized_box, plain.resized_box, tolerance=0.0, why="the same steps")
def resized_box(draw: Draw):
    (first, second), lengths = drawn_box(draw), draw(axes)
    actual = array.resized_box(first, second, lengths)
    return actual, plain.resized_box(first, second, lengths)


@twin(array.placed_texture, plain.placed_texture, tolerance=0.0, why="no arithmetic")
def placed_texture(draw: Draw):
    texture, repeats = draw(grids()), draw(counts)
    placed = array.placed_texture(texture, *drawn_box(draw), repeats=repeats)
    return placed.density, plain.placed_texture(plain_grid(texture)[0], repeats)


@twin(
    array.box_coverage,
    plain.box_coverage,
    tolerance=4e-15,
    why="worst seen 4.5e-16 in 600 examples, times 8: the same few operations",
)
def box_coverage(draw: Draw):
    lower, upper = np.sort(np.stack(drawn_box(draw)), axis=0)
    lines = [draw(st.lists(coordinates, min_size=1, max_size=2)) for _ in range(3)]
    edge = draw(edges)
    actual = array.box_coverage(*lines, first=upper, second=lower, edge=edge)
    x, y, z = lines
    return actual, [
        [
            [plain.box_coverage((a, b, c), lower, upper, by_axis(edge)) for a in x]
            for b in y
        ]
        for c in z
    ]


@twin(
    array.box_cloud,
    plain.box_cloud,
    tolerance=3.6e-14,
    why="as the noise, divided by 1 - threshold, a tenth or more",
)
def box_cloud(draw: Draw):
    box = drawn_box(draw)
    how = draw(texture_ways) | {
        "voxel": draw(st.floats(2.0, 5.0)),
        "cell": draw(st.floats(0.3, 3.0)),
        "threshold": draw(st.floats(0.0, 0.9)),
        "edge": draw(edges),
    }
    plain_how = how | {"edge": by_axis(how["edge"])}
    return array.box_cloud(*box, **how).density, plain.box_cloud(*box, **plain_how)
