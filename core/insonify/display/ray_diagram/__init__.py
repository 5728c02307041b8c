"""Ray diagrams: sound-speed profile of a water, and the rays, shadow zones and caustics in it."""
