"""The beam: sensitivity by direction and range, and the azimuth sector that a plane stands for."""
