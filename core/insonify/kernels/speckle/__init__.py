"""speckle."""
