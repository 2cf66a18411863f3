"""Scenes that hunt for failing certificates: drawn again they are the same."""

from __future__ import annotations

import json
from typing import get_args

import numpy as np
import pytest

from refcloud.bench import certificates
from refcloud.bench.certificates import Kind, Tally, drawn, table_of, tally
from refcloud.cli import main


@pytest.mark.parametrize("kind", get_args(Kind))
def test_a_scene_is_drawn_again_by_its_number(kind: Kind, monkeypatch) -> None:
    monkeypatch.setattr(certificates, "LARGE", 40)
    off, tolerance, by_sample = drawn(kind, 3)
    assert (off, tolerance, by_sample) == drawn(kind, 3)
    assert 1e-4 <= tolerance <= 0.1
    assert 0.0 <= off <= tolerance + certificates.ROUNDED


def test_each_kind_has_its_word() -> None:
    for word, kind in certificates.KINDS.items():
        assert word == kind.replace(", ", "-").replace(" ", "-")
    assert list(certificates.COUNTS) == list(certificates.QUICK) == [*get_args(Kind)]
    assert sum(certificates.COUNTS.values()) > 10_000


def test_directions_are_even_over_the_sphere() -> None:
    pairs = (np.indices((16, 16)).reshape(2, -1).T + 0.5) / 16.0
    ways = np.array([certificates.way_of(pair) for pair in pairs])
    np.testing.assert_allclose(np.sum(ways * ways, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(ways.mean(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.mean(ways * ways, axis=0), 1.0 / 3.0, atol=2e-3)


def test_failures_are_counted(monkeypatch) -> None:
    errors = iter([(0.5, 0.1, True), (0.05, 0.1, False), (0.1, 0.1, True)])
    monkeypatch.setattr(certificates, "drawn", lambda kind, number: next(errors))
    found = tally("march", 3)
    assert found == Tally(3, 2, 1, 5.0)
    table = table_of({"march": found}).splitlines()
    assert table[1].split() == ["march", "3", "2", "1", "5"]


def test_the_command_counts(monkeypatch, capsys) -> None:
    monkeypatch.setattr(certificates, "QUICK", {"splats, man": 4})
    assert main(["bench", "certificates", "--quick", "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert (row["kind"], row["scenes"], row["failed"]) == ("splats, man", 4, 0)
    assert main(["bench", "certificates", "--quick", "--only", "splats-man"]) == 0
    table = capsys.readouterr().out.splitlines()
    assert len(table) == 2
    assert table[1].split()[:3] == ["splats,", "man", "4"]
    assert main(["bench", "noise", "--only", "march"]) == 2
    assert "--only: expected none beside noise" in capsys.readouterr().err
    assert main(["bench", "certificates", "--plot", "a.png"]) == 2
    assert "--plot: expected none beside certificates" in capsys.readouterr().err
