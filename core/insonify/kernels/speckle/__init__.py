"""Correlated random fields, and scatterers whose waves interfere."""
