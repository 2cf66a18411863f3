"""What the docstrings' "Source" lines refer to: documents, their pieces, and errata.

"Paper M, eq 12" is an equation of document M; N05, L07, ... are pieces of the
documents; E01, E02, ... are errors or ambiguities in them, each with the reading that
refcloud implements.
"""

from __future__ import annotations

DOCUMENTS = {
    "M": "P. Man, Generating and Real-Time Rendering of Clouds. Czech Technical"
    " University in Prague. In names: man2003, and the look 'man'",
    "S": "Rendering clouds in real time with programmable shaders (course paper)",
    "D": "Clouds on Demand: Parameterized Procedural Generation of Cloud-like Graphics",
    "C": "Simple Clouds Part 1 (Myopic Rhino, 13 April 2004)",
}

PIECES = {
    "A13": "M: centres taken at uniform or random voxels",
    "F01": "M: the framebuffer is cleared to white",
    "F02": "M: glBlendFunc",
    "F03": "M: the mean of an area that is read back",
    "F13": "D: gradient sky",
    "L03": "M: transmittance exp(-tau)",
    "L04": "M: recurrence of pass 1",
    "L07": "M: readback of a ball's projection, averaged",
    "L08": "M: splat of the density's map",
    "L09": "M: the blend of eq 28",
    "L10": "M: pass 2, far to near, the phase function by view",
    "L11": "M: isotropic against anisotropic scattering",
    "L12": "M: coloured light, channel by channel",
    "L13": "M: several lights, summed",
    "N01": "M: hash of three integers",
    "N02": "C: hash of two integers and a seed",
    "N05": "M: smoothing of the lattice by 27 taps",
    "N08": "M: linear interpolation",
    "N09": "M: cosine interpolation",
    "N10": "M: cubic interpolation of four points",
    "N11": "S: Hermite interpolation 3 t^2 - 2 t^3",
    "N12": "S: quintic interpolation 6 t^5 - 15 t^4 + 10 t^3",
    "N13": "M: interpolation of eight corners",
    "N15": "M: sum of octaves",
    "N16": "M: frequencies that a pixel cannot display",
    "N30": "D: smooth noise, bilinear and trilinear",
    "R04": "D: the Henyey-Greenstein phase function",
    "V04": "M: the map of voxels",
    "V05": "M: clouds as united ellipsoid volumes",
    "W03": "M: the visualizator",
    "W04": "M: the cloud-map file",
    "W05": "M: the cloud file and the programs' parameters",
    "W12": "M, S, C: the same seed gives the same picture",
}

# Number: (what is printed or left open, what refcloud does).
ERRATA = {
    "E01": ("eq 12 has +22/9 a^2 and grows outward", "-22/9 a^2"),
    "E02": ("k = 748/405 pi R normalises nothing", "peak, volume or paper, by name"),
    "E03": ("the centre is rho and also rho / k", "rho: the kernel's peak is 1"),
    "E04": ("the splat map is the profile, not a chord", "both, by name"),
    "E05": ("eq 2's mask has 11 digits in one scan", "0x7fffffff"),
    "E06": ("eq 2's divisor lets g fall below -1", "2^30"),
    "E07": ("eq 2's sign may be a power, and or xor", "xor; a plain shift"),
    "E08": ("the hash needs 32-bit integers", "integers, never floats"),
    "E09": ("the lattice repeats every 57 cells; seeds shift it", "seeds are hashed"),
    "E10": ("eq 3's duplicate tap in one scan", "twelve different edge taps"),
    "E11": ("eq 1's sum passes 1", "its true bound; clip, bound or none by name"),
    "E12": ("eq 6's indices; it overshoots", "v0 to v3; range 3.375 in 3-D"),
    "E13": ("'fastest to best': smooth is not accurate", "measured orders"),
    "E14": ("eq 7's corners; the integer part", "eight corners; floor"),
    "E15": ("eq 10 holds no noise", "d Q P where Q P >= t"),
    "E16": ("0..N against 1..N; one letter for many things", "N balls; names in words"),
    "E17": ("eq 15 lacks the usual 1/2", "exp(-r^2 / sigma^2), as printed"),
    "E18": (
        "n = 0, empty clusters, sigma = 0",
        "n from 1; none empty; a voxel's width",
    ),
    "E19": ("eq 24's step is unlimited", "below 1 / largest eigenvalue"),
    "E20": ("the 1 / 4 pi may be counted twice", "phase functions integrate to 1"),
    "E21": (
        "1.5 'for 180 degrees'; forward is 0",
        "the same for eq 25, not for others",
    ),
    "E22": ("eq 26 lacks the solid angle", "Omega, 1 steradian by default"),
    "E23": ("g + T passes 1 from tau = 9.308 on", "held, or refused, by name"),
    "E24": ("T = e^tau in one scan", "e^-tau"),
    "E25": ("eq 28's factor for a whole quad", "modulated by the map; linear or Beer"),
    "E26": ("eq 29's I mixes two things", "light is stored before the phase function"),
    "E27": ("the area that is read back", "disc, square or footprint; what was read"),
    "E34": ("document D's sky is nearly black", "as printed, and gradients that work"),
    "E36": ("Henyey-Greenstein cancels near |g| = 1", "a form that does not"),
}
