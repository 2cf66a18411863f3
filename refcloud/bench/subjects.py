"""What ``refcloud bench`` can measure."""

from __future__ import annotations

from refcloud.bench.noise import NOISE
from refcloud.bench.splat import SPLAT
from refcloud.bench.subject import Subject

SUBJECTS: dict[str, Subject] = {subject.name: subject for subject in (NOISE, SPLAT)}
