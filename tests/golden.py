"""Golden pictures: what is stored, what passes, and how a picture is renewed.

``NAME.png`` holds 8-bit sRGB codes without tone curve or dither, ``probes.toml`` a few
linear pixels of each scene in full precision, and ``index.toml`` why each picture
looks as it does since it last changed. Pixels are compared, never bytes of files.
"""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np

from refcloud.image import Comparison, Picture, compare_codes, read_png, write_png

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "golden_images"
FAILURES = ROOT / "golden_failures"

CODES = 1  # no channel may be off by more
FRACTION = 0.001  # nor more than this share of the pixels be off at all
GAIN = 10  # of the difference in a failure's sheet
LONGEST_SIDE = 192
MOST_BYTES = 3_000_000
PROBE_RTOL = 1e-9  # far above the last bits in which processors differ
PROBE_ATOL = 1e-12  # of displayed white, for pixels that are nearly black
# Where probes lie, as shares of height and width; the brightest pixel is added, since
# that is where an 8-bit picture is cut off at white.
PLACES = ((0.5, 0.5), (0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75))

# JSON writes this one sign as it is; TOML forbids it.
DELETE, ESCAPED_DELETE = "\x7f", "\\u007f"


def golden_codes(picture: Picture) -> np.ndarray:
    return picture.codes(tone="none", dither=False)


def linear_pixels(picture: Picture) -> np.ndarray:
    if picture.alpha is None:
        return picture.linear
    return np.concatenate([picture.linear, picture.alpha[..., None]], axis=-1)


def check_picture(
    name: str, picture: Picture, folder: Path = FOLDER, failures: Path = FAILURES
) -> None:
    """Fail unless the picture passes for the stored one; then leave a sheet to see."""
    new, sheet = golden_codes(picture), failures / f"{name}.png"
    stored = folder / f"{name}.png"
    assert max(new.shape[:2]) <= LONGEST_SIDE, f"{name}: long side over {LONGEST_SIDE}"
    assert stored.exists(), f"{name}: no golden picture; pytest --regenerate {name}"
    old = read_png(stored)
    if old.shape != new.shape:
        failures.mkdir(exist_ok=True)
        write_png(sheet, new)
        raise AssertionError(f"{name}: stored {old.shape}, drawn {new.shape}: {sheet}")
    found = compare_codes(old, new, codes=CODES, fraction=FRACTION)
    if found.same:
        sheet.unlink(missing_ok=True)
        return
    failures.mkdir(exist_ok=True)
    write_png(sheet, failure_sheet(old, new))
    raise AssertionError(f"{name}: {describe(found, old, new)}\n  see {sheet}")


def describe(found: Comparison, old: np.ndarray, new: np.ndarray) -> str:
    lines = [
        f"off by up to {found.worst} codes (allowed {CODES}),"
        f" {found.off_share:.3%} of pixels off (allowed {FRACTION:.1%})"
    ]
    for row, column, worst in found.worst_pixels:
        was, is_now = old[row, column].tolist(), new[row, column].tolist()
        lines.append(f"  row {row}, column {column}: {was} -> {is_now}, off by {worst}")
    return "\n".join(lines)


def failure_sheet(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Lay old, new and their difference side by side; alpha as grey below colours."""
    off = np.abs(old.astype(int) - new)
    difference = np.minimum(GAIN * off, 255).astype(np.uint8)
    row = np.concatenate([old, new, difference], axis=1)
    colours, alpha = row[..., :3], row[..., 3:]
    if alpha.size:
        return np.concatenate([colours, np.repeat(alpha, 3, axis=-1)])
    return colours


def check_probes(name: str, picture: Picture, folder: Path = FOLDER) -> None:
    """Fail unless the stored pixels are those of the picture in full precision."""
    stored = read_toml(folder / "probes.toml").get(name)
    assert stored is not None, f"{name}: no probes; pytest --regenerate {name}"
    pixels = linear_pixels(picture)
    for row, column, *expected in stored["pixels"]:
        np.testing.assert_allclose(
            pixels[row, column],
            expected,
            rtol=PROBE_RTOL,
            atol=PROBE_ATOL,
            err_msg=f"{name}: linear pixel at row {row}, column {column}",
        )


def check_folder(scenes: set[str], folder: Path = FOLDER) -> None:
    """Fail where scenes, pictures, probes and reasons are not the same names."""
    for what, names in {
        "pictures": {path.stem for path in folder.glob("*.png")},
        "probes.toml": set(read_toml(folder / "probes.toml")),
        "index.toml": set(read_toml(folder / "index.toml")),
    }.items():
        assert not scenes - names, f"{what}: nothing for {sorted(scenes - names)}"
        assert not names - scenes, f"{what}: no scene {sorted(names - scenes)}"
    for name, row in read_toml(folder / "index.toml").items():
        assert row["why"].strip(), f"index.toml: say why {name} looks as it does"
    size = sum(path.stat().st_size for path in folder.iterdir())
    assert size <= MOST_BYTES, f"{size} bytes in the folder, allowed {MOST_BYTES}"


def regenerate(name: str, picture: Picture, folder: Path = FOLDER) -> None:
    """Store a picture and its probes; its reason is emptied, to be written by hand."""
    write_png(folder / f"{name}.png", golden_codes(picture))
    pixels = linear_pixels(picture)
    height, width = pixels.shape[:2]
    places = [(int(height * y), int(width * x)) for y, x in PLACES]
    brightest = int(picture.linear.sum(axis=-1).argmax())
    places.append((brightest // width, brightest % width))
    probes = [[row, column, *pixels[row, column].tolist()] for row, column in places]
    _store(folder / "probes.toml", name, {"pixels": probes})
    _store(folder / "index.toml", name, {"why": ""})


def read_toml(path: Path) -> dict:
    return tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def _store(path: Path, name: str, row: dict) -> None:
    table = read_toml(path) | {name: row}
    path.write_text(format_toml(table), encoding="utf-8", newline="\n")


def format_toml(table: dict[str, dict]) -> str:
    """Write tables of texts and lists of numbers, in the order of their names.

    JSON writes nearly all as TOML does; every float comes back to the last bit.
    """
    parts = []
    for name in sorted(table):
        lines = [f"[{name}]"]
        for key, value in table[name].items():
            if isinstance(value, list):
                rows = "".join(f"  {json.dumps(row)},\n" for row in value)
                lines.append(f"{key} = [\n{rows}]")
            else:
                text = json.dumps(value, ensure_ascii=False)
                lines.append(f"{key} = {text.replace(DELETE, ESCAPED_DELETE)}")
        parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)
