"""How a scene file is read: its text, the rules of its values, places of errors, and the schema."""
