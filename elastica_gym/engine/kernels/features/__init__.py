"""The features of a Scene, a file each: what the library's step has more than the environments'.

Each has an inlined ``apply``, which takes Model, Scene, State and Control whole, and does nothing where the Scene has
none of the kind.
"""
