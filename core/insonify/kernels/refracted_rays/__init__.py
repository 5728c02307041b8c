"""refracted_rays."""
