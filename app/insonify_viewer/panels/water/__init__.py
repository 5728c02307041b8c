"""Water panel: sound speed over depth and the rays that it bends."""
