"""Surveys line by line: the lines, their records, their mosaic, and what they cover."""
