"""Live watching: a tap in; findings printed, kept, published and counted; in one process.

Watching comes first: what is slow (a webhook, a broker, a database, a disk) works behind a queue
or reads what it has missed from the findings store, and never holds up the monitor.
"""
