"""Answers to scenes: each part has a room with its numbers, sentences and pictures."""
