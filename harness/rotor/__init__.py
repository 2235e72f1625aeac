"""The rotor alone: modes, Campbell diagram, response, run-up."""
