"""Three-dimensional view of the seabed: camera, shading, handles of targets."""
