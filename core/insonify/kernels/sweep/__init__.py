"""The sweep: visible stretches of a profile and their echoes, in one pass outwards from nadir."""
