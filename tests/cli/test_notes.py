"""What the commands say of their choices is what the picture was made with."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import refcloud as rc
import refcloud.cli.animate

SIZE = "--width 16 --height 12"
MAN = f"medium: tau {rc.lighting.named('man').tau:g} for every ball, albedo"


@pytest.mark.parametrize(
    ("line", "note"),
    [
        ("balls.npz --density 0", "optical depth 0 in the middle"),
        ("balls.npz --density .05", "optical depth 2 in the middle"),
        ("balls.npz --density 1e6", "optical depth 4e+07 in the middle"),
        ("voxels.npz --density .05", "optical depth 0.8 in the middle"),
        ("balls.npz --look man", f"{MAN} 0.9\n"),
        ("balls.npz --look man --albedo 0", f"{MAN} 0\n"),
        ("balls.npz --look man --sigma-t 7", f"{MAN} 0.9; no sigma_t counts\n"),
        ("balls.npz --look man --density 2", f"{MAN} 0.9; no density counts\n"),
        ("man-10 --sigma-t 7 --albedo .5", f"{MAN} 0.5; no sigma_t counts\n"),
    ],
)
def test_the_medium_is_told_as_it_is(line: str, note: str, run, here: Path) -> None:
    ended = run(*f"render {line} {SIZE} -o a.png".split())
    assert ended.status == 0, ended.err
    assert note in ended.out


def test_the_paper_s_albedo_stays_beside_a_sigma_t(run, here: Path) -> None:
    for extra, name in (("", "a.npy"), ("--sigma-t 7", "b.npy")):
        run(*f"render balls.npz --look man {SIZE} {extra} -o {name}".split())
    one, other = (rc.load_picture(name).linear for name in ("a.npy", "b.npy"))
    np.testing.assert_array_equal(one, other)


def test_an_empty_cloud_is_told(run, here: Path) -> None:
    ended = run(*"generate --shape ellipsoid --threshold 0.99 --voxel 4".split())
    assert ended.status == 0, ended.err
    assert "the cloud is empty: no voxel is occupied\n" in ended.out


@pytest.mark.parametrize(
    ("there", "more", "line"),
    [
        (0, "", "interrupted\n"),
        (1, "", "interrupted; 1 frame is in a.png.frames, and the same command again"),
        (
            2,
            "",
            "interrupted; 2 frames are in a.png.frames, and the same command again",
        ),
        (2, "--redraw", "the same command again without --redraw goes on from there\n"),
    ],
)
def test_an_interrupted_animation_says_what_is_there_and_how_it_goes_on(
    there, more, line, run, here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*words: object, **options: object) -> None:
        Path("a.png.frames").mkdir()
        for k in range(there):
            Path(f"a.png.frames/frame-000{k}.png").touch()
        raise KeyboardInterrupt

    monkeypatch.setattr(refcloud.cli.animate, "animate", interrupted)
    ended = run(*f"animate man-10 --frames 9 --turn-eye 9 -o a.png {more}".split())
    assert ended.status == 130
    assert line in ended.err
    assert ended.err.count("\n") == 1


def test_a_file_s_name_in_place_of_a_scene_s_is_told_what_to_do() -> None:
    with pytest.raises(ValueError, match=r"got 'mine.toml'; a file: .*load_scene"):
        rc.render("mine.toml")


def test_the_level_s_note_says_which_tolerance_takes_fewer_balls(
    run, here: Path
) -> None:
    grid = rc.VoxelGrid(np.ones((4, 4, 4)), [0, 0, 0], [1, 1, 1])
    rc.metaballs.save_levels(rc.levels_of_detail(grid, counts=(2, 20)), "levels.npz")
    ended = run(*f"render levels.npz --fov-y 2.5 {SIZE} --tolerance 0".split())
    found = re.search(r"level of 20 balls, at .* 2 from --tolerance (\S+)\n", ended.out)
    assert found, ended.out
    again = run(*f"render levels.npz --fov-y 2.5 {SIZE} --tolerance {found[1]}".split())
    assert re.search(r"level of 2 balls, at \S+ % of the picture\n", again.out)


def test_one_ball_is_no_balls(run, here: Path) -> None:
    out = run(*"approximate voxels.npz --count 1 -o one.npz".split()).out
    assert "voxels in a grid of 4 x 3 x 2: 1 ball\n" in out
    assert "one.npz: 1 ball\n" in run(*f"render one.npz {SIZE} -o a.png".split()).out
    assert (
        "balls.npz: 2 balls\n" in run(*f"render balls.npz {SIZE} -o b.png".split()).out
    )
    one = rc.VoxelGrid(np.ones((1, 1, 1)), [0, 0, 0], [1, 1, 1])
    rc.save_voxels(one, "single.npz")
    out = run(*f"render single.npz --method splat {SIZE} -o c.png".split()).out
    assert "single.npz: 1 occupied voxel in a grid of 1 x 1 x 1\n" in out
    assert "drawn as one ball per occupied voxel: 1 ball\n" in out
