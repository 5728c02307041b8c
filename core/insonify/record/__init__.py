"""Record of a simulation: traced and received block by block, with what it shows of each target, as variables."""
