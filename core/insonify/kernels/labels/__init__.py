"""What each range bin shows: target, material, path, incidence."""
