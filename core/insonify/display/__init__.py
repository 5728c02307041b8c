"""Display of a record: picture, sheet, page with scales, ray diagram, palettes."""
