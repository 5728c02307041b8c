"""Display of a record: amplitudes relative to a curve, and their averages over columns."""
