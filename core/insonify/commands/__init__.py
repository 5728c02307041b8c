"""Sub-commands of ``insonify``, one file each; the viewer adds its own through an entry point."""
