"""What is asked: the paper's cases, extreme ones, windows of maps, accelerograms."""
