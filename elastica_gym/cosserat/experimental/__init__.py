"""Experimental joints used by PyElastica's published examples, under their paths there."""
