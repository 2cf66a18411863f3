"""The picture: linear light, and what its making skipped and took."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Range, Shape, Skipped
from refcloud.files import write_atomically
from refcloud.image import png
from refcloud.image.encode import WHITE, Codes, Exposure, Tone, srgb_decode, to_codes

# Alpha below half a code is written as 0; colours are divided by no less.
LEAST_ALPHA = 0.5 / WHITE


@dataclass(frozen=True, eq=False, repr=False)
class Picture:
    """Linear RGB light, perhaps with how much of what lies behind is covered.

    Attributes
    ----------
    linear
        Shape (H, W, 3), 1 is displayed white, finite, row 0 at the top. With an alpha
        it is the light of the covered part alone (premultiplied), so that the picture
        over a background is ``linear + (1 - alpha) background``.
    alpha
        Shape (H, W), in [0, 1], or None for a picture that covers all.
    skipped
        What the stages left out.
    seconds
        Time of each stage by its name.
    notes
        What was chosen on the caller's behalf, a line each.
    """

    linear: Annotated[Array, Shape("H", "W", 3)]
    alpha: Annotated[Array, Shape("H", "W"), Range(0.0, 1.0)] | None = None
    skipped: tuple[Skipped, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self)
        height, width, _ = self.linear.shape
        png.check_size("linear", width, height)

    def __repr__(self) -> str:
        """Say what it is without its numbers."""
        height, width, _ = self.linear.shape
        alpha = "" if self.alpha is None else ", with alpha"
        return f"Picture({width} x {height}{alpha}, brightest {self.linear.max():.4g})"

    @checked
    def codes(
        self, *, exposure: Exposure = 1.0, tone: Tone = "shoulder", dither: bool = True
    ) -> Codes:
        """Give the codes of a PNG file.

        Parameters
        ----------
        exposure
            Factor on the light.
        tone
            Curve before the cut at white: "shoulder" or "none".
        dither
            Whether an ordered dither hides bands.

        Returns
        -------
        Shape (H, W, 3), or (H, W, 4) where there is an alpha, uint8. PNG files hold
        colours that are not multiplied by their alpha.
        """
        if self.alpha is None:
            return to_codes(self.linear, exposure=exposure, tone=tone, dither=dither)
        light = np.clip(self.linear, -1e300, 1e300)  # the quotient stays finite
        straight = light / np.maximum(self.alpha, LEAST_ALPHA)[..., None]
        colours = to_codes(straight, exposure=exposure, tone=tone, dither=dither)
        cover = np.floor(self.alpha * WHITE + 0.5).astype(np.uint8)
        return np.concatenate([colours, cover[..., None]], axis=-1)

    @checked
    def save(
        self,
        path: str | Path,
        *,
        exposure: Exposure = 1.0,
        tone: Tone = "shoulder",
        dither: bool = True,
    ) -> Path:
        """Write the picture: ``.png`` for looking at, ``.npy`` for its linear light.

        Parameters
        ----------
        path
            Name of the file, ending in .png or .npy; an old one is replaced.
        exposure, tone, dither
            As `codes`; ``.npy`` holds the light itself, and alpha as fourth channel.

        Returns
        -------
        The path.

        Raises
        ------
        ValueError
            The name ends otherwise.
        """
        path = Path(path)
        if _suffix(path) == ".png":
            codes = self.codes(exposure=exposure, tone=tone, dither=dither)
            return png.write_png(path, codes)
        light = self.linear
        if self.alpha is not None:
            light = np.concatenate([light, self.alpha[..., None]], axis=-1)
        write_atomically(path, lambda file: np.save(file, light, allow_pickle=False))
        return path

    def _repr_png_(self) -> bytes:
        """Let a notebook show the picture."""
        file = io.BytesIO()
        png.encode_png(self.codes(), file)
        return file.getvalue()


@checked
def load_picture(path: str | Path) -> Picture:
    """Read a picture from a PNG file, decoded to linear light, or from ``.npy``.

    Formula: linear = srgb_decode(code / 255), times alpha where there is one

    Parameters
    ----------
    path
        Name of the file, ending in .png or .npy.

    Returns
    -------
    The picture; exposure and tone of its making stay in it.

    Raises
    ------
    FileNotFoundError
        No such file.
    ValueError
        Damaged, of another kind, or above 8.3 million pixels.

    Source: the PNG specification; NumPy's .npy format.
    """
    path = Path(path)
    if _suffix(path) == ".png":
        values = png.read_png(path) / WHITE
        light, cover = srgb_decode(values[..., :3]), values[..., 3:]
        if cover.size:
            return Picture(light * cover, alpha=cover[..., 0])
        return Picture(light)
    values = _read_npy(path)
    try:
        if values.shape[2] == 4:
            return Picture(values[..., :3], alpha=values[..., 3])
        return Picture(values)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _read_npy(path: Path) -> Array:
    """Read a linear picture; type and shape are checked before memory is taken."""
    try:
        if path.exists() and not path.is_file():
            raise ValueError("no plain file")
        stored = np.load(path, mmap_mode="r", allow_pickle=False)
    except FileNotFoundError:
        raise FileNotFoundError(
            f"{path}: expected a picture, got no such file"
        ) from None
    except Exception:  # the reader names damage by many types
        raise ValueError(
            f"{path}: expected a picture as .npy, got another or a damaged file"
        ) from None
    shape = getattr(stored, "shape", ())
    if len(shape) != 3 or shape[2] not in (3, 4) or stored.dtype.kind not in "iuf":
        expected = "numbers of shape (H, W, 3) or (H, W, 4)"
        raise ValueError(f"{path}: expected {expected}, got shape {shape}")
    png.check_size(path, shape[1], shape[0])
    return np.array(stored, dtype=np.float64)


def _suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in (".png", ".npy"):
        raise ValueError(
            f"path: expected a name ending in .png or .npy, got {path.name!r}"
        )
    return suffix
