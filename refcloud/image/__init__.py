"""Pictures: linear light, sRGB codes, PNG files, and how far two pictures differ."""

from refcloud.image.animation import write_animation
from refcloud.image.difference import (
    Comparison,
    compare_codes,
    difference_picture,
    largest_difference,
    root_mean_square,
)
from refcloud.image.encode import (
    quantize,
    srgb_decode,
    srgb_encode,
    to_codes,
    tone_shoulder,
)
from refcloud.image.picture import Picture, load_picture
from refcloud.image.png import read_png, write_png

__all__ = [
    "Comparison",
    "Picture",
    "compare_codes",
    "difference_picture",
    "largest_difference",
    "load_picture",
    "quantize",
    "read_png",
    "root_mean_square",
    "srgb_decode",
    "srgb_encode",
    "to_codes",
    "tone_shoulder",
    "write_animation",
    "write_png",
]
