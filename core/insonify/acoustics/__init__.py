"""Thin, documented formulas of underwater sound."""
