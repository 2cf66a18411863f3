"""The options that each method of the fit takes are those that it reads."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from refcloud.cli.approximate import EVERY, OPTIONS, TAKES
from refcloud.cloudmap import VoxelGrid
from refcloud.metaballs.approximate import METHODS
from refcloud.metaballs.pairs import prepare
from refcloud.metaballs.settings import Settings

FIELDS = {field.name for field in dataclasses.fields(Settings)}


class Spied(Settings):
    """Settings that note what is read of them."""

    def __getattribute__(self, name: str) -> object:
        if name in FIELDS:
            SEEN.add(name)
        return super().__getattribute__(name)


SEEN: set[str] = set()


@pytest.mark.parametrize("method", METHODS)
def test_a_method_takes_what_it_reads(method) -> None:
    z, y, x = np.indices((6, 7, 8)) + 1.0
    work = prepare(VoxelGrid(np.sin(x) ** 2 * y + z, [0, 0, 0], [8, 7, 6]))
    assert work is not None
    SEEN.clear()
    METHODS[method](work, 6, Spied("wyvill", 0, lambda *_: None))
    assert SEEN - {"watch", "seed", "kernel"} == set(TAKES[method])


def test_every_option_is_for_all_methods_or_for_some() -> None:
    some = {name for names in TAKES.values() for name in names}
    assert set(TAKES) == set(METHODS)
    assert {option.name for option in OPTIONS} == some | set(EVERY)
