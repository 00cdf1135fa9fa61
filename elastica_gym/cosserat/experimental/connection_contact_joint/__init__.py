"""Joints off the axis: side by side, or at any point of a system."""
