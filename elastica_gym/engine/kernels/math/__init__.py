"""Vectors, rotations and roots for kernels."""
