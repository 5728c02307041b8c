"""State of a session: scene, modelling, history, contacts, display options; no widget and no thread."""
