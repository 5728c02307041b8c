"""Accuracy and speed: charts, stability cases, and the comparison of two records."""
