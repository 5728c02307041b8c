"""Picture of a scene by light: camera rays through the same bodies and materials as sound."""
