"""Answers to scenes: each part has a module or a room of modules."""
