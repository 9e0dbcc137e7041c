"""How to cite the package, and the published sources that a result rests on."""
