"""The bed: profiles along a vertical plane, and maps of materials."""
