"""Labelled data sets: scenes by drawing values, tiles of their records, annotations."""
