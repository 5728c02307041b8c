"""The scene as light shows it: rays of sight through the same bodies and materials, to a picture."""
