"""Main window, its views, and widgets that panels share; they show and signal, and never edit the scene."""
