"""Bad input: status 2, one line that says what to do, and nothing half-written."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import refcloud.cli.animate
import refcloud.cli.approximate
import refcloud.cli.compare
import refcloud.cli.figure
import refcloud.cli.generate
import refcloud.cli.render

from .conftest import contents

ROOT = Path(__file__).parents[2]
RENDER = "render balls.npz"
BAD = {
    # files
    "approximate none.npz": "none.npz: expected a refcloud.voxels file, got no such",
    "approximate folder.npz": "got a folder",
    "approximate text.npz": r"\.(npz|png): expected a .* \.npz",
    "approximate truncated.npz": r"\.(npz|png): expected a .* \.npz",
    "approximate balls.npz": "got format 'refcloud.metaballs'",
    "approximate flat.npz": r"density of shape \(D, H, W\), got .*\(2, 3\)",
    "approximate a.png": r"\.(npz|png): expected a .* \.npz",
    "render none.npz": "none.npz: expected a cloud map, metaballs or .*, got no such",
    "render folder.npz": "got a folder",
    "render text.npz": r"text.npz: expected a cloud map, .*no whole .npz",
    "render truncated.npz": r"npz: expected a cloud map, .*no whole .npz",
    "render other.npz": "a cloud map, metaballs or levels .*, got format 'demo'",
    "render a.png": r"a.png: expected a cloud map, metaballs or levels \(.npz",
    "render .": r"WHAT: expected a file .*, got \., no file",
    "animate .": r"WHAT: expected a file .*, got \., no file",
    "render future.npz": "version 1 or older, got version 2; update",
    "render shape.npz": r"radii of shape \(N.*, got .*\(2, 2\)",
    "render uneven.npz": r"N = 2.*, got .*\(3,\)",
    "render negative.npz": r"negative.npz: radii: expected numbers in \(0, inf\)",
    "render nan.npz": "nan.npz: .*finite numbers, got 6 NaN",
    "render kernel.npz": "kernel.npz: kernel: expected one of 'wyvill'",
    "render flat.npz": r"density of shape \(D, H, W\)",
    # scenes
    "render cumulos": "WHAT: expected .*cumulus, .*man-04.*, got 'cumulos'",
    "render cumulus --eye 1 19 0": "another place than the eye",
    "render cumulus --g 0.5 --phase isotropic": "--g: expected none beside --phase",
    "render cumulus --irradiance 1 1 1 --irradiance 2 2 2": "got 2",
    "render cumulus --density 2": "--density: expected none beside a scene, got one",
    "render cumulus --sun 0 0 0": "--sun: expected a vector that is not zero",
    "render simple-sky --fov-y 1": "--fov-y: expected none beside simple-sky, which",
    "render shader-a --eye 0 0 9": "--eye: expected none .*, which has no camera",
    "render shader-c --g 0.5": "--g: expected none .*, which has no medium",
    "render demand-quad --sun 0 1 0": "--sun: expected none .*, which has no sun",
    "render shader-c --irradiance 1 1 1": "--sun: expected it .*; shader-c has no sun",
    "render cumulus --background sky": "background: expected none beside a scene",
    "render cumulus --width 1000000 --height 1000000": "at most 8.3 megapixels",
    "render man-14 --width 20000 --height 3000": "megapixels .*, got 20000 x 3000",
    "render man-10 --width 6000 --height 4500": "megapixels .*, got 6000 x 4500",
    "render man-10 --width 4000": "megapixels .*, got 4000 x 3000; make the picture",
    f"{RENDER} --height 4500": "megapixels .*, got 6000 x 4500",
    "animate man-10 --frames 2 --turn-eye 9 --width 6000": "got 6000 x 4500",
    "noise fbm --size 2048 --view octaves": "size: expected panels .*, got 8 of 2048",
    "noise fbm --size 2048 --view channels": "size: .*, got 4 of 2048 x 2048; choose",
    # animations
    "animate man-10": "--frames: expected how many pictures, got none",
    "animate man-10 --frames 0": r"--frames: .*\[1, 100000\], got 0",
    "animate man-10 --frames 3": r"moves: .* \(--turn-sun, --turn-eye, --wind\)",
    "animate demand-sky --frames 3": r"moves: .* \(none: it cannot move\)",
    "animate demand-sky --frames 3 --turn-eye 9": "--turn-eye: expected none for dem",
    "animate man-10 --frames 3 --time 0 1": (
        "^refcloud: --time: .* man-10, which .*: --turn-sun, --turn-eye, --wind$"
    ),
    "animate man-10 --frames 3 --time 0": "--time: expected two numbers, got '0'",
    "animate man-10 --frames 3 --turn-eye 9 -o a.mp4": "ending in .png or .apng or",
    "animate man-10 --frames 3 --turn-eye 9 -o no/a": "a name in an existing folder",
    "animate balls.npz --frames 2 --turn-eye 9 --background transparent -o a.gif": (
        "--output: expected an opaque background in .gif"
    ),
    # options given twice
    "generate --voxel 5 --voxel 4": "--voxel: expected it once, got it twice; leave",
    "generate -o x.npz -o y.npz": "--output: expected it once, got it twice",
    "generate -ox.npz --output=y.npz": "--output: expected it once, got it twice",
    f"{RENDER} --dither --no-dither": "--dither: expected it once, got it twice",
    # values
    "generate --octaves 0": r"--octaves: expected a whole number in \[1, 32\], got 0",
    "generate --octaves 2.5": "whole number in .*, got '2.5'",
    "generate --persistence nan": r"finite number in \(0, 1\], got nan",
    "generate --persistence 1.5": r"--persistence: .*, got 1.5; choose within",
    "generate --persistence 1/0": "finite number in .*, got '1/0'",
    "generate --persistence much": "--persistence: .*, got 'much'",
    "generate --threshold 0.2": "--threshold: expected none beside --shape cumulus",
    "generate --shape ellipsoid --relief 2": "--relief: .*; --shape cumulus has it",
    "generate --shape cube": "--shape: expected one of 'cumulus', 'ellipsoid', got",
    "generate --diameters 1 2": "--diameters: expected three numbers, got '1 2'",
    "generate --diameters 1 2 3 4": "three numbers, got '1 2 3 4'",
    "generate --diameters 1 b 3": "three numbers, got '1 b 3'",
    "generate --diameters 1 -2 3": r"numbers in \[1e-100, 1e\+100\] .*, got -2 to 3",
    "generate --diameters 1 inf 3": "--diameters: expected finite numbers",
    "generate --diameters 1e300 1e300 1e300": "expected",
    "generate --voxel 1e-9": "--voxel: .* choose a larger --voxel or a sma",
    "generate --voxel -1e-3": r"--voxel: .*, got -0.001",
    "generate --seed 9223372036854775808": "--seed: expected a whole number in",
    f"generate --seed {'9' * 400}": "expected",
    f"{RENDER} --width 0": r"--width: .*\[1, .*, got 0",
    f"{RENDER} --width 1000000 --height 1000000": "got 1000000 x 1000000; make the",
    f"{RENDER} --tolerance 2": r"--tolerance: .*\[0, 1\] \(displayed white\), got 2",
    f"{RENDER} --sun 0 0 0": r"--sun: expected a vector that is not zero",
    f"{RENDER} --sun 1 0 0 --sun 0 1": "--sun: expected three numbers, got '0 1'",
    f"{RENDER} --irradiance -1 1 1": "--irradiance: expected numbers in",
    f"{RENDER} --sun 1 0 0 --irradiance 1 1 1 --irradiance 2 2 2": "got 2",
    f"{RENDER} --eye 0 0 0 --target 0 0 0": "another place than the eye",
    f"{RENDER} --up 0 0 0": "up: expected a vector that is not zero",
    f"{RENDER} --fov-y 4": "--fov-y: .* got 4; in radians, 4 degrees are 0.06981",
    f"{RENDER} --fov-y 90": "--fov-y: .*; in radians, 90 degrees are 1.571",
    f"{RENDER} --g 0.9 --phase rayleigh": "--g: expected none beside --phase rayleigh",
    "noise worley": r"KIND: .*, got 'worley'; did you mean worley_f1\?",
    "noise perlin": r"KIND: .*, got 'perlin'; did you mean gradient\?",
    "approximate voxels.npz --least-radius 5e3": (
        "--overlap or --least-radius: .*; lower --overlap or --least-radius, or use la"
    ),
    f"{RENDER} --sigma-t 1 2": "--sigma-t: expected a number or three numbers",
    f"{RENDER} --albedo 1.1": r"--albedo: .*\[0, 1\], got 1.1",
    f"{RENDER} --background blue": "sky or transparent or three numbers, got 'blue'",
    f"{RENDER} --exposure 0": r"--exposure: .*\(0, 1e\+06\], got 0",
    # outputs
    "generate -o no/a.npz": "--output: expected a name in an existing folder, got no",
    "generate -o a.txt": "--output: expected a name ending in .npz, got 'a.txt'",
    "generate -o folder.npz": "--output: expected a file's name, got the folder",
    f"generate -o {'n' * 300}.npz": "--output: expected a file that can be written",
    "generate -o=": "--output: expected a name, got an empty text",
    "animate man-10 --frames 3 --turn-eye 10 -o=": "--output: .*, got an empty text",
    "render man-10 -o=": "--output: expected a name, got an empty text",
    "figure --all --output=": "--output: expected a name, got an empty text",
    "scene man-10 -o=": "--output: expected a name, got an empty text",
    "noise fbm -o=": "--output: expected a name, got an empty text",
    "compare a.png a.png -o=": "--output: expected a name, got an empty text",
    "approximate voxels.npz -o=": "--output: expected a name, got an empty text",
    "approximate voxels.npz --picture=": "--picture: .*, got an empty text",
    "bench noise --plot=": "--plot: expected a name, got an empty text",
    "approximate voxels.npz -o a.npy": "--output: expected a name ending in .npz",
    "approximate voxels.npz --picture a.jpg": "--picture: expected a name ending in",
    "approximate voxels.npz --picture no/a.png": "--picture: .* folder, got no; create",
    "approximate voxels.npz --count 3 --tolerance 0.1": (
        "^refcloud: --tolerance: expected none beside --count, got"
    ),
    "render voxels.npz --backend gl": (
        "^refcloud: --backend: expected none beside --method march, got one; choose"
        " --method splat, or leave --backend out$"
    ),
    f"{RENDER} --ambient 1 1 1": (
        "^refcloud: --ambient: .*; choose --method march, or leave --ambient out$"
    ),
    f"{RENDER} --width 5000": r"^refcloud: --width: expected at most 8\.3 megapixels",
    f"{RENDER} --darkness-threshold 0.5": (
        "^refcloud: --darkness-threshold: expected none beside --method splat, got one;"
        " choose --method march, or leave --darkness-threshold out$"
    ),
    "render voxels.npz --scattering multiple --darkness-threshold 0.5": (
        "^refcloud: --darkness-threshold: expected none beside --scattering multiple, g"
    ),
    f"{RENDER} --eye 1e300 0 0": "^refcloud: --eye: expected places and lengths of at",
    "render man-10 --target 0 1e300 0": "^refcloud: --target: expected places and",
    f"{RENDER} --irradiance 1e300 1 1": "^refcloud: --irradiance: expected light of at",
    "render cumulus --irradiance 1 1e300 1": "^refcloud: --irradiance: expected light",
    f"{RENDER} --tolerance 1.0000001": r"--tolerance: .* \[0, 1\] .*, got 1\.0000001;",
    f"render {'n' * 5000}.npz": "^refcloud: WHAT: expected a name of at most 255 bytes",
    f"animate {'n' * 5000}.npz": "^refcloud: WHAT: expected a name of at most 255 byt",
    f"approximate {'n' * 5000}.npz": "^refcloud: IN.npz: expected a name of at most 2",
    f"compare a.png {'n' * 5000}.png": "^refcloud: B: expected a name of at most 255 b",
    "render formless.npz": "formless.npz: expected a cloud map, .*tells no format$",
    "render versionless.npz": "versionless.npz: .*, got one that tells no version$",
    "approximate versionless.npz": "versionless.npz: .*, got one that tells no ver",
    "render man-10 --method splat": "^refcloud: --method: expected none beside a scene",
    "animate man-10 --frames 2 --turn-sun 9 --sun-axis 0 0 0": "^refcloud: --sun-axis:",
    "approximate voxels.npz --count 0": r"--count: .* in \[1, 1000000\], got 0",
    "approximate voxels.npz --count 1000000000": r"--count: .* got 1000000000; choose",
    "approximate voxels.npz --tolerance -1": r"--tolerance: .* in \(0, 1\), got -1",
    "approximate voxels.npz --method man --rim 2": (
        "^refcloud: --rim: expected none beside --method man, got one; what takes it:"
        " --method quick, standard, full$"
    ),
    "approximate voxels.npz --method man --rounds 3": "--rounds: expected none beside",
    "approximate voxels.npz --method man --least-radius 2": (
        "--least-radius: .*--method man, got one; what takes it: .*, orthogonal, subtr"
    ),
    "approximate voxels.npz --method subtract --overlap 3": "--overlap: .* quick, sta",
    "approximate voxels.npz --method quick --refine-steps 3": "--refine-steps: .* full",
    "bench --quick": "--quick: expected none without WHAT, got one",
    "bench --json": "--json: expected none without WHAT, got one",
    "bench --plot a.png": "--plot: expected none without WHAT, got one",
    "bench --only balls": "--only: expected ",
    "bench stability --peers": "--peers: expected none beside stability, which has no",
    "figure man-10 --jobs 2": "--jobs: expected none beside one figure, got one",
    "figure --list --quick": "--quick: expected none beside --list, got one",
    "figure --list --jobs 2": "--jobs: expected none beside --list, got one",
    "figure --list -o a.png": "--output: expected none beside --list, got one",
    "approximate voxels.npz --method blob": "--method: expected one of .*'blob'",
    "approximate voxels.npz --levels --count 3": "--levels: .*, got --count",
    "bench noise --plot a.jpg": "--plot: expected a name ending in .png",
    f"{RENDER} -o a.jpg": "--output: expected a name ending in .png or .npy",
    "compare a.png a.png -o no/d.png": "--output: expected a name in an existing",
    # pictures
    "compare a.png none.png": "none.png: ",
    "compare a.png broken.png": "broken.png: ",
    "compare a.png voxels.npz": "^refcloud: B: expected a picture, by a name ending in",
    "compare p.jpg p.jpg": "^refcloud: A: .* in .png or .npy, got 'p.jpg'$",
    "compare a.png small.png": "small.png: expected 6 x 4 pixels of 3 .*, got 6 x 3",
    "compare a.png a.png --codes 256": r"--codes: .*\[0, 255\] \(codes\), got 256",
    # the line itself
    "": "command: expected one of generate, .*, got none; see refcloud --help",
    "renter": "command: expected one of .*, got 'renter'",
    "generate --octave 3": "--octave: .*unknown one; did you mean --octaves?",
    "generate --zzz 3": "--zzz: .*unknown one; see refcloud generate --help",
    "generate -z": "-z: expected an option of refcloud generate",
    "generate --octaves": "--octaves: expected INT, got no value",
    "generate --octaves --seed 1": "--octaves: expected INT, got no value",
    "generate -o": "-o: expected FILE, got no value",
    "generate a.npz": "arguments: expected none, got also 'a.npz'",
    f"{RENDER} --dither=yes": "--dither.*see refcloud render --help",
    "render": "WHAT: expected a name, got none; see refcloud render --help",
    "compare a.png": "B: expected a name, got none",
    "compare a.png a.png a.png": "arguments: expected 2: A B, got also 'a.png'",
    "list cumulus": "arguments: expected none, got also 'cumulus'",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_refused_in_one_line(line, run, here: Path) -> None:
    before = contents(here)
    status, out, err = run(*line.split())
    assert (status, out) == (2, "")
    assert err.endswith("\n")
    assert err.count("\n") == 1
    assert err.startswith("refcloud: ")
    assert re.search(BAD[line], err), err
    assert contents(here) == before


@pytest.mark.parametrize(
    "line", ["render truncated.npz", "generate --persistence 2", "renter", "--zzz"]
)
def test_the_program_itself_refuses_in_one_line(line, here: Path) -> None:
    before = contents(here)
    done = subprocess.run(
        [sys.executable, "-m", "refcloud", *line.split()],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("refcloud: ")
    assert done.stderr.count("\n") == 1
    assert contents(here) == before


def never(*words: object, **options: object) -> None:
    raise AssertionError("the work began before the output was tried")


@pytest.mark.parametrize("name", ["no/a.npz", "a.txt", "folder.npz", "/closed/a.npz"])
def test_outputs_are_refused_before_the_work(name, run, here, monkeypatch) -> None:
    monkeypatch.setattr(refcloud.cli.generate, "generate", never)
    assert run("generate", "-o", name).status == 2


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_pipes_and_links_to_nowhere_are_found_before_the_work(
    run, here, monkeypatch
) -> None:
    os.mkfifo("pipe.npz")
    Path("lost.npz").symlink_to("no/a.npz")
    monkeypatch.setattr(refcloud.cli.generate, "generate", never)
    for name, line in (
        ("pipe", "expected the name of a plain file, got pipe.npz, a pipe or a device"),
        (
            "lost",
            f"expected a name in an existing folder, got {here / 'no'}; create it",
        ),
    ):
        status, _, err = run("generate", "-o", f"{name}.npz")
        assert status == 2
        assert err.startswith(f"refcloud: --output: {line}"), err


def test_an_output_that_is_a_link_stays_one(run, here) -> None:
    Path("there.npz").symlink_to("made.npz")
    small = "--diameters 8 6 6 --relief 1 --voxel 1 -o there.npz"
    assert run("generate", *small.split()).status == 0
    assert Path("there.npz").is_symlink()
    assert Path("made.npz").is_file()


def test_a_closed_folder_is_found_before_the_work(run, here, monkeypatch) -> None:
    def closed(path: Path, *how: object) -> None:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(refcloud.cli.generate, "generate", never)
    monkeypatch.setattr(refcloud.cli.render, "render", never)
    monkeypatch.setattr(Path, "open", closed)
    monkeypatch.setattr(Path, "mkdir", closed)
    monkeypatch.setattr(refcloud.cli.animate, "animate", never)
    monkeypatch.setattr(refcloud.cli.figure, "draw_all", never)
    animate = "animate balls.npz --frames 2 --turn-eye 9"
    for line, kind in {
        "generate": "file",
        "render cumulus": "file",
        "render balls.npz": "file",
        animate: "file",
        f"{animate} -o new": "folder",
        f"{animate} -o folder.npz": "folder",
        "figure --all -o new": "folder",
        "figure --all": "folder",
    }.items():
        status, _, err = run(*line.split())
        assert status == 2, err
        assert err.startswith(f"refcloud: --output: expected a {kind} that can be")
        assert "(Permission denied); choose another name or folder" in err


@pytest.mark.parametrize(
    "line",
    [
        "approximate voxels.npz --count 5 -o voxels.npz",
        "approximate voxels.npz --count 5 -o linked.npz",
        "approximate voxels.npz --count 5 -o b.npz --picture linked.png",
        "approximate voxels.npz --levels -o ./voxels.npz",
        "compare a.png small.png -o a.png",
        "compare a.png small.png -o ./small.png",
        "compare a.png small.png -o other.png",
        "render voxels.npz -o linked.png",
        "animate voxels.npz --frames 2 --turn-eye 9 -o linked.png",
    ],
)
def test_no_input_is_written_over(line, run, here, monkeypatch) -> None:
    Path("linked.npz").hardlink_to("voxels.npz")
    Path("linked.png").symlink_to("voxels.npz")
    Path("other.png").hardlink_to("small.png")
    monkeypatch.setattr(refcloud.cli.approximate, "load_voxels", never)
    monkeypatch.setattr(refcloud.cli.compare, "codes_of", never)
    monkeypatch.setattr(refcloud.cli.render, "load", never)
    before = contents(here)
    status, out, err = run(*line.split())
    assert (status, out) == (2, "")
    assert re.fullmatch(
        r"refcloud: --(output|picture): expected another file than those that are"
        r" read, got \S+; choose another name\n",
        err,
    ), err
    assert contents(here) == before


@pytest.mark.parametrize("line", ["render", "animate", "noise", "compare a.png"])
def test_an_empty_argument_is_refused_as_such(line, run, here) -> None:
    status, _, err = run(*line.split(), "")
    assert status == 2
    assert re.fullmatch(r"refcloud: \w+: expected a name, got an empty text\n", err)


def test_a_file_name_may_hold_anything(run, here) -> None:
    status, _, err = run("render", "a\nb\udcff.npz")
    assert status == 2
    assert err.count("\n") == 1
