"""What stands behind the clouds."""

from refcloud.sky.gradient import Sky, clear_sky, printed_gradient, sky_gradient

__all__ = ["Sky", "clear_sky", "printed_gradient", "sky_gradient"]
