"""The reference: exact rocking, its linearizations and the paper's solvers."""
