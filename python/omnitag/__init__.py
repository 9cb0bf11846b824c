"""Python side of omnitag: files, evaluation and printing.

The generated message modules share this package's name. Nothing is imported here, so that each part
works without the other.
"""
