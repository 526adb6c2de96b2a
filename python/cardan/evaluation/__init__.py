"""Evaluations at drive angles: requests, plans, results, orders and derivatives."""
