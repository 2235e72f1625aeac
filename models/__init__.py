"""Physics of rotors and their passive balancers: equations only, no FMI, no files, no printing."""
