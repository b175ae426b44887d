"""What adapters share: settings and their bounds, shapes, reading back, silence."""
