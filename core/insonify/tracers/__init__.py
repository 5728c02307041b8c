"""Ways of tracing a scene's pings, from poses to the intensity that each channel hears, bin by bin."""
