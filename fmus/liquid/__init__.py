"""The liquid balancer as a unit: declared in `variables`, computed in `slave`."""
