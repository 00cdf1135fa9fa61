"""What PyElastica calls experimental, by its paths: joints that its published examples use.

They are called from the compiled step, as a user's own joints are.
"""
