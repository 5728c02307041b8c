"""Single rays along arcs: hits on bed and targets, echoes, mixed paths, ray sheets."""
