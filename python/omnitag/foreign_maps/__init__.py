"""Maps of markers as other packages keep them."""
