"""What an answer is worth: differences from the exact solution, energy, verdicts, findings."""
