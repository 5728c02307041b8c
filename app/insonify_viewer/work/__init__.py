"""Work beside the window: the simulator, jobs, and what they are asked and answer."""
