"""Main window, its menus, docks, dialogs, tour and recovery after a crash."""
