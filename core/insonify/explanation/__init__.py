"""Explanation of one pixel of a record: its budget in decibels, what returns it, and what hides the bed there."""
