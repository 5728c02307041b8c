"""Explanation of one pixel of a record: its budget in decibels, its sources, and what hides the bed there."""
