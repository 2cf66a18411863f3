"""All that the page can show, by name."""

from __future__ import annotations

import functools

from refcloud.refusal import complaint
from refcloud.studio.named import named
from refcloud.studio.own import OWN
from refcloud.studio.setups import Setup


@functools.cache
def setups() -> dict[str, Setup]:
    """Give every choice by its name: own clouds first, then the named scenes."""
    return {setup.name: setup for setup in (*OWN, *named())}


def find_setup(name: object) -> Setup:
    """Look a choice up.

    Raises
    ------
    ValueError
        There is none of that name.
    """
    known = setups()
    if not isinstance(name, str) or name not in known:
        got = repr(name)[:60]
        raise ValueError(complaint("scene", "one of " + ", ".join(known), got))
    return known[name]
