"""What accuracy costs in time: errors of flows and pictures against a truth that is independent of them."""
