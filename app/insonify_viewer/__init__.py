"""The viewer: tow a sonar over a scene, turn its parameters and watch the record scroll."""
