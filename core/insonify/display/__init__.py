"""How a record is shown: picture, sheet, page with scales, ray diagram, palettes."""
