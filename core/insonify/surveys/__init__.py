"""Surveys: what is made of the records of several lines."""
