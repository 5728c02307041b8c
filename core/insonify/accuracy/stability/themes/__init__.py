"""Themes of the stability page, one module each: it defines a ``THEME`` with a title, a place and its cases."""
