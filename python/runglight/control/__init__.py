"""The learned controller at a plant: in the place of its program, or beside it.

The only room of runglight that writes to a machine, and only `modbus_writer` does.
"""
