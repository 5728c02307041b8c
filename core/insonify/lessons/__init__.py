"""Lessons: a question to answer first, what to move in a scene, what to look for, and why."""
