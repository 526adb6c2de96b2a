"""Figures of scenes that reports, pictures and printed tables have in common."""
