"""What every room needs: decorators, cached machine code, types, hashing, range bins, scattering laws."""
