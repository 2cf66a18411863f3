"""The contenders of Worley noise do the same task: their values agree."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench.worley import worley_contenders

SINGLE = 1e-6  # worst seen 2.4e-7 in float32, times 4


@pytest.mark.parametrize("task", ["grid", "scattered"])
@pytest.mark.parametrize("feature", ["F1", "F2"])
def test_all_contenders_give_the_same_values(task: str, feature: str) -> None:
    listed = worley_contenders(task, cells=3, side=12, count=500, feature=feature)
    first, *others = (np.ravel(contender.run()) for contender in listed)
    assert first.size == listed[0].samples
    for contender, values in zip(listed[1:], others, strict=True):
        if not contender.name.startswith("neighbours"):
            np.testing.assert_allclose(values, first, rtol=0, atol=SINGLE)
