"""From noise to a cloud map: ellipsoids, cumuli, boxes of cloud, and the map's file."""

from refcloud.cloudmap.billows import billows, carve, lumps_grid
from refcloud.cloudmap.box import box_corners, box_lines, box_triangles, resized_box
from refcloud.cloudmap.connected import largest_part
from refcloud.cloudmap.cumulus import cumulus_ellipsoids, depth_inside, displace
from refcloud.cloudmap.demand import box_cloud, box_coverage, placed_texture
from refcloud.cloudmap.file import load_voxels, save_voxels
from refcloud.cloudmap.generate import generate
from refcloud.cloudmap.quadric import evaluate_quadric, modulate, quadric
from refcloud.cloudmap.sample import trilinear
from refcloud.cloudmap.texture import worley_smooth_texture
from refcloud.cloudmap.voxels import VoxelGrid, cell_centres, cell_size

__all__ = [
    "VoxelGrid",
    "billows",
    "box_cloud",
    "box_corners",
    "box_coverage",
    "box_lines",
    "box_triangles",
    "carve",
    "cell_centres",
    "cell_size",
    "cumulus_ellipsoids",
    "depth_inside",
    "displace",
    "evaluate_quadric",
    "generate",
    "largest_part",
    "load_voxels",
    "lumps_grid",
    "modulate",
    "placed_texture",
    "quadric",
    "resized_box",
    "save_voxels",
    "trilinear",
    "worley_smooth_texture",
]
