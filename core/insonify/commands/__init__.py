"""Sub-commands of ``insonify``, one module each.

A module named after its command has ``register(subparsers)``, which adds the parser and sets its ``run``: a function of
the parsed arguments, which may return an exit code. Modules are found by being here. Installed packages announce a
``register`` as an entry point of the group ``insonify.commands``. A module imports what its command needs within
``run``, so that other commands start quickly.
"""
