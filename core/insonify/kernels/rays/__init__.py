"""Single rays, straight or along arcs: launch, hits on bed and targets, echoes, specular and mixed paths, sheets."""
