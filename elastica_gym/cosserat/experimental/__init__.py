"""What PyElastica calls experimental, by its paths: joints that its published examples use."""
