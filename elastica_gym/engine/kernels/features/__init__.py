"""The features of a Scene, one file each: what the library's step adds to the environments'.

Each has an inlined ``apply``, which takes Model, Scene, State and Control whole, and does nothing if the Scene lacks
the feature.
"""
