"""The cutting of a flank: blade, machine, equation of meshing, generating surface."""
