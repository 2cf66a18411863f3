"""Triangles and lines cut by planes, all at once.

A triangle with one corner outside leaves a quad, that is two triangles, one with two
outside a smaller triangle. What is cut gets new corners at the end of the list, with
attributes on the straight line between the old ones: before the division by depth that
is exact.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array

Faces = NDArray[np.int64]


def clip(
    corners: Array, faces: Faces, planes: Array, unseen: Array | None = None
) -> tuple[Array, Faces, NDArray[np.int64]]:
    """Cut triangles by planes, one plane after the other.

    Parameters
    ----------
    corners
        Right, up and depth in the camera's frame, then attributes, shape (3 + K, V).
    faces
        Corners of each triangle, shape (3, T).
    planes
        Shape (P, 4): a b c d, with a right + b up + c depth + d at least 0 inside.
    unseen
        More of them, by which nothing is cut: triangles with all corners outside of
        one are left out. Together at most 16.

    Returns
    -------
    Corners, those of cuts behind the others; faces, shape (3, T'), in the order of the
    triangles that they are parts of; and which triangle that is, shape (T',).

    Source: Cohen and Sutherland's outcodes, Sutherland and Hodgman's way to cut
    polygons; OpenGL 4.6, section 13.7.
    """
    # A bit for each plane that a corner lies outside of tells, of most triangles, that
    # nothing is cut: no plane's bit is set, or one is set at all three corners.
    code = np.zeros(corners.shape[1], np.uint16)
    beside = () if unseen is None else unseen
    for number, plane in enumerate((*planes, *beside)):
        code |= (_inside(corners, plane) < 0.0).astype(np.uint16) << np.uint16(number)
    first, second, third = code.take(faces)
    cuts = np.uint16((1 << len(planes)) - 1)
    touched = (first | second | third) & cuts > 0
    left_out = first & second & third > 0
    if not (touched | left_out).any():
        return corners, faces, np.arange(faces.shape[1])
    whole = np.flatnonzero(~(touched | left_out))
    source = np.flatnonzero(touched & ~left_out)
    left, faces = faces[:, whole], faces[:, source]
    for plane in planes:
        inside = _inside(corners, plane)
        out = (inside < 0.0).take(faces)  # (3, T)
        if not out.any():
            continue
        count = out.sum(axis=0)
        parts = [(faces[:, count == 0], source[count == 0])]
        for many in (1, 2):
            # 1. Turn each triangle so that its odd corner comes first.
            cut, which = faces[:, count == many], source[count == many]
            odd = np.argmax(out[:, count == many] == (many == 1), axis=0)
            turn = (odd + np.arange(3)[:, None]) % 3
            first, second, third = np.take_along_axis(cut, turn, axis=0)
            # 2. New corners where the odd one's edges meet the plane, always from the
            #    inner end on: two triangles that share an edge cut it at one place.
            new = corners.shape[1] + np.arange(2 * cut.shape[1]).reshape(2, -1)
            ends = np.stack([second, third])
            inner, outer = (ends, first) if many == 1 else (first, ends)
            inner, outer = np.broadcast_arrays(inner, outer)
            inner, outer = inner.ravel(), outer.ravel()
            share = inside[inner] / (inside[inner] - inside[outer])
            start = corners[:, inner]
            meeting = start + share * (corners[:, outer] - start)
            corners = np.concatenate([corners, meeting], axis=1)
            inside = np.concatenate([inside, np.zeros(len(share))])
            # 3. What is left of the triangle.
            if many == 2:
                parts.append((np.stack([first, *new]), which))
            else:
                parts.append((np.stack([new[0], second, third]), which))
                parts.append((np.stack([new[0], third, new[1]]), which))
        faces = np.concatenate([part for part, _ in parts], axis=1)
        source = np.concatenate([which for _, which in parts])
    faces = np.concatenate([left, faces], axis=1)
    source = np.concatenate([whole, source])
    order = np.argsort(source, kind="stable")
    return corners, faces[:, order], source[order]


def cut_lines(ends: Array, planes: Array) -> Array:
    """Cut lines by planes, one plane after the other.

    Parameters
    ----------
    ends
        Right, up and depth of both ends, shape (N, 2, 3).
    planes
        Shape (P, 4), as `clip`.

    Returns
    -------
    The ends of what is left, shape (N', 2, 3), in the lines' order.
    """
    for plane in planes:
        inside = _inside(np.moveaxis(ends, -1, 0), plane)  # (N, 2)
        kept = (inside >= 0.0).any(axis=1)
        ends, inside = ends[kept], inside[kept]
        which, outer = np.nonzero(inside < 0.0)
        if not which.size:
            continue
        # One end lies inside: the new one lies between, seen from there.
        start, stop = ends[which, 1 - outer], ends[which, outer]
        within, beyond = inside[which, 1 - outer], inside[which, outer]
        share = within / (within - beyond)
        ends[which, outer] = start + share[:, None] * (stop - start)
    return ends


def _inside(corners: Array, plane: Array) -> Array:
    """Tell how far inside of a plane corners, shape (3 or more, ...), lie."""
    a, b, c, d = plane
    return a * corners[0] + b * corners[1] + c * corners[2] + d
