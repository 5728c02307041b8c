"""Slant range beyond which errors count; nearer bins hold strong echoes near nadir, to which no tolerance applies."""

from __future__ import annotations

ERROR_ALTITUDES = 1.4  # altitudes of the sonar above the mean bed
