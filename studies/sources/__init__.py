"""Who answers: models, solvers, general-purpose integrators and engines, each by its name."""
