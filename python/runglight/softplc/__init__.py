"""Soft PLCs: running plants served over Modbus TCP and S7, as their PLCs would."""

from runglight.softplc.plc import PlcChange, SoftPlc, serve
from runglight.softplc.serve_url import ServeUrl, parse_serve_url

__all__ = ["PlcChange", "ServeUrl", "SoftPlc", "parse_serve_url", "serve"]
