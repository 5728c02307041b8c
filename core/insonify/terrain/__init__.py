"""Declarations become heights and materials."""
