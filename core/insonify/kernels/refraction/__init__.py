"""Rays in layered and range-dependent water: arcs, eigenrays, caustics, apparent positions."""
