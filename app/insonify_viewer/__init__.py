"""The viewer: tow a sonar over a scene, turn its parameters and watch the record scroll."""

import insonify as _core  # noqa: F401  # before others: it takes the current folder from the places of modules
