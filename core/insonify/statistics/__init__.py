"""Measures of records: errors and displacement against a reference, similarity as pictures, speckle and spectra."""
