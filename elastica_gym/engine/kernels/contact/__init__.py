"""Contact of rods, cylinders and planes."""
