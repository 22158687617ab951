"""The OPC quality of a value (OPC DA 3.0, 6.8): 192 is good."""

QUALITY = "_quality"
"""The column of KEPServerEX DataLogger."""
GOOD = 192


def good(quality: object) -> bool:
    """True where a value may be trusted."""
    return str(quality).strip() == str(GOOD)
