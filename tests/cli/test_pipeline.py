"""The three programs in a row give what one Python process gives, to the byte."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import refcloud as rc
from refcloud.fit_pictures import fit_pictures

SMALL = "--diameters 20 11 11 --cell 3 --relief 2 --voxel 1"
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def cloud() -> tuple[rc.VoxelGrid, rc.Metaballs]:
    grid = rc.generate(diameters=[20, 11, 11], cell=3, relief=2, voxel=1)
    return grid, rc.approximate(grid, count=40)


@pytest.fixture
def small(cloud, here: Path) -> Path:
    rc.save_voxels(cloud[0], "small-voxels.npz")
    rc.save_metaballs(cloud[1], "small.npz")
    return here


def same_bytes(picture: rc.Picture, path: str, **saving: object) -> bool:
    picture.save("expected.png", **saving)  # pyright: ignore[reportArgumentType]
    return Path(path).read_bytes() == Path("expected.png").read_bytes()


def test_three_programs_equal_one_process(cloud, here: Path) -> None:
    for line in (
        f"generate -o a.npz {SMALL}",
        "approximate a.npz -o b.npz --count 40",
        "render b.npz -o c.png --width 96 --height 72",
    ):
        done = subprocess.run(
            [sys.executable, "-m", "refcloud", *line.split()],
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[-1] == re.findall(r"-o (\S+)", line)[0]
    grid, balls = cloud
    assert rc.load_voxels("a.npz").density.tobytes() == grid.density.tobytes()
    assert rc.load_metaballs("b.npz").radii.tobytes() == balls.radii.tobytes()
    assert same_bytes(rc.render(balls, width=96, height=72, tolerance=1 / 255), "c.png")


def test_generate_takes_every_option_to_the_library(run, here) -> None:
    line = (
        "--shape ellipsoid --seed -3 --diameters 12 8 8 --voxel 1 --octaves 2"
        " --persistence 1/4 --cell 4 --interpolant quintic --normalize bound"
        " --threshold 0.05 --dynamics 0.5 --ellipsoids 2"
    )
    status, out, err = run("generate", *line.split())
    assert (status, err) == (0, "")
    assert out.splitlines()[-1] == "ellipsoid-seed-3-voxels.npz"
    expected = rc.generate(
        "ellipsoid",
        seed=-3,
        diameters=[12, 8, 8],
        voxel=1,
        octaves=2,
        persistence=0.25,
        cell=4,
        interpolant="quintic",
        normalize="bound",
        threshold=0.05,
        dynamics=0.5,
        ellipsoids=2,
    )
    found = rc.load_voxels("ellipsoid-seed-3-voxels.npz")
    np.testing.assert_array_equal(found.density, expected.density)
    np.testing.assert_array_equal(found.lower, expected.lower)
    assert f"{np.count_nonzero(expected.density)} occupied voxels" in out


@pytest.mark.parametrize("method", ["quick", "man"])
def test_approximate_prints_the_errors_of_what_it_wrote(
    method, cloud, run, small
) -> None:
    status, out, err = run(
        "approximate", "small-voxels.npz", "--count", 20, "--method", method
    )
    assert (status, err) == (0, "")
    name = out.splitlines()[-1]
    balls = rc.load_metaballs(name)
    assert name == f"small-{len(balls)}balls.npz"
    errors = rc.errors_of_fit(cloud[0], balls)
    assert f"{len(balls)} balls\n" in out
    assert f"over all voxels: {errors.density:.4f}\n" in out
    assert f"over occupied voxels: {errors.occupied:.4f}\n" in out
    x, y, z = errors.projected
    assert f"optical depth: x {x:.4f}, y {y:.4f}, z {z:.4f}\n" in out
    shown = fit_pictures(cloud[0], balls)
    assert f"rendered picture: {shown.error:.4f}\n" in out
    assert "seconds: load " in out


def test_approximate_draws_what_it_fitted_and_says_what_it_tried(
    cloud, run, small
) -> None:
    status, out, _ = run(
        "approximate", "small-voxels.npz", "--tolerance", 0.5, "--picture", "fit.png"
    )
    assert status == 0
    balls = rc.load_metaballs(out.splitlines()[-1])
    expected = rc.approximate(cloud[0], tolerance=0.5)
    assert balls.radii.tobytes() == expected.radii.tobytes()
    tried = re.findall(r"^tried (\d+) balls, relative RMSE (\S+)$", out, re.M)
    assert len(tried) >= 2
    assert rc.errors_of_fit(cloud[0], balls).density <= 0.5
    assert "voxels, balls and difference: fit.png\n" in out
    assert same_bytes(fit_pictures(cloud[0], balls).side_by_side(), "fit.png")


def test_levels_go_from_one_file_to_a_picture(cloud, run, small) -> None:
    done = run("approximate", "small-voxels.npz", "--levels", "--seed", 3)
    assert done.status == 0
    assert done.out.splitlines()[-1] == "small-levels.npz"
    levels = rc.load_levels("small-levels.npz")
    expected = rc.levels_of_detail(cloud[0], seed=3)
    assert levels.finest.radii.tobytes() == expected.finest.radii.tobytes()
    assert done.out.count("rendered picture") == len(levels.levels)
    size = ["--width", 24, "--height", 18]
    coarse = run("render", "small-levels.npz", *size, "--tolerance", 1, "-o", "a.png")
    fine = run("render", "small-levels.npz", *size, "--tolerance", 0, "-o", "b.png")
    assert f"level of {len(levels.finest)} balls, at " in fine.out
    assert f"level of {len(levels.finest)} balls, at " not in coarse.out
    assert same_bytes(rc.render(levels.finest, width=24, height=18), "b.png")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--count", "5", "--tolerance", "0.5"], "tolerance: expected none beside"),
        (["--levels", "--count", "5"], "--levels: expected no other option"),
        (["--picture", "fit.gif"], "expected a name ending in .png or .npy"),
        (["--tolerance", "1"], "--tolerance: expected a finite number in (0, 1)"),
    ],
)
def test_approximate_refuses_in_one_line(words, message, run, small) -> None:
    status, out, err = run("approximate", "small-voxels.npz", *words)
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


def test_render_takes_every_option_to_the_library(cloud, run, small) -> None:
    line = (
        "--width 40 --height 30 --tolerance 0 --look man --seed 5 --eye 1 -2 40"
        " --target 1 2 0 --up 0.1 1 0 --fov-y 0.7 --sun -0.6 0.6 0.4"
        " --sun 1 -1e-1 0 --irradiance 9 8 7 --irradiance 1 2 3 --sigma-t 1 2 3"
        " --albedo 0.8 --g -0.2 --phase hg --background 0.1 0.2 0.3"
        " --exposure 0.8 --tone none --no-dither"
    )
    status, out, err = run("render", *line.split(), "small.npz", "-osmall.png")
    assert (status, err) == (0, "")
    picture = rc.render(
        rc.load_metaballs("small.npz"),
        camera=rc.Camera([1, -2, 40], [1, 2, 0], [0.1, 1, 0], 0.7, width=40, height=30),
        suns=(
            rc.Sun([-0.6, 0.6, 0.4], [9, 8, 7]),
            rc.Sun([1, -0.1, 0], [1, 2, 3]),
        ),
        medium=rc.Medium([1, 2, 3], 0.8, -0.2, "hg"),
        background=[0.1, 0.2, 0.3],
        look="man",
        seed=5,
    )
    assert same_bytes(picture, "small.png", exposure=0.8, tone="none", dither=False)
    assert "small.npz: 40 balls\n" in out
    for row in picture.skipped:
        assert str(row) in out
    assert re.search(r"seconds: load .*light .*eye .*save .*total", out)


def test_parts_that_are_left_out_are_completed(cloud, run, small) -> None:
    size = ["--width", 24, "--height", 18, "--tolerance", 0]
    whole = rc.render(cloud[1], width=24, height=18)
    # The medium's extinction and the camera's target are those of the bare call.
    bare = run("render", "small.npz", *size, "-o", "a.png")
    assert same_bytes(whole, "a.png")
    assert all(note in bare.out for note in whole.notes)
    part = run("render", "small.npz", *size, "--phase", "rayleigh", "-o", "b.png")
    assert same_bytes(whole, "b.png")
    assert "optical depth 40 in the middle" in part.out
    run("render", "small.npz", *size, "--up", 0, 1, 0, "-o", "c.png")
    assert same_bytes(whole, "c.png")
    run("render", "small.npz", *size, "--background", "sky", "-o", "d.png")
    assert same_bytes(whole, "d.png")
    run("render", "small.npz", *size, "--background", "transparent", "-o", "e.png")
    assert rc.load_picture("e.png").alpha is not None


def test_a_cloud_map_may_be_splatted_as_its_voxels(cloud, run, small) -> None:
    size = ["--width", 24, "--height", 18]
    status, out, _ = run(
        "render", "small-voxels.npz", *size, "--look", "man", "--method", "splat"
    )
    assert status == 0
    assert out.splitlines()[-1] == "small-voxels.png"
    how = {"width": 24, "height": 18, "method": "splat", "tolerance": 1 / 255}
    assert same_bytes(rc.render(cloud[0], look="man", **how), "small-voxels.png")
    part = run(
        "render", "small-voxels.npz", *size, "--method", "splat", "--albedo", 0.9
    )
    assert "optical depth 40 in the middle" in part.out


def test_balls_show_every_order_of_scattering(cloud, run, small) -> None:
    line = "render small.npz --scattering multiple --width 16 --height 12 -o many.png"
    status, out, _ = run(*line.split())
    assert status == 0
    assert "scattered light: 2 solutions" in out
    how = {"width": 16, "height": 12, "tolerance": 1 / 255}
    assert same_bytes(rc.render(cloud[1], scattering="multiple", **how), "many.png")


def test_a_cloud_map_is_marched(cloud, run, small) -> None:
    line = (
        "render small-voxels.npz --width 24 --height 18 --tolerance 0 --density 2"
        " --sun -0.6 0.6 0.4 --eye 1 -2 40 --g 0.5 --albedo 0.9 --ambient 0.1 0.1 0.2"
    )
    status, out, err = run(*line.split())
    assert (status, err) == (0, "")
    assert "marched: light that is scattered more than once is left out\n" in out
    assert "optical depth 32 in the middle" in out
    sigma_t = float(re.findall(r"sigma_t (\S+),", out)[0])
    grid = cloud[0]
    dense = rc.VoxelGrid(2.0 * grid.density, grid.lower, grid.upper)
    whole = rc.render(grid, width=24, height=18)
    target = [
        float(v) for v in re.findall(r"target (\S+) (\S+) (\S+)", whole.notes[1])[0]
    ]
    picture = rc.render(
        dense,
        camera=rc.Camera([1, -2, 40], target, width=24, height=18),
        suns=rc.Sun([-0.6, 0.6, 0.4], rc.choices.SUN.irradiance),
        medium=rc.Medium(sigma_t, 0.9, 0.5, "hg"),
        ambient=[0.1, 0.1, 0.2],
    )
    # Both numbers were read from four printed digits.
    written = rc.load_picture("small-voxels.png").linear
    picture.save("expected.png")
    difference = written - rc.load_picture("expected.png").linear
    assert np.abs(difference).max() < 0.02
    refused = run("render", "man-10", "--density", 2)
    assert refused.status == 2
    assert "--density: expected none beside a scene" in refused.err


def test_linear_light_may_be_written(run, small) -> None:
    assert run("render", "small.npz", "--quality", "quick", "-o", "a.npy").status == 0
    assert rc.load_picture("a.npy").linear.shape == (240, 320, 3)


def test_a_scene_takes_camera_and_size(run, here, monkeypatch) -> None:
    seen = {}
    scene = rc.scenes.SCENES["man-10"]

    def draw(model, view):
        seen["view"] = view
        return rc.Picture(np.zeros((view.height, view.width, 3)))

    quick = type(scene)("quick", "a scene for this test", scene.model, draw)
    monkeypatch.setitem(rc.scenes.SCENES, "quick", quick)
    line = "render quick --eye 0 0 50 --target 0 0 0 --width 9 --height 5"
    status, out, err = run(*line.split())
    assert (status, err) == (0, "")
    assert out.splitlines()[-1] == "quick.png"
    assert "30 balls" in out
    view = seen["view"]
    assert (view.width, view.height, view.tolerance) == (9, 5, 1 / 255)
    np.testing.assert_array_equal(view.camera.eye, [0, 0, 50])


@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_frames_of_balls_take_either_kind_of_scattering(scattering, run, here) -> None:
    line = "--turn-eye 9 --frames 2 --width 6 --height 4 --jobs 1 -o x.png"
    words = *line.split(), "--scattering", scattering
    status, out, err = run("animate", "balls.npz", *words)
    assert (status, err) == (0, "")
    assert out.splitlines()[-1] == "x.png"
