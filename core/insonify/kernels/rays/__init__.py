"""Single rays along straight lines: cell walk, fixed-step march, specular paths, ray differentials."""
