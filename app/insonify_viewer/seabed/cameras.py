"""Places of the camera about the towfish, by what the person reads."""

USUAL = "Behind the towfish"  # at first
# Of the camera and of its focus: ahead of the towfish, to port, up; in slant ranges, for a square view.
CAMERAS = {
    USUAL: ((-1.85, -0.12, 1.15), (-0.22, 0.0, -0.20)),
    "From above": ((-0.32, 0.0, 2.40), (-0.25, 0.0, -0.20)),
    "From abeam": ((-0.15, -2.00, 0.45), (-0.15, 0.0, -0.20)),
    "From the towfish": ((-0.10, 0.0, 0.04), (0.80, 0.0, -0.30)),
}
