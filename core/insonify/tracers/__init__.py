"""Methods of tracing a scene's pings: from poses to the intensity of each channel in every range bin."""
