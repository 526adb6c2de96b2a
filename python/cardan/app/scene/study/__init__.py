"""Variation of a scene: studies, states, and their tables and curves."""
