"""Every probe of the map of stability, in the order of its panels."""

from refcloud.bench.stability.light import PROBES as LIGHT
from refcloud.bench.stability.noises import PROBES as NOISES
from refcloud.bench.stability.rendering import PROBES as RENDERING

PROBES = (*NOISES, *LIGHT, *RENDERING)
