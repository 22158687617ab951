"""Speed, memory and accuracy of runglight, measured; `python -m benches.run` runs everything."""
