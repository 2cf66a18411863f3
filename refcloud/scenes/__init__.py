"""Named scenes: the composed cumulus, and the figures of the documents."""

from refcloud.scene import SCENES, Model, Scene, View
from refcloud.scenes import cumulus, man

__all__ = ["SCENES", "Model", "Scene", "View", "cumulus", "man"]
