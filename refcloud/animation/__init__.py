"""Animation: a scene in frames, drawn one by one, here or by any executor."""

from refcloud.animation.animate import Animated, Progress, animate
from refcloud.animation.moves import Moves

__all__ = ["Animated", "Moves", "Progress", "animate"]
