"""The bed as kernels see it: profiles along a vertical plane, and maps of materials."""
