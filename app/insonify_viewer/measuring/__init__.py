"""Measuring on a record: places of its bins, distances, and heights from shadows."""
