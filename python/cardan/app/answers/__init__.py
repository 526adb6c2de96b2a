"""Answers: the numbers, words and pictures of each part, in a room of its own."""
