"""Work beside the window: threads, the simulator with its requests and answers, and jobs."""
