"""Survey exercises: an area with hidden targets, their sealed truth, and marks for what was found."""
