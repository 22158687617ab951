"""More than one machine: the same engine inside the cluster that a site already has."""
