"""A Dask cluster draws frames: real workers, the same bits, a job that goes on."""

from __future__ import annotations

from pathlib import Path

import pytest

from refcloud import Moves, animate

pytestmark = [
    pytest.mark.cluster,
    # What Dask leaves open at its own end is not ours.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


def files(folder: Path) -> list[bytes]:
    return [path.read_bytes() for path in sorted(folder.glob("frame-*.png"))]


def test_a_dask_cluster_draws_the_same_bits(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="needs dask[distributed]")
    job = {
        "cloud": "man-10",
        "moves": Moves(turn_eye=360.0),
        "frames": 6,
        "width": 32,
        "height": 24,
        "tolerance": 1 / 255,
    }
    animate(path=tmp_path / "here", **job)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        executor = client.get_executor()
        made = animate(path=tmp_path / "cluster", executor=executor, **job)
        assert made.kept == 0
        # The frames were drawn by other processes.
        workers = client.run(_drew)
        assert len(workers) == 2
        assert all(workers.values())
        (tmp_path / "cluster" / "frame-0003.png").unlink()
        again = animate(path=tmp_path / "cluster", executor=executor, **job)
        assert again.kept == 5
    assert len(files(tmp_path / "cluster")) == 6
    assert files(tmp_path / "cluster") == files(tmp_path / "here")


def _drew() -> bool:
    import sys

    return "refcloud.animation.frames" in sys.modules
