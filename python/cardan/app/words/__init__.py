"""Printed text: what the command and the report say in words."""
