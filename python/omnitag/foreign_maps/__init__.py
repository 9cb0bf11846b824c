"""Marker maps in the formats of other packages."""
