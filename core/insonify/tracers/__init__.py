"""One file a method, one signature: ``trace(problem, poses, ...) -> (pings, 2, bins)`` float32 intensity."""
