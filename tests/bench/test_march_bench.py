"""The march benchmark: every contender sees the same picture."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import march
from refcloud.bench.march_gl import Shader
from refcloud.bench.timing import Contender, timed
from refcloud.transport import sun_depths

SIZE = 12  # voxels along a side: coarse, and quick


def test_errors_are_measured_as_the_contender_says() -> None:
    rows = timed(
        [
            Contender("t", "far", 1, lambda: 3.0, lambda: 1.0),
            Contender(
                "t", "near", 1, lambda: 3.0, lambda: 1.0, distance=lambda a, b: 7.0
            ),
        ],
        rounds=1,
    )
    assert [row.error for row in rows] == [2.0, 7.0]


def test_light_volumes_come_near_the_exact_columns() -> None:
    for contender in march.light(SIZE):
        assert contender.reference is not None
        error = march.relative_error(contender.work(), contender.reference())
        # Worst seen .042, of 16 steps and of a volume in cells as coarse as these.
        assert error < 0.07, contender.name


@pytest.mark.slow
def test_pictures_come_near_the_exact_one() -> None:
    for contender in [*march.pictures(SIZE), *march.behind(2 * SIZE)]:
        assert contender.reference is not None
        found = contender.work()
        error = march.relative_error(found, contender.reference())
        assert found.shape == contender.reference().shape
        # Worst seen .19: an image of 1.25 samples per voxel of a grid of 12.
        assert error < 0.25, contender.name


@pytest.mark.gl
def test_the_shader_marches_as_numpy_does() -> None:
    of = march.scene(SIZE, march.SIGMA_T, False)
    volume = sun_depths(of.grid, of.sun.direction)
    shader = Shader.here(of.grid, volume, march.SIGMA_T)
    if shader is None:
        pytest.skip("no OpenGL 3.3")
    drawn = of.compared(shader.frame(of.camera, of.sun.direction, 64, 0))
    stepped = march.steps_with_volume(of, volume, 64)
    # Single precision, and 8 bits of a texture's fraction where the driver has no more.
    assert np.abs(drawn - stepped).max() < 4e-3
