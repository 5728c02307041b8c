"""Slant range from which an error counts: nearer bins hold the strong, steep echoes that no tolerance means."""

from __future__ import annotations

ERROR_ALTITUDES = 1.4  # altitudes of the sonar above the mean bed
