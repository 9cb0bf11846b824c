"""Markers on paper."""
