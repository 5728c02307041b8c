"""Commands that run in processes of their own beside the window."""
