"""Rows of the raster room."""

from __future__ import annotations

import typing

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud import raster
from refcloud.plain import raster as plain
from refcloud.raster.blending import Equation, Factor
from twins import Draw, twin

CHANNEL = st.floats(-4.0, 4.0)
COLOUR = st.lists(CHANNEL, min_size=4, max_size=4)
PLACE = st.floats(-12.0, 20.0)
SIDE = st.integers(1, 9)
RADIUS = st.floats(0.4, 12.0) | st.floats(-2, 4).map(lambda power: 10.0**power)
Q = arrays(np.float64, 9, elements=st.floats(0.0, 2.0))
FACTOR = st.sampled_from(typing.get_args(Factor))
EQUATION = st.sampled_from(typing.get_args(Equation))
KERNEL = st.sampled_from(["wyvill", "gaussian"])
NAME = st.sampled_from(["chord", "profile"])
LAW = st.sampled_from(["beer", "linear"])
AREA = st.sampled_from(["disc", "square", "footprint", "antialiased"])


def _filled(draw: Draw, elements: st.SearchStrategy[float]) -> raster.Framebuffer:
    return raster.Framebuffer(
        draw(arrays(np.float64, (draw(SIDE), draw(SIDE), 4), elements=elements))
    )


@twin(raster.framebuffer, plain.framebuffer, tolerance=0, why="no arithmetic")
def framebuffer(draw: Draw):
    width, height, color = draw(SIDE), draw(SIDE), draw(COLOUR)
    buffer = raster.framebuffer(width, height, color=color)
    return buffer.pixels, plain.framebuffer(width, height, color)


@twin(raster.read_pixels, plain.read_pixels, tolerance=0, why="no arithmetic")
def read_pixels(draw: Draw):
    buffer = _filled(draw, CHANNEL)
    height, width, _ = buffer.pixels.shape
    top, left = draw(st.integers(0, height - 1)), draw(st.integers(0, width - 1))
    bottom = draw(st.integers(top + 1, height))
    right = draw(st.integers(left + 1, width))
    box = raster.read_pixels(buffer, slice(top, bottom), slice(left, right))
    rows, columns = range(top, bottom), range(left, right)
    return box, plain.read_pixels(buffer.pixels.tolist(), rows, columns)


@twin(raster.blend, plain.blend, tolerance=0, why="the same products and sum")
def blend(draw: Draw):
    # Formats, and rules of alpha's own, stand in the rows of the framebuffer.
    buffer, constant = _filled(draw, CHANNEL), draw(COLOUR)
    source = draw(arrays(np.float64, buffer.pixels.shape, elements=CHANNEL))
    names, equation = (draw(FACTOR), draw(FACTOR)), draw(EQUATION)
    expected = [
        [
            plain.blend(s, d, *names, equation, constant)
            for s, d in zip(source_row, row, strict=True)
        ]
        for source_row, row in zip(source.tolist(), buffer.pixels.tolist(), strict=True)
    ]
    everything = slice(None), slice(None)
    raster.blend(
        buffer, *everything, source, *names, equation=equation, constant=constant
    )
    return buffer.pixels, expected


@twin(
    raster.patch, plain.patch, tolerance=1e-15, why="two squares and a sum: last bits"
)
def patch(draw: Draw):
    place = draw(PLACE), draw(PLACE), draw(RADIUS)
    width, height = draw(SIDE), draw(SIDE)
    found = raster.patch(*place, width, height)
    expected = plain.patch(*place, width, height)
    if found is None:
        return [], expected
    rows, columns = (
        np.arange(part.start, part.stop) for part in (found.rows, found.columns)
    )
    row, column = np.meshgrid(rows, columns, indexing="ij")
    return np.stack([row, column, found.q], axis=-1).reshape(-1, 3), expected


@twin(
    raster.footprint,
    plain.footprint,
    tolerance=2e-15,
    why="polynomials, roots and a closed erf in another order: worst seen 4e-16",
)
def footprint(draw: Draw):
    q, kernel, name = draw(Q), draw(KERNEL), draw(NAME)
    actual = raster.footprint(q, kernel=kernel, name=name)
    return actual, [plain.footprint(value, kernel, name) for value in q.tolist()]


@twin(
    raster.transmittance,
    plain.transmittance,
    tolerance=4e-16,
    why="one exponential: two last bits of 1",
)
def transmittance(draw: Draw):
    weight = draw(arrays(np.float64, 9, elements=st.floats(0.0, 1.0)))
    tau, law = draw(st.floats(0.0, 100.0)), draw(LAW)
    actual = raster.transmittance(weight, tau, law=law)
    return actual, [plain.transmittance(w, tau, law) for w in weight.tolist()]


@twin(
    raster.splat,
    plain.splat,
    tolerance=1e-12,
    why="at depth 1e-3 the plain 1 - T keeps 13 digits: worst seen 1e-13",
)
def splat(draw: Draw):
    buffer = _filled(draw, st.floats(0.0, 1.0))
    expected = buffer.pixels.tolist()
    place = draw(PLACE), draw(PLACE), draw(RADIUS)
    emission = draw(st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3))
    tau = draw(st.just(0.0) | st.floats(1e-3, 100.0))
    kernel, name, law = draw(KERNEL), draw(NAME), draw(LAW)
    style = {"kernel": kernel, "name": name, "law": law}
    raster.splat(buffer, *place, emission=emission, tau=tau, **style)
    plain.splat(expected, *place, emission, tau, **style)
    return buffer.pixels, expected


@twin(
    raster.read_mean,
    plain.read_mean,
    tolerance=1e-13,
    why="81 terms in another order, weights near the rim: worst seen 3e-15",
)
def read_mean(draw: Draw):
    buffer = _filled(draw, CHANNEL)
    place = draw(PLACE), draw(PLACE), draw(RADIUS)
    area, kernel, name = draw(AREA), draw(KERNEL), draw(NAME)
    actual = raster.read_mean(buffer, *place, area=area, kernel=kernel, footprint=name)
    expected = plain.read_mean(buffer.pixels.tolist(), *place, area, kernel, name)
    return ([] if mean is None else mean for mean in (actual, expected))
