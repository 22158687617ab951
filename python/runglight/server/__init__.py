"""The page and its HTTP API: `runglight serve`.

`application` puts it together; every room of routes answers from one `Workshop`, which knows the
directory that is served, the live watch, the incidents and the diagrams. Whatever comes in has
passed `guard` first.
"""
