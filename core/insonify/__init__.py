"""Side-scan sonar simulation: scene in, record out."""
