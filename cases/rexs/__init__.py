"""REXS, the exchange format for gearbox data of the FVA."""
