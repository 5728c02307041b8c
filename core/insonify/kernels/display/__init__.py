"""Display of a record: amplitudes relative to a curve, their averages over columns, and their colours."""
