"""Named scenes: the composed cumulus, and the figures of the documents."""

from refcloud.render import SCENES
from refcloud.scenes import cumulus, man

SCENES.update({scene.name: scene for scene in (cumulus.SCENE, *man.SCENES)})

__all__ = ["SCENES", "cumulus", "man"]
