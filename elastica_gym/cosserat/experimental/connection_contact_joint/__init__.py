"""Off-axis joints: side by side, or at any point of a system."""
