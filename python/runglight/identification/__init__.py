"""Which address is it? Variables identified by declared events (Cadiou 2019).

`identify` ranks a log's signals by events, `sweep` finds the width of their windows, `proposal`
takes events from photos, and `accepted` writes what was found into the symbol table.
"""
