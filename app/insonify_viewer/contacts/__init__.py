"""Contacts: points of records that a person marks, names and keeps in a file."""
