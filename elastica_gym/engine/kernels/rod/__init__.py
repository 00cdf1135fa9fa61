"""The stages of a rod's step: drift, strains, curvature, loads, damping, kick."""
