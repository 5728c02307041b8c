"""How accurate and how fast: errors, displacement, similarity, timing, charts, stability cases."""
