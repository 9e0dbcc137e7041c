"""The arithmetic behind the certificate: error-free sums, first contact, residuals, and what follows from them."""
