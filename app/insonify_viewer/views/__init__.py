"""The widgets; they show and announce, and never edit a scene themselves."""
