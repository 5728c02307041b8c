"""Display of a record in the window: from places of a plot to range bins and back, and from amplitudes to colours."""
