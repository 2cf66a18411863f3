"""The largest connected part of a cloud map."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.voxels import steps_of
from refcloud.conventions import Array, Range, Shape


@checked
def largest_part(
    density: Annotated[Array, Shape("D", "H", "W"), Range(0.0)],
) -> Array:
    """Keep the largest set of occupied cells that hang together by their faces.

    Formula: cells joined across faces share a label; the commonest label stays

    Parameters
    ----------
    density
        Shape (D, H, W), at least 0; occupied where above 0.

    Returns
    -------
    The same shape; all other cells are 0. Of equal parts the one with the highest
    cell index stays.

    Source: an extension of paper M, section 2.

    Examples
    --------
    >>> largest_part([[[1.0, 2.0, 0.0, 3.0]]])
    array([[[1., 2., 0., 0.]]])
    """
    occupied = density > 0.0
    if not occupied.any():
        return np.zeros_like(density)
    # Labels start as cell numbers; each round every cell takes the largest label
    # among itself and its neighbours, then the label of its label (pointer jumping),
    # so that long winding parts need few rounds. Empty cells are labelled -1.
    empty = ~occupied
    number = np.int32 if density.size < 1 << 31 else np.int64
    label = np.arange(density.size, dtype=number).reshape(density.shape)
    label[empty] = -1
    while True:
        spread = label.copy()
        for axis in range(3):
            ahead = [slice(None)] * 3
            behind = [slice(None)] * 3
            ahead[axis], behind[axis] = slice(1, None), slice(None, -1)
            a, b = tuple(ahead), tuple(behind)
            np.maximum(spread[a], label[b], out=spread[a])
            np.maximum(spread[b], label[a], out=spread[b])
        spread[empty] = -1
        for part in steps_of(len(label), label[0].size):
            jumped = spread.reshape(-1)[spread[part]]
            jumped[empty[part]] = -1
            spread[part] = jumped
        if np.array_equal(spread, label):
            break
        label = spread
    del spread
    counts = np.zeros(density.size, number)
    for part in steps_of(len(label), label[0].size):
        np.add.at(counts, label[part][occupied[part]], 1)
    largest = len(counts) - 1 - int(np.argmax(counts[::-1]))
    return np.where(label == largest, density, 0.0)
