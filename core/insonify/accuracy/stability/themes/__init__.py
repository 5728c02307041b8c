"""Themes of the stability report, one module each."""
