"""Change logs: reading, writing, naming."""
