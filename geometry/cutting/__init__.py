"""How a flank is cut: blade, machine, equation of meshing, generating surface."""
