"""Steps of the rotor: exact at constant speed, Radau IIA while it changes."""
