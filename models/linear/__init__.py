"""Small deviations: linearisation, Floquet multipliers, boundaries of stability, modes."""
