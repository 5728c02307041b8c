"""multipath."""
