"""Agents for the environments of elastica_gym: training with Stable-Baselines3, evaluation and baselines."""
