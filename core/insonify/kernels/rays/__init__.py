"""rays."""
