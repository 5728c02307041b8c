"""Themes of the stability page: each is a `StabilityTheme` with a title, a place on the page and its cases."""
