"""Correlated random fields, and scatterers with interfering waves."""
