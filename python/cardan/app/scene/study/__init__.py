"""What a scene varies: studies, states, and their tables and curves."""
