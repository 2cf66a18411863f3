"""Any row of operations leaves what the scalar model has, in every format."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
)
from twins.framebuffer import (
    COLOUR,
    DEPTH,
    FORMAT,
    ONE_CODE,
    drawn_rules,
    drawn_state,
    filled,
)

from refcloud import raster
from refcloud.plain import framebuffer as plain
from refcloud.plain import raster as scalar
from refcloud.raster.formats import stored

pytestmark = pytest.mark.stress

SIDE = 3
LARGE = 1e60  # float64 holds the product of any five of them
OVER = ("ONE", "ONE_MINUS_SRC_ALPHA", "FUNC_ADD")
OVER_RULES = plain.Rules(OVER, OVER, (0.0, 0.0, 0.0, 0.0))
# What a splat's footprint may differ by, of 1: sums and roots in another order.
FOOTPRINT = 1e-12
# Then a float may round to its neighbour, and a code to the next one.
STEPS = {"RGBA64F": 0.0, "RGBA32F": 2.0**-23, "RGBA16F": 2.0**-10}
ENDS = st.tuples(st.integers(0, SIDE), st.integers(0, SIDE)).map(sorted)


class Machine(RuleBasedStateMachine):
    """A framebuffer and its scalar model, side by side."""

    @initialize(data=st.data(), format=FORMAT)
    def made(self, data: st.DataObject, format: str) -> None:
        self.format = format
        self.buffer = filled(data.draw, SIDE, format)
        self.follow()

    def follow(self) -> None:
        """Let the model have what the framebuffer has."""
        assert self.buffer.depth is not None
        self.pixels = self.buffer.pixels.tolist()
        self.depths = self.buffer.depth.tolist()

    def compare(self, tolerance: float = 0.0) -> None:
        """Hold both against each other; where pow rounds, they go on from one state."""
        encoded = self.format == "SRGB8_ALPHA8"
        expected = np.array(self.pixels)
        gap = np.abs(self.buffer.pixels - expected)
        assert (gap <= max(tolerance, ONE_CODE if encoded else 0.0)).all()
        np.testing.assert_array_equal(self.buffer.depth, self.depths)
        if tolerance or encoded:
            self.follow()

    @rule(data=st.data(), color=COLOUR, depth=DEPTH)
    def clear(self, data: st.DataObject, color: list[float], depth: float) -> None:
        state, plainly = drawn_state(data.draw, SIDE)
        raster.clear(self.buffer, color, depth=depth, state=state)
        plain.clear(self.pixels, self.depths, color, depth, plainly, self.format)
        self.compare()

    @precondition(lambda self: np.abs(self.buffer.pixels).max() < LARGE)
    @rule(data=st.data(), rows=ENDS, columns=ENDS)
    def draw(self, data: st.DataObject, rows: list[int], columns: list[int]) -> None:
        state, plainly = drawn_state(data.draw, SIDE)
        shape = rows[1] - rows[0], columns[1] - columns[0]
        colors, depths = np.zeros((*shape, 4)), np.zeros(shape)
        fragments = []
        for j, i in np.ndindex(shape):
            colors[j, i], depths[j, i] = data.draw(COLOUR), data.draw(DEPTH)
            place = rows[0] + j, columns[0] + i
            fragments.append((*place, float(depths[j, i]), colors[j, i].tolist()))
        box = slice(*rows), slice(*columns)
        raster.draw_fragments(self.buffer, *box, colors, depth=depths, state=state)
        plain.draw_fragments(self.pixels, self.depths, fragments, plainly, self.format)
        self.compare()

    @precondition(lambda self: np.abs(self.buffer.pixels).max() < LARGE)
    @rule(data=st.data(), color=COLOUR, rows=ENDS, columns=ENDS)
    def blend(
        self,
        data: st.DataObject,
        color: list[float],
        rows: list[int],
        columns: list[int],
    ) -> None:
        rules, plainly = drawn_rules(data.draw)
        patch = np.broadcast_to(color, (rows[1] - rows[0], columns[1] - columns[0], 4))
        raster.blend(
            self.buffer,
            slice(*rows),
            slice(*columns),
            patch,
            rules.src_rgb,
            rules.dst_rgb,
            src_alpha=rules.src_alpha,
            dst_alpha=rules.dst_alpha,
            equation=rules.equation,
            equation_alpha=rules.equation_alpha,
            constant=rules.constant,
        )
        for row in range(*rows):
            for column in range(*columns):
                pixel = self.pixels[row][column]
                pixel[:] = plain.blended_as(color, pixel, plainly, self.format)
        self.compare()

    @precondition(lambda self: np.abs(self.buffer.pixels).max() < LARGE)
    @rule(
        place=st.tuples(st.floats(-2.0, SIDE + 2.0), st.floats(-2.0, SIDE + 2.0)),
        radius=st.floats(0.1, 9.0),
        emission=st.lists(st.floats(0.0, 4.0), min_size=3, max_size=3),
        tau=st.floats(1e-4, 50.0) | st.sampled_from([0.0, 1e300]),
        kernel=st.sampled_from(["wyvill", "gaussian"]),
        name=st.sampled_from(["chord", "profile"]),
        law=st.sampled_from(["beer", "linear"]),
    )
    def splat(self, place, radius, emission, tau, kernel, name, law) -> None:
        how = {"kernel": kernel, "name": name, "law": law}
        raster.splat(self.buffer, *place, radius, emission=emission, tau=tau, **how)
        for row, column, q in scalar.patch(*place, radius, SIDE, SIDE):
            weight = scalar.footprint(q, kernel, name)
            alpha = 1.0 - scalar.transmittance(weight, tau, law)
            glow = alpha / -math.expm1(-tau) if tau > 0.0 else weight
            source = [light * glow for light in emission] + [alpha]
            pixel = self.pixels[row][column]
            pixel[:] = plain.blended_as(source, pixel, OVER_RULES, self.format)
        scale = max(1.0, float(np.abs(self.buffer.pixels).max()))
        step = STEPS.get(self.format)
        share = FOOTPRINT / min(tau or 1.0, 1.0)
        self.compare(ONE_CODE if step is None else (share + step) * scale)

    @rule(rows=ENDS, columns=ENDS)
    def read(self, rows: list[int], columns: list[int]) -> None:
        box = slice(*rows), slice(*columns)
        found = raster.read_pixels(self.buffer, *box)
        expected = scalar.read_pixels(self.pixels, range(*rows), range(*columns))
        assert found.tolist() == expected
        found += 1.0  # a copy
        self.compare()

    @invariant()
    def every_number_is_one_that_the_format_holds(self) -> None:
        if not hasattr(self, "buffer"):
            return
        pixels = self.buffer.pixels
        assert np.isfinite(pixels).all()
        if self.format != "SRGB8_ALPHA8":
            np.testing.assert_array_equal(stored(pixels, self.format), pixels)
        raster.Framebuffer(pixels, self.buffer.depth, self.format)


TestMachine = Machine.TestCase
TestMachine.settings = settings(max_examples=40, stateful_step_count=15, deadline=None)
