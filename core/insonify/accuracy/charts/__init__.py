"""Charts measured on this machine: speed against accuracy, cost against size, error against step or count."""
