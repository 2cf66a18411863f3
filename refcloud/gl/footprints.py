"""A ball's footprint and its opacity in GLSL: refcloud.raster.footprint, in float32."""

from __future__ import annotations

import math
from typing import Literal

from refcloud.metaballs.kernels import CUT, GAUSSIAN_TERMS, WYVILL_CHORD, Kernel
from refcloud.raster.footprint import PER_AXIS

PROFILE = {
    "wyvill": "return p * p * (5.0 + 4.0 * p) / 9.0;",
    "gaussian": f"return p > 0.0 ? exp({-(CUT**2)} * (1.0 - p)) : 0.0;",
}
C5, C7 = (float(c) * PER_AXIS["wyvill"] for c in WYVILL_CHORD)
# The Gaussian's chord as the series of metaballs.kernels: term n is the one before it
# times p 2 CUT^2 / (2n + 1), so that it is summed from the last term to the first.
AXIS = 2.0 * math.exp(-(CUT**2)) * PER_AXIS["gaussian"]
CHORD = {
    "wyvill": f"return p * p * sqrt(p) * ({C5!r} + {C7!r} * p);",
    "gaussian": f"""
    float total = 1.0;
    for (int n = {GAUSSIAN_TERMS - 1}; n > 0; n--)
        total = 1.0 + total * p * {2.0 * CUT**2} / float(2 * n + 1);
    return sqrt(p) * total * {AXIS!r};
""",
}
# 1 - exp(-x) loses its digits where x is small, and thousands of faint balls add up.
OPACITY = {
    "beer": "return share_of(tau * weight);",
    "linear": "return on_axis * weight;",
}
SHARE = """
float share_of(float x) {
    if (x < 0.0625) return x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0)));
    return 1.0 - exp(-x);
}
"""


def footprint_source(
    kernel: Kernel,
    name: Literal["chord", "profile"],
    law: Literal["beer", "linear"],
) -> str:
    """Write `footprint` of p = 1 - q, at least 0, and `opacity` as GLSL functions.

    Parameters
    ----------
    kernel, name, law
        As `refcloud.raster.splat`.

    Returns
    -------
    These functions, and `share_of` x, 1 - exp(-x).
    """
    body = (CHORD if name == "chord" else PROFILE)[kernel]
    return f"""{SHARE}
float footprint(float p) {{
    {body}
}}
float opacity(float weight, float tau, float on_axis) {{
    {OPACITY[law]}
}}
"""
