"""Named streams of random numbers: one purpose, one stream, so that no two purposes share numbers.

A number is a hash of the scene's seed, its stream and its place, see `insonify.kernels.common.hashing`.
"""

# Terrain. Part n of a sum of reliefs adds n · RELIEF_PART; band k of endless relief adds multiples of RELIEF_BAND.
RELIEF = 1
MATERIAL_BANDS = 2
MATERIAL_PATCHES = 3
RELIEF_MASK = 4
RELIEF_PART = 1 << 20
RELIEF_BAND = 1 << 14

# Receiver. Look n of speckle, noise and reverberation adds n.
SPECKLE = 1000
TEXTURE = 2000
PING_GAIN = 3000
PING_DELAY = 3001
AMBIENT_NOISE = 4000
REVERBERATION = 4100
INTERFERENCE = 4200
DROPPED_PINGS = 4201

# Coherent speckle.
BED_SCATTERERS = 5000
TARGET_SCATTERERS = 6000
