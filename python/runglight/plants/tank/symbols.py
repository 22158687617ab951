"""The signals of the tank at the addresses of Theis 2019, section VI-B."""

from runglight.plants.symbols import Symbol

INPUTS = (
    Symbol("%IX0.0", "Tank", "Level", "UL", "input", "upper level sensor, 90 gallons"),
    Symbol("%IX0.1", "Tank", "Level", "LL", "input", "lower level sensor, 10 gallons"),
    Symbol("%IX0.2", "Tank", "Level", "ML", "input", "middle level sensor, 50 gallons"),
)
OUTPUTS = (
    Symbol("%QX0.0", "Tank", "Valves", "INV", "output", "inward valve, ON is open"),
    Symbol("%QX0.1", "Tank", "Valves", "OUTV", "output", "outward valve, ON is open"),
)
SYMBOLS = INPUTS + OUTPUTS
