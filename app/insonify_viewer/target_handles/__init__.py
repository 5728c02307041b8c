"""Handles by which a target is moved, turned and resized, in the record and in three dimensions."""
