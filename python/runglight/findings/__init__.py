"""Findings: what departed from the nominal model."""
