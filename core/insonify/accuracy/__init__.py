"""Accuracy and speed: record errors, displacement, similarity, timing, charts and stability cases."""
