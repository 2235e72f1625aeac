"""Balancing in cycles on a virtual machine: Polushkin 2016."""
