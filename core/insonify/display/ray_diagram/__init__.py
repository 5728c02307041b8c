"""Ray diagrams: the profile of a water and what it does to sound."""
