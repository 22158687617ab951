"""Process mining of I/O logs (Theis 2019): runs, the Petri net they follow, what comes next."""
