"""The border from a scene to the arrays of the kernels: scene arrays, navigation, targets, tables."""
