"""Parameters panel: every field of the scene with its slider."""
