"""Interior distance: a boundary embedding carried inside, measured there (the paper's equations 1 to 5)."""
