"""Chart panel: speed against accuracy of every method on the current scene."""
