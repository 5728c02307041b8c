"""Files read and written: records, bathymetry, casts, navigation, meshes; formats by suffix."""
