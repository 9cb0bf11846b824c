"""Python side of omnitag: files, evaluation and printing.

The generated message modules share this package's name; nothing is imported here, so that either
part works without the other.
"""
