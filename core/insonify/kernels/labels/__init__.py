"""Labels of each range bin: target, material, propagation path, incidence, shadow."""
