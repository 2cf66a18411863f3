"""Every named scene as a declaration, to be written as TOML and changed."""

from __future__ import annotations

from refcloud.declared import KINDS, Changed, Declaration, declared_kind
from refcloud.scenes import SCENES
from refcloud.scenes.man import DECLARED

FILES: dict[str, Declaration | Changed] = {
    name: DECLARED[name] if name in DECLARED else declared_kind(name)
    for name in sorted(SCENES)
    if name in DECLARED or name in KINDS
}
