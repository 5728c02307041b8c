"""Errors as the person meets them: one sentence, and details to copy."""
