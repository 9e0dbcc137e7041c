"""Reports as text: result, plausibility, design, correction, optimal modification."""
