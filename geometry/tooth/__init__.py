"""The whole tooth: both flanks, fillets and lands, and its lattice of bricks."""
