"""Refusals of the library in the words of the command line: options as typed."""

from __future__ import annotations

import re
from collections.abc import Mapping

BETWEEN = " or "  # where a refusal is about either of two arguments
# Words that stand before an argument's name where a refusal says what to do about it.
BEFORE = (
    "leave",
    "choose",
    "take",
    "give",
    "lower",
    "larger",
    "smaller",
    "fewer",
    "more",
)


def as_typed(line: str, flags: Mapping[str, str]) -> str:
    """Write a refusal's arguments as the options that they are typed as.

    Parameters
    ----------
    line
        As `refcloud.refusal.complaint` words it.
    flags
        Options by the names of the library's parameters.

    Returns
    -------
    The line; names in front of it and in its advice are those of options.

    Examples
    --------
    >>> flags = {"voxel": "--voxel", "count": "--count"}
    >>> as_typed("voxel: expected a grid, got none; choose a larger voxel", flags)
    '--voxel: expected a grid, got none; choose a larger --voxel'
    >>> as_typed("a.toml: voxel: expected a grid", flags)
    'a.toml: voxel: expected a grid'
    """
    head, colon, rest = line.partition(": ")
    arguments = head.split(BETWEEN)
    if not colon or not set(arguments) <= set(flags):
        return line
    names = "|".join(map(re.escape, sorted(flags, key=len, reverse=True)))
    rest = re.sub(
        rf"\b({'|'.join(BEFORE)}) (?:the )?({names})(?:{BETWEEN}({names}))?\b",
        lambda found: (
            f"{found[1]} {BETWEEN.join(flags[n] for n in found.groups()[1:] if n)}"
        ),
        rest,
    )
    rest = re.sub(
        rf"\bbeside (?:an?|the) ({names})\b",
        lambda found: f"beside {flags[found[1]]}",
        rest,
    )
    return BETWEEN.join(flags[name] for name in arguments) + ": " + rest
