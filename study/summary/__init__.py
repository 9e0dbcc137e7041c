"""Tables and notes as text: results, problems, sweeps, corrections, designs, citations."""
