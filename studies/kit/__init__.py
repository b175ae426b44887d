"""What every study shares: its declaration, its jobs and workers, its store, its options."""
