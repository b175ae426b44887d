"""A study's machinery: jobs, runner, executors, journal, provenance, the command line's pieces."""
