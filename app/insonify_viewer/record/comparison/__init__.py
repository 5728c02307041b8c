"""Comparison of the live record with another: recordings, kept records, and their views."""
