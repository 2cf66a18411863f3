"""What ``refcloud bench`` can measure."""

from __future__ import annotations

from refcloud.bench.approximate import APPROXIMATE
from refcloud.bench.blend import BLEND
from refcloud.bench.interpolants import INTERPOLANTS
from refcloud.bench.kernels import KERNELS
from refcloud.bench.march import MARCH
from refcloud.bench.noise import NOISE
from refcloud.bench.passes import EYEWARD, SUNWARD
from refcloud.bench.scattering import SCATTERING
from refcloud.bench.skies import SKIES
from refcloud.bench.splat import SPLAT
from refcloud.bench.subject import Subject
from refcloud.bench.tolerance import TOLERANCE, WHOLE_SCENES
from refcloud.bench.triangles import TRIANGLES

SUBJECTS: dict[str, Subject] = {
    subject.name: subject
    for subject in (
        NOISE,
        INTERPOLANTS,
        APPROXIMATE,
        KERNELS,
        BLEND,
        SUNWARD,
        EYEWARD,
        SPLAT,
        MARCH,
        SCATTERING,
        TRIANGLES,
        SKIES,
        WHOLE_SCENES,
        TOLERANCE,
    )
}
