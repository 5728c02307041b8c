"""Record A beside the live record B: kept or recorded, shown in several ways, with what differs."""
