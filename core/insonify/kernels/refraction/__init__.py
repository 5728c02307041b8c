"""refraction."""
